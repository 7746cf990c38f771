//! Reports of drive runs: plain text, JSON, CSV, and HTML with plots. Station-to-station runs here,
//! runs by hand in [`manual`].

mod csv;
mod figures;
mod html;
mod html_many;
mod json;
pub mod manual;
mod plots;
mod text;

use std::path::PathBuf;
use std::str::FromStr;

pub use html::page;
pub use json::json;
pub use text::text;

use serde_json::Value;

use crate::json_text;
use ptu_bench::data;
use ptu_bench::drive::Driven;
use ptu_bench::drive::monte_carlo::MonteCarlo;
use ptu_bench::failure::Failure;

/// What was driven, and how JSON tells it.
pub struct Results {
    /// The result.
    pub outcomes: Outcomes,
    /// Several were asked for, so that there is a list even of one.
    pub list: bool,
}

/// What was driven.
pub enum Outcomes {
    /// Cases, each once.
    Single(Vec<Driven>),
    /// Cases, each many times.
    Many(Vec<MonteCarlo>),
}

/// What can be written as a report.
pub trait Report {
    /// As a page that stands alone.
    fn html(&self) -> String;
    /// As one JSON document.
    fn json(&self) -> Value;
    /// As a table.
    fn csv(&self) -> String;
}

impl Report for Results {
    fn html(&self) -> String {
        html::html(self)
    }

    fn json(&self) -> Value {
        json(self)
    }

    fn csv(&self) -> String {
        csv::csv(self)
    }
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
        data::check_writable(&self.path)
    }

    /// Writes the report.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, report: &impl Report) -> Result<(), Failure> {
        let text = match self.format {
            Format::Html => report.html(),
            Format::Json => json_text(&report.json())? + "\n",
            Format::Csv => report.csv(),
        };
        data::write(&self.path, &text)
    }
}
