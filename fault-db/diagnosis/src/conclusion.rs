//! What a diagnosis comes to, as data; whoever shows it has the sentences.

use protocol::LruId;
use serde::Serialize;

use super::groups::Measure;
use super::verdict::{Finding, PartProbability};

/// The answer of a diagnosis. Every probability is the one that the answer tells.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Conclusion {
    Found {
        part: LruId,
        /// How likely that is.
        probability: f64,
    },
    /// A part of the bench has failed: the unit is not at fault.
    OfBench {
        part: LruId,
        /// How likely that is.
        probability: f64,
    },
    /// One of these parts has failed.
    OneOf {
        /// The likeliest first.
        parts: Vec<PartProbability>,
        /// What tells which; empty where nothing is known to.
        measure: Measure,
    },
    NoFault {
        /// How likely that is.
        probability: f64,
    },
    /// Nothing wrong was seen in what was run, which is not enough to say that nothing is.
    NothingSeen {
        /// Checks that were made.
        made: usize,
        /// Checks there are.
        of: usize,
    },
    /// Something is wrong, and it cannot be told in which part.
    CannotTell {
        /// The likely parts, the likeliest first.
        likely: Vec<PartProbability>,
        /// What was seen is like nothing that was counted.
        is_unlike_any: bool,
    },
    /// The run was broken off before anything was seen to be wrong.
    BrokenOff,
    /// The run did not pass, and nothing that could be weighed was seen to be wrong.
    NotWeighed,
    /// An instrument of the bench failed, and nothing was seen to be wrong with the unit.
    BenchFailed {
        /// The bench, as its file is called.
        bench: String,
    },
}

impl Conclusion {
    pub fn finding(&self) -> Finding {
        match self {
            Self::Found { .. } => Finding::Found,
            Self::OfBench { .. } => Finding::OfBench,
            Self::OneOf { .. } => Finding::OneOf,
            Self::NoFault { .. } => Finding::NoFault,
            Self::NothingSeen { .. } | Self::BrokenOff => Finding::NotEnough,
            Self::CannotTell { .. } | Self::NotWeighed | Self::BenchFailed { .. } => {
                Finding::CannotTell
            }
        }
    }

    /// The parts that it names: those for certain, or those that are likely.
    pub fn parts(&self) -> Vec<LruId> {
        match self {
            Self::Found { part, .. } | Self::OfBench { part, .. } => vec![part.clone()],
            Self::OneOf { parts, .. } | Self::CannotTell { likely: parts, .. } => {
                parts.iter().map(|part| part.lru.clone()).collect()
            }
            _ => Vec::new(),
        }
    }

    /// What tells the parts apart that were not told apart.
    pub fn measure(&self) -> Option<&Measure> {
        match self {
            Self::OneOf { measure, .. } => Some(measure),
            _ => None,
        }
    }
}
