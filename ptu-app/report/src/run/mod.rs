//! The test sheet of a run, and the repair sheet of a case: one gathering from the store, one sequence of blocks, one
//! layout on pages. What the HTML page, the PDF and the window say is therefore the same, and the window shows the
//! PDF's pages.
//!
//! [`Sheet::gather`], [`CaseSheet::gather`] → [`Paper`] → [`html()`], or [`page::pages`] → [`pdf()`] and the window

pub(crate) mod block;
mod case;
mod code;
mod compare;
mod content;
mod diagnosis;
mod gather;
mod html;
pub mod page;
mod paper;
mod pdf;
mod plots;
mod settled;
mod sources;
mod steps;
mod the_run;

#[cfg(test)]
pub(crate) mod tests;

use fault_db::{Id, RunDetail, TraceData};

pub use case::{CaseSheet, Repair, Standing, case_json};
pub use compare::{RunComparison, comparison_json, comparison_text};
pub use html::html;
pub use paper::{Paper, Printed};
pub use pdf::pdf;
pub use sources::in_words as source_in_words;

use crate::naming::PartNames;
use ptu_runs::failure::Trouble;
use ptu_runs::run_diagnosis::Answer;

/// All a test sheet says, in no language yet.
pub struct Sheet {
    /// The run with its steps and faults.
    pub run: RunDetail,
    /// Traces of failed steps first, then of other faults, then of passed steps that had failed before a repair; at
    /// most [`Sheet::MOST_TRACES`].
    pub traces: Vec<SheetTrace>,
    /// Number of further traces, which the sheet does not show.
    pub more_traces: usize,
    /// Diagnosis of the unit's parts, or why there is none.
    pub diagnosis: Result<Answer, Trouble>,
    pub parts: PartNames,
}

/// A trace on a test sheet.
pub struct SheetTrace {
    pub id: Id,
    /// Steps that were under way, by their place in the run.
    pub steps: Vec<u32>,
    /// Names of the faults it shows.
    pub faults: Vec<String>,
    /// The samples of the signals that are drawn, or why there are none.
    pub samples: Result<TraceData, Trouble>,
}

impl Sheet {
    /// Traces drawn at most.
    pub const MOST_TRACES: usize = 12;
}
