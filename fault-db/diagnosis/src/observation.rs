//! What a run showed: its steps with their measured values, its fault events, and where its traces deviate first.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use protocol::Verdict;
use protocol::lru::{self, LruId};
use serde::de::{Deserializer, Error as _};
use serde::{Deserialize, Serialize};

/// Whether a step with this verdict is evidence. A step that was not run to its end is none.
pub const fn is_observed(verdict: Verdict) -> bool {
    match verdict {
        Verdict::Passed | Verdict::Failed | Verdict::Error => true,
        Verdict::Skipped | Verdict::Inconclusive | Verdict::Aborted => false,
    }
}

/// Reads the verdict of an observed step.
pub(crate) fn observed<'de, D: Deserializer<'de>>(from: D) -> Result<Verdict, D::Error> {
    let verdict = Verdict::deserialize(from)?;
    match is_observed(verdict) {
        true => Ok(verdict),
        false => Err(D::Error::custom(format!(
            "a step that is {verdict} is no evidence"
        ))),
    }
}

/// Identifies a step: its procedure and its name there.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct CheckName {
    /// Procedure, for instance `atp/overspeed`.
    pub procedure: String,
    pub step: String,
}

impl std::fmt::Display for CheckName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.procedure, self.step)
    }
}

/// Name of the fault that the tester itself measures: the unit's clock deviates from the tester's.
pub const CLOCK_WRONG: &str = "clock_wrong";

/// A fault event of the unit or the train: the fault's name and the part it points at.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Sign {
    /// Name of the fault.
    pub fault: String,
    /// Part that the fault points at.
    pub lru: Option<LruId>,
}

impl Sign {
    /// Whether the tester itself measures this fault.
    pub(crate) fn is_measured(&self) -> bool {
        self.fault == CLOCK_WRONG
    }

    /// The part's word in the dictionary.
    pub(crate) fn part(&self) -> &str {
        lru::stored(self.lru.as_ref())
    }
}

// Ordered as in stored dictionaries: by these words.
impl Ord for Sign {
    fn cmp(&self, other: &Self) -> Ordering {
        (&self.fault, self.part()).cmp(&(&other.fault, other.part()))
    }
}

impl PartialOrd for Sign {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl From<Sign> for String {
    fn from(sign: Sign) -> Self {
        format!("{}/{}", sign.fault, sign.part())
    }
}

impl TryFrom<String> for Sign {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let parts = text.split_once('/');
        let (fault, part) =
            parts.ok_or_else(|| format!("\"{text}\" is no sign: write fault/part"))?;
        Ok(Self {
            fault: fault.to_owned(),
            lru: lru::from_stored(part),
        })
    }
}

/// A step that was run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObservedStep {
    pub check: CheckName,
    /// Verdict of the step, one that [`is_observed`].
    #[serde(deserialize_with = "observed")]
    pub result: Verdict,
    /// Bench time that the step took, s.
    pub time_s: f64,
    /// Measured values by name; `None` where nothing could be measured.
    pub values: Vec<(String, Option<f64>)>,
    /// Signs that showed while the step ran, or during the set-up of its procedure.
    pub signs: BTreeSet<Sign>,
}

/// All evidence, in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// Steps, in the order they were run.
    pub steps: Vec<ObservedStep>,
    /// Signs from the unit's own log, which belong to no step.
    pub signs: BTreeSet<Sign>,
    /// For the first trace of each procedure, the signal that was the first to deviate from a sound unit's.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub residuals: Vec<String>,
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
                .any(|step| step.result != Verdict::Passed || !step.signs.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_stored_and_ordered_by_their_words() {
        let words = [
            "ato_failed/ato_cpu",
            "ato_failed/unknown",
            "ato_failed/wheel",
        ];
        let signs = words.map(|word| Sign::try_from(word.to_owned()).expect("a sign"));
        assert_eq!(signs[1].lru, None);
        assert!(signs.is_sorted());
        assert_eq!(signs.map(String::from), words);
    }

    #[test]
    fn a_step_that_was_not_run_to_its_end_cannot_be_read_as_evidence() {
        for verdict in Verdict::ALL {
            let json = format!(r#"{{"result":"{verdict}"}}"#);
            let read = serde_json::from_str::<crate::StepOutcome>(&json);
            assert_eq!(read.is_ok(), is_observed(verdict), "{verdict}");
        }
    }
}
