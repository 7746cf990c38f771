//! Form in which codes, TWC, markers and pulses reach the unit: as numbers, or as sampled
//! waveforms.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use btu_rig::waveform::ChannelConfig;
use serde::{Deserialize, Serialize};

use crate::failure::{Failure, FileTrouble, Why};

/// Form of the signals between bench and unit. Its text form is `values`, `sampled` or
/// `sampled:FILE`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Signals {
    /// Numbers: code rate, level, count of pulses.
    #[default]
    Values,
    /// Waveforms, undisturbed or as a file says.
    Sampled(Option<PathBuf>),
}

impl Signals {
    /// Disturbances of the waveforms; none where signals are numbers.
    ///
    /// # Errors
    /// The file cannot be read or is wrong.
    pub fn channel(&self) -> Result<Option<ChannelConfig>, Failure> {
        let path = match self {
            Self::Values => return Ok(None),
            Self::Sampled(None) => return Ok(Some(ChannelConfig::default())),
            Self::Sampled(Some(path)) => path,
        };
        let name = path.display();
        let text = std::fs::read_to_string(path).map_err(|error| {
            Failure::usage(FileTrouble::Unread(name.to_string(), Why::of(error)))
        })?;
        let channel = ChannelConfig::from_toml(&text);
        channel
            .map(Some)
            .map_err(|wrong| Failure::usage(FileTrouble::wrong(name, wrong)))
    }
}

impl FromStr for Signals {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(':') {
            None if text == "values" => Ok(Self::Values),
            None if text == "sampled" => Ok(Self::Sampled(None)),
            Some(("sampled", file)) if !file.is_empty() => Ok(Self::Sampled(Some(file.into()))),
            _ => Err("values, sampled or sampled:FILE".into()),
        }
    }
}

impl TryFrom<String> for Signals {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Signals> for String {
    fn from(signals: Signals) -> Self {
        signals.to_string()
    }
}

impl fmt::Display for Signals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Values => f.write_str("values"),
            Self::Sampled(None) => f.write_str("sampled"),
            Self::Sampled(Some(file)) => write!(f, "sampled:{}", file.display()),
        }
    }
}
