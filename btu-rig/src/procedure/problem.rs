//! Why an action, an expectation or a measurement did not succeed.

use super::finding::Finding;

/// Why an action, an expectation or a measurement did not succeed.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Problem {
    /// The unit did not do its part.
    Failed(Finding),
    /// Data are missing, so nothing can be said.
    NoData(Finding),
    /// The unit refused a request of the tester, or did not answer it.
    Refused(Finding),
    /// The bench, the link or the operator did not do their part.
    Bench(Finding),
}

impl Problem {
    pub(super) fn is_failure(&self) -> bool {
        matches!(self, Self::Failed(_))
    }

    pub(super) fn finding(&self) -> &Finding {
        match self {
            Self::Failed(found)
            | Self::NoData(found)
            | Self::Refused(found)
            | Self::Bench(found) => found,
        }
    }
}
