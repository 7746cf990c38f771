//! What a diagnosis comes to, as data; whoever shows it has the sentences.

use protocol::LruId;
use serde::Serialize;

use super::groups::{Group, Shared};
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
    /// Two parts have failed.
    TwoFound {
        parts: [LruId; 2],
        /// How likely it is that both have.
        probability: f64,
    },
    /// One of the parts of a group has failed.
    OneOf {
        group: Group,
        /// How likely it is that one of them has.
        probability: f64,
    },
    /// One cause at two parts that share something, or a fault of each.
    Common {
        /// The part that both share, such as a supply or a link.
        cause: Shared,
        parts: [LruId; 2],
        /// How likely it is that both show a fault.
        probability: f64,
    },
    /// A part has failed, or something that it shares with another part that a sign names.
    OneOrCommon {
        /// The part that both share, such as a supply or a link.
        cause: Shared,
        part: LruId,
        /// How likely it is that it has failed.
        probability: f64,
        /// The part that the sign names.
        other: LruId,
    },
    /// A part is likely, and a sign that none of its faults shows names another, with which it shares nothing.
    NotAlone {
        part: LruId,
        /// How likely it is that it has failed.
        probability: f64,
        /// The part that the sign names.
        other: LruId,
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
            Self::TwoFound { .. } => Finding::TwoFound,
            Self::OneOf { .. } | Self::Common { .. } | Self::OneOrCommon { .. } => Finding::OneOf,
            Self::NoFault { .. } => Finding::NoFault,
            Self::NothingSeen { .. } | Self::BrokenOff => Finding::NotEnough,
            Self::NotAlone { .. }
            | Self::CannotTell { .. }
            | Self::NotWeighed
            | Self::BenchFailed { .. } => Finding::CannotTell,
        }
    }

    /// The parts that were not told apart, and what tells which has failed.
    pub fn group(&self) -> Option<Group> {
        let of_shared = |cause: &Shared, parts: [&LruId; 2]| Group {
            parts: [&cause.part].into_iter().chain(parts).cloned().collect(),
            measure: cause.measure.clone(),
        };
        match self {
            Self::OneOf { group, .. } => Some(group.clone()),
            Self::Common {
                cause,
                parts: [one, other],
                ..
            } => Some(of_shared(cause, [one, other])),
            Self::OneOrCommon {
                cause, part, other, ..
            } => Some(of_shared(cause, [part, other])),
            _ => None,
        }
    }
}
