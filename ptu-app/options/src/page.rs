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
    /// Causes of faults, how often they occur, and whether repairs hold.
    Statistics,
}

impl Page {
    /// All pages, in the order in which the window shows them.
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

    /// Word for the page on the command line, and the key that shows the page.
    fn word_and_key(self) -> (&'static str, &'static str) {
        match self {
            Self::Case => ("case", "F7"),
            Self::Bench => ("bench", "F1"),
            Self::Procedures => ("procedures", "F2"),
            Self::Traces => ("traces", "F3"),
            Self::Faults => ("faults", "F4"),
            Self::Diagnosis => ("diagnosis", "F5"),
            Self::Report => ("report", "F6"),
            Self::Statistics => ("statistics", "F8"),
            Self::Drive => ("drive", "F10"),
            Self::Signals => ("signals", "F11"),
        }
    }

    fn word(self) -> &'static str {
        self.word_and_key().0
    }

    /// List of the pages' words on the command line, for help and refusals.
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
        self.word_and_key().1
    }
}

impl std::str::FromStr for Page {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|page| page.word() == text);
        known.ok_or_else(|| format!("a page is {}", Self::one_of()))
    }
}
