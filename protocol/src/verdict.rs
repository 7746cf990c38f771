//! The verdict of a test.

use serde::{Deserialize, Serialize};

crate::labelled! {
    /// Outcome of a step, a measurement, a procedure or a run. Files, JSON and the command line have its
    /// [`label`](Verdict::label).
    ///
    /// The database has a column type of the same words: `fault-db` names no other crate, and
    /// `ptu_runs::stored` converts.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum Verdict: label {
        /// Every expectation held.
        Passed = "passed",
        /// The unit does not do what it should.
        Failed = "failed",
        /// The unit could not be tested; an error says nothing about the unit.
        Error = "error",
        /// Not run, by choice or condition.
        Skipped = "skipped",
        /// Verdict of a search that found no fault: all that was run passed, and that was not enough to accept the unit.
        Inconclusive = "inconclusive",
        /// Stopped by the operator.
        Aborted = "aborted",
    }
}

impl Verdict {
    /// The verdict over two steps or procedures: aborted, then failed, then error outrank passed.
    ///
    /// A check that failed outranks one that could not be made: a faulty unit causes both, and the
    /// first is the finding. A skipped part changes nothing, and only parts that are all skipped give
    /// `Skipped`.
    pub const fn and(self, other: Self) -> Self {
        if self.rank() >= other.rank() {
            self
        } else {
            other
        }
    }

    const fn rank(self) -> u8 {
        match self {
            Self::Skipped => 0,
            Self::Passed => 1,
            Self::Inconclusive => 2,
            Self::Error => 3,
            Self::Failed => 4,
            Self::Aborted => 5,
        }
    }
}

impl core::fmt::Display for Verdict {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.label())
    }
}
