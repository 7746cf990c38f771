//! The limits of a query.

/// Longest result of a query, bytes of text: the whole result is in memory when it is printed.
pub const MOST_RESULT_BYTES: usize = 16 << 20;

/// The limit that a query exceeded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QueryLimit {
    /// The caller or the server stopped the query.
    #[error("it took too long")]
    Stopped,
    /// The database engine needs more memory than allowed.
    #[error("it needs too much memory")]
    Memory,
    /// A single row is longer than a result may be.
    #[error("a row is longer than {MOST_RESULT_BYTES} bytes")]
    Row,
}
