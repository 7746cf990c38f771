//! Reasons why a person's event cannot be withdrawn.

/// Reason why nothing is withdrawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WithdrawalError {
    /// The fault has no event of a person, or all are withdrawn.
    #[error("nobody has written anything about it that could be withdrawn")]
    NothingWritten,
    /// The last event that a person wrote is another one.
    #[error("the last that was written about it is another: {kind} by {who}")]
    OtherWritten {
        /// Kind of what was written last.
        kind: String,
        /// Author of what was written last.
        who: String,
    },
    /// A later event builds on the one to be withdrawn.
    #[error(
        "it was {after} after it was {kind}, and that rests on it; say by another state or a note what is so"
    )]
    Rested {
        /// Kind of the person's event.
        kind: String,
        /// Kind of the later event.
        after: String,
    },
    /// The fault was closed, and a new occurrence has begun a new fault since.
    #[error("it was seen again after it was closed, and is a fault of its own since")]
    SeenSince,
}
