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

pub use json::json;
pub use text::text;

use crate::target::{Format, Target};
use crate::words::Language;
use crate::{json_text, run};
use ptu_runs::drive::Driven;
use ptu_runs::drive::monte_carlo::MonteCarlo;
use ptu_runs::failure::{Asked, Failure};

/// Drives, and their form in JSON.
pub struct Results {
    pub outcomes: Outcomes,
    /// Several runs were asked for: JSON has a list, even of one run.
    pub list: bool,
    /// Command that made the report, and time; the window says neither.
    pub made: Option<String>,
}

impl Results {
    /// Results of automatic runs; runs of one section stand side by side.
    pub fn of_runs(runs: Vec<Driven>) -> Self {
        Self {
            outcomes: Outcomes::Single(runs),
            list: true,
            made: None,
        }
    }
}

pub enum Outcomes {
    /// Cases that were driven once each.
    Single(Vec<Driven>),
    /// Cases that were driven many times each.
    Many(Vec<MonteCarlo>),
}

/// A report to write, from its file's name.
///
/// # Errors
/// No drive has such a report.
pub fn target(name: &str) -> Result<Target, Asked> {
    let target = name.parse().ok();
    target
        .filter(|target: &Target| {
            matches!(target.format, Format::Html | Format::Json | Format::Csv)
        })
        .ok_or(Asked::NoDriveReport)
}

/// Writes the report.
///
/// # Errors
/// The file cannot be written.
pub fn write(results: &Results, target: &Target) -> Result<(), Failure> {
    let text = match target.format {
        Format::Json => json_text(&json(results))? + "\n",
        Format::Csv => csv::csv(results),
        _ => run::html(results, Language::English.words()),
    };
    target.write(Ok(text.into()))
}
