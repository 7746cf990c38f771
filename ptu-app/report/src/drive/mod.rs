//! Reports of drive runs: plain text, JSON, CSV, and a sheet with plots; of automatic runs and of many
//! of them. `facts` and `tables` are what text and sheet share. `paper` makes the blocks of the sheet, in either
//! language, which the HTML page and the window are made from.

mod csv;
mod facts;
mod json;
mod paper;
mod plots;
mod tables;
mod text;

use std::path::PathBuf;
use std::str::FromStr;

pub use json::json;
pub use text::text;

use crate::words::Language;
use crate::{json_text, run};
use ptu_runs::data;
use ptu_runs::drive::Driven;
use ptu_runs::drive::monte_carlo::MonteCarlo;
use ptu_runs::failure::Failure;
use ptu_runs::new_file::{Kind, kind};

/// What was driven, and how JSON tells it.
pub struct Results {
    /// The result.
    pub outcomes: Outcomes,
    /// Several were asked for, so that there is a list even of one.
    pub list: bool,
    /// By which command the report was made, and when; the window says neither.
    pub made: Option<String>,
}

impl Results {
    /// Of automatic runs; those of one section stand side by side.
    pub fn of_runs(runs: Vec<Driven>) -> Self {
        Self {
            outcomes: Outcomes::Single(runs),
            list: true,
            made: None,
        }
    }
}

/// What was driven.
pub enum Outcomes {
    /// Cases, each once.
    Single(Vec<Driven>),
    /// Cases, each many times.
    Many(Vec<MonteCarlo>),
}

/// A report to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Target {
    path: PathBuf,
    format: Format,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Html,
    Json,
    Csv,
}

impl FromStr for Target {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let format = match text.rsplit_once('.').map(|(_, ending)| ending) {
            Some("html") => Format::Html,
            Some("json") => Format::Json,
            Some("csv") => Format::Csv,
            _ => return Err("a report of a drive ends in .html, .json or .csv".into()),
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
        data::check_writable(&self.path, self.kind())
    }

    fn kind(&self) -> Kind<'static> {
        match self.format {
            Format::Html => kind::HTML,
            Format::Json => kind::JSON,
            Format::Csv => kind::CSV,
        }
    }

    /// Writes the report.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, results: &Results) -> Result<(), Failure> {
        let text = match self.format {
            Format::Html => run::html(results, Language::English.words()),
            Format::Json => json_text(&json(results))? + "\n",
            Format::Csv => csv::csv(results),
        };
        data::write(&self.path, self.kind(), &text)
    }
}
