//! The pages, one folder each.

mod bench;
mod diagnosis;
mod faults;
mod procedures;
mod report;
mod traces;

use eframe::egui::{Key, Ui};
use serde::{Deserialize, Serialize};

use super::desk::{Desk, Go};
use crate::words::Words;

/// A page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Page {
    /// The unit live, and stimuli by hand.
    #[default]
    Bench,
    /// Choosing and running procedures.
    Procedures,
    /// Recorded traces.
    Traces,
    /// The fault history.
    Faults,
    /// The part to replace.
    Diagnosis,
    /// The test sheet of a run.
    Report,
}

impl Page {
    /// All, in the order they are shown.
    pub const ALL: [Self; 6] = [
        Self::Bench,
        Self::Procedures,
        Self::Traces,
        Self::Faults,
        Self::Diagnosis,
        Self::Report,
    ];

    /// Its name on the command line.
    fn word(self) -> &'static str {
        match self {
            Self::Bench => "bench",
            Self::Procedures => "procedures",
            Self::Traces => "traces",
            Self::Faults => "faults",
            Self::Diagnosis => "diagnosis",
            Self::Report => "report",
        }
    }

    /// Its name.
    pub fn name(self, words: &Words) -> &'static str {
        match self {
            Self::Bench => words.bench.title,
            Self::Procedures => words.procedures.title,
            Self::Traces => words.traces.title,
            Self::Faults => words.faults.title,
            Self::Diagnosis => words.diagnosis.title,
            Self::Report => words.report.title,
        }
    }

    /// The key that shows it.
    pub fn key(self) -> Key {
        match self {
            Self::Bench => Key::F1,
            Self::Procedures => Key::F2,
            Self::Traces => Key::F3,
            Self::Faults => Key::F4,
            Self::Diagnosis => Key::F5,
            Self::Report => Key::F6,
        }
    }
}

impl std::str::FromStr for Page {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|page| page.word() == text);
        known.ok_or_else(|| format!("a page is one of {}", Self::ALL.map(Self::word).join(", ")))
    }
}

/// What the pages keep while the window is open.
#[derive(Default)]
pub struct Pages {
    bench: bench::BenchPage,
    procedures: procedures::ProceduresPage,
    traces: traces::TracesPage,
    faults: faults::FaultsPage,
    diagnosis: diagnosis::DiagnosisPage,
    report: report::ReportPage,
}

impl Pages {
    /// Takes what has come for the pages, whichever is in front.
    pub fn poll(&mut self, desk: &mut Desk<'_>) {
        self.procedures.poll(desk);
    }

    /// Shows a page.
    pub fn show(&mut self, page: Page, ui: &mut Ui, desk: &mut Desk<'_>) {
        match page {
            Page::Bench => self.bench.show(ui, desk),
            Page::Procedures => self.procedures.show(ui, desk),
            Page::Traces => self.traces.show(ui, desk),
            Page::Faults => self.faults.show(ui, desk),
            Page::Diagnosis => self.diagnosis.show(ui, desk),
            Page::Report => self.report.show(ui, desk),
        }
    }

    /// Goes where the person wants to; the page to show then.
    pub fn go(&mut self, to: Go, desk: &mut Desk<'_>) -> Page {
        match to {
            Go::Trace(id) => {
                self.traces.open(id, desk);
                Page::Traces
            }
            Go::Report(run) => {
                self.report.open(run, desk);
                Page::Report
            }
            Go::Diagnosis(run) => {
                self.diagnosis.open(run, desk);
                Page::Diagnosis
            }
            Go::RunStep {
                procedure,
                step,
                unit,
            } => {
                self.procedures.run_step(procedure, step, &unit, desk);
                Page::Procedures
            }
        }
    }
}
