//! Result of a manual run.

use protocol::message::{EbCause, FsbCause};
use thiserror::Error;

use super::player::{LONGEST, REACHED_WITHIN};
use super::{Figures, Sequence, Step, When, words};
use crate::drive::{Landmark, Mark, Row};
use crate::stimulus::Stimulus;

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Ending {
    /// All steps were done.
    #[error("all steps done")]
    Played,
    /// The driver ended it.
    #[error("ended by hand")]
    ByHand,
    /// The bench cannot do what the sequence asks for.
    #[error("the bench refused: {0}")]
    Refused(String),
    /// The unit did not let the train be driven.
    #[error("never ready: {0}")]
    NeverReady(String),
    /// ATP applied a brake.
    #[error("{0}")]
    Atp(AtpBrake),
    /// What a step waited for did not come.
    #[error("line {line}: {what} not reached within {} s", REACHED_WITHIN.as_secs())]
    NotReached {
        /// Line of the step.
        line: usize,
        /// What it waited for.
        what: String,
    },
    /// All steps were done, and the train does not stand.
    #[error("the train does not stand {} s after the last step", REACHED_WITHIN.as_secs())]
    NeverStood,
    /// The run took too long.
    #[error("time limit of {} s", LONGEST.as_secs())]
    TimeLimit,
    /// The unit cannot be reached any more.
    #[error("link lost: {0}")]
    LinkLost(String),
}

/// A brake ATP applied, with the unit's cause if it said one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum AtpBrake {
    /// Full service brake (FSB).
    #[error("ATP applied the full service brake{}", behind_colon(*.0, FsbCause::label))]
    FullService(Option<FsbCause>),
    /// Emergency brake (EB).
    #[error("ATP applied the emergency brake{}", behind_colon(*.0, EbCause::label))]
    Emergency(Option<EbCause>),
}

impl AtpBrake {
    /// The other is graver, or has a cause where this has none.
    pub(super) fn is_outranked_by(self, other: Self) -> bool {
        let rank = |brake: Self| match brake {
            Self::FullService(None) => 0,
            Self::FullService(Some(_)) => 1,
            Self::Emergency(None) => 2,
            Self::Emergency(Some(_)) => 3,
        };
        rank(self) < rank(other)
    }
}

/// A cause behind a colon, or nothing.
pub(super) fn behind_colon<C>(cause: Option<C>, label: fn(C) -> &'static str) -> String {
    cause.map_or_else(String::new, |cause| {
        format!(": {}", label(cause).replace('_', " "))
    })
}

/// A step as it was done.
#[derive(Clone, Debug, PartialEq)]
pub struct StepDone {
    /// Line of its file; 0 = by hand.
    pub line: usize,
    /// Time since the sequence began, s.
    pub t_s: f64,
    /// Head of the train in the section, m.
    pub x_m: f64,
    /// Speed, km/h, a size.
    pub speed_kmh: f64,
    /// What was done.
    pub actions: Vec<Stimulus>,
}

impl StepDone {
    /// What was done, in words.
    pub fn what(&self) -> String {
        let words: Vec<_> = self.actions.iter().map(words).collect();
        words.join(", ")
    }
}

impl From<&StepDone> for Landmark {
    fn from(done: &StepDone) -> Self {
        Self {
            t_s: done.t_s,
            x_m: done.x_m,
            what: Mark::Done(done.what()),
        }
    }
}

/// What a run came to.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// How it ended.
    pub ending: Ending,
    /// One row a cycle. Time 0 is the beginning of the sequence.
    pub rows: Vec<Row>,
    /// Steps that were done.
    pub done: Vec<StepDone>,
    /// Those, and what unit and TCMS logged, in order.
    pub landmarks: Vec<Landmark>,
    /// Speeds, efforts and brake work over the run, of the rows and steps.
    pub figures: Figures,
}

impl Outcome {
    /// What was done, as a sequence that does it again at the same times; all but the steps is
    /// `of`'s.
    pub fn sequence(&self, of: Sequence) -> Sequence {
        let scans = |seconds: f64| (seconds * 100.0).round() / 100.0;
        let mut before_s = 0.0;
        let steps = self.done.iter().map(|done| {
            let after_s = done.t_s - std::mem::replace(&mut before_s, done.t_s);
            Step {
                line: 0,
                when: When::After(scans(after_s)),
                actions: done.actions.clone(),
            }
        });
        let steps = steps.collect();
        let end_s = self.rows.last().map_or(0.0, |row| row.t_s);
        Sequence {
            steps,
            end_after_s: Some(scans((end_s - before_s).max(0.0))),
            ..of
        }
    }

    /// Row of the time `t_s` or the last before it; none before the first.
    pub fn row_at(&self, t_s: f64) -> Option<&Row> {
        let after = self.rows.partition_point(|row| row.t_s <= t_s);
        self.rows.get(after.checked_sub(1)?)
    }
}
