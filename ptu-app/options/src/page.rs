//! Pages of the window: their names, keys and the words of the command line.

use serde::{Deserialize, Serialize};

use ptu_report::words::Words;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Page {
    /// One case: from the symptom to the signed sheet.
    #[default]
    Case,
    /// The unit live, and stimuli by hand.
    Bench,
    /// Choosing and running procedures.
    Procedures,
    /// Automatic runs of a whole train.
    Drive,
    /// Recorded traces.
    Traces,
    Faults,
    Diagnosis,
    /// The test sheet of a run.
    Report,
    /// Waveforms: read, recorded, made and played.
    Signals,
    /// Page of causes, their frequency, and whether repairs hold.
    Statistics,
}

impl Page {
    /// All, in the order they are shown.
    pub const ALL: [Self; 10] = [
        Self::Case,
        Self::Bench,
        Self::Procedures,
        Self::Traces,
        Self::Faults,
        Self::Diagnosis,
        Self::Report,
        Self::Statistics,
        Self::Drive,
        Self::Signals,
    ];

    /// Name of the page on the command line.
    fn word(self) -> &'static str {
        match self {
            Self::Case => "case",
            Self::Bench => "bench",
            Self::Procedures => "procedures",
            Self::Drive => "drive",
            Self::Traces => "traces",
            Self::Faults => "faults",
            Self::Diagnosis => "diagnosis",
            Self::Report => "report",
            Self::Statistics => "statistics",
            Self::Signals => "signals",
        }
    }

    /// The names of all on the command line, for who chooses one.
    pub fn one_of() -> String {
        let [pages @ .., last] = Self::ALL.map(Self::word);
        format!("{} or {last}", pages.join(", "))
    }

    pub fn name(self, words: &Words) -> &'static str {
        match self {
            Self::Case => words.case.title,
            Self::Bench => words.bench.title,
            Self::Procedures => words.procedures.title,
            Self::Drive => words.drive.title,
            Self::Traces => words.traces.title,
            Self::Faults => words.faults.title,
            Self::Diagnosis => words.diagnosis.title,
            Self::Report => words.report.title,
            Self::Statistics => words.statistics.title,
            Self::Signals => words.signals.title,
        }
    }

    /// The name of the key that shows the page.
    pub fn key(self) -> &'static str {
        match self {
            Self::Case => "F7",
            Self::Bench => "F1",
            Self::Procedures => "F2",
            Self::Traces => "F3",
            Self::Faults => "F4",
            Self::Diagnosis => "F5",
            Self::Report => "F6",
            Self::Statistics => "F8",
            Self::Drive => "F10",
            Self::Signals => "F11",
        }
    }
}

impl std::str::FromStr for Page {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|page| page.word() == text);
        known.ok_or_else(|| format!("a page is {}", Self::one_of()))
    }
}
