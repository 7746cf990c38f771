//! The conclusion of a diagnosis, as data; whoever shows it adds the sentences.

use protocol::LruId;
use serde::Serialize;

use super::groups::Measure;
use super::verdict::{Finding, PartProbability};

/// The answer of a diagnosis. Each probability is that of the answer itself.
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
        /// The measurement that tells which part has failed; empty if none is known.
        measure: Measure,
    },
    NoFault {
        /// How likely that is.
        probability: f64,
    },
    /// The steps that were run show nothing wrong, and are not enough to say that nothing is.
    NothingSeen {
        /// Number of different checks that were made.
        made: usize,
        /// Number of checks in the dictionary.
        of: usize,
    },
    /// Something is wrong, and it cannot be told in which part.
    CannotTell {
        /// The likely parts, the likeliest first.
        likely: Vec<PartProbability>,
        /// The run is unlike every fault that the dictionary has counted.
        is_unlike_any: bool,
    },
    /// The run was broken off before it showed anything wrong.
    BrokenOff,
    /// The run did not pass, but shows nothing that the diagnosis can weigh.
    NotWeighed,
    /// An instrument of the bench failed, and the run shows nothing wrong with the unit.
    BenchFailed {
        /// Name of the bench file.
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

    /// The parts that the conclusion names: the failed one, those of which one has failed, or the likely ones.
    pub fn parts(&self) -> Vec<LruId> {
        match self {
            Self::Found { part, .. } | Self::OfBench { part, .. } => vec![part.clone()],
            Self::OneOf { parts, .. } | Self::CannotTell { likely: parts, .. } => {
                parts.iter().map(|part| part.lru.clone()).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The measurement that tells apart the parts of [`Conclusion::OneOf`].
    pub fn measure(&self) -> Option<&Measure> {
        match self {
            Self::OneOf { measure, .. } => Some(measure),
            _ => None,
        }
    }
}
