//! What a run showed: its steps with their measured values, and the fault events of the unit.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

/// The result of a step. Skipped and aborted steps are not observed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CheckResult {
    /// Every expectation held.
    Passed,
    /// An expectation did not hold.
    Failed,
    /// It could not be tested.
    Error,
}

impl CheckResult {
    /// All there are.
    pub const ALL: [Self; 3] = [Self::Passed, Self::Failed, Self::Error];

    /// The word for it.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed => "failed",
            Self::Error => "error",
        }
    }
}

/// Identifies a step: its procedure and its name there.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct CheckName {
    /// Procedure, for instance `atp/overspeed`.
    pub procedure: String,
    /// Step.
    pub step: String,
}

impl std::fmt::Display for CheckName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.procedure, self.step)
    }
}

/// A fault event of the unit or the train: the fault's name and the part it points at.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Sign {
    /// Name of the fault.
    pub fault: String,
    /// Part it points at; may be `unknown`.
    pub lru: String,
}

impl From<Sign> for String {
    fn from(sign: Sign) -> Self {
        format!("{}/{}", sign.fault, sign.lru)
    }
}

impl TryFrom<String> for Sign {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let parts = text.split_once('/');
        let (fault, lru) =
            parts.ok_or_else(|| format!("\"{text}\" is no sign: write fault/part"))?;
        Ok(Self {
            fault: fault.to_owned(),
            lru: lru.to_owned(),
        })
    }
}

/// A step that was run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepSeen {
    /// Which.
    pub check: CheckName,
    /// Its result.
    pub result: CheckResult,
    /// Bench time it took, s.
    pub time_s: f64,
    /// Its measured values by name; `None` where nothing could be measured.
    pub values: Vec<(String, Option<f64>)>,
    /// Signs that showed while it ran, or during the set-up of its procedure.
    pub signs: BTreeSet<Sign>,
}

/// All evidence, in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// Steps, in the order they were run.
    pub steps: Vec<StepSeen>,
    /// Signs from the unit's own log, which belong to no step.
    pub signs: BTreeSet<Sign>,
}

impl Observation {
    /// Whether there is no evidence.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty() && self.signs.is_empty()
    }

    /// Whether a step failed or could not be tested, or a sign showed.
    pub fn shows_a_fault(&self) -> bool {
        !self.signs.is_empty()
            || self
                .steps
                .iter()
                .any(|step| step.result != CheckResult::Passed || !step.signs.is_empty())
    }
}
