//! Form in which codes, TWC, markers and pulses reach the unit: as numbers, or as sampled
//! waveforms.

use std::path::PathBuf;
use std::str::FromStr;

use btu_rig::waveform::ChannelConfig;

use crate::failure::{Failure, FileTrouble};
use crate::whole_file;

/// Form of the signals between bench and unit. Its text form is `values`, `sampled` or
/// `sampled:FILE`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
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
        let channel = ChannelConfig::from_toml(&whole_file::read(path)?);
        channel
            .map(Some)
            .map_err(|wrong| Failure::usage(FileTrouble::wrong(path.display(), wrong)))
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
