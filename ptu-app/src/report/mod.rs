//! What a run came to, written to a file by its ending: `.json` or `.junit.xml`.

pub mod campaign;
pub mod diagnosis;
pub mod drive;
mod json;
mod junit;
mod plot;

use std::path::PathBuf;

use fault_db::RunDetail;

pub use json::{fault_json, run_json, run_summary_json};
pub(crate) use plot::round_step;

use crate::data;
use crate::failure::Failure;

/// A report to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Target {
    path: PathBuf,
    format: Format,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Json,
    Junit,
}

impl std::str::FromStr for Target {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let format = if text.ends_with(".junit.xml") {
            Format::Junit
        } else if text.ends_with(".json") {
            Format::Json
        } else {
            return Err("a report ends in .json or .junit.xml".into());
        };
        Ok(Self {
            path: text.into(),
            format,
        })
    }
}

impl Target {
    /// Finds out before the run whether the file can be written after it.
    ///
    /// # Errors
    /// It cannot.
    pub fn check(&self) -> Result<(), Failure> {
        data::check_writable(&self.path)
    }

    /// Writes the report.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, run: &RunDetail) -> Result<(), Failure> {
        let text = match self.format {
            Format::Json => serde_json::to_string_pretty(&run_json(run))
                .map_err(|error| Failure::bench(format!("cannot make the report: {error}")))?,
            Format::Junit => junit::junit(run)?,
        };
        data::write(&self.path, &text)
    }
}
