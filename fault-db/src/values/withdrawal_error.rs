//! Reasons for which an event of a person cannot be withdrawn.

/// Reason for which nothing is taken back.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WithdrawalError {
    /// The fault has no event of a person, or all are withdrawn.
    #[error("nobody has written anything about it that could be withdrawn")]
    NothingWritten,
    /// Something else was written last.
    #[error("the last that was written about it is another: {kind} by {who}")]
    OtherWritten {
        /// Kind of what was written last.
        kind: String,
        /// Author of the other entry.
        who: String,
    },
    /// A later event rests on the one to be taken back.
    #[error(
        "it was {after} after it was {kind}, and that rests on it; say by another state or a note what is so"
    )]
    Rested {
        /// Kind of the person's event.
        kind: String,
        /// Kind of the event after it.
        after: String,
    },
    /// The fault was closed, and the same fault was opened again.
    #[error("it was seen again after it was closed, and is a fault of its own since")]
    SeenSince,
}
