//! Changes of a database file that was opened.

/// Change of the opened file, as text behind its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileChange {
    /// The file has no name any more.
    #[error("was removed")]
    Removed,
    /// The name leads to another file.
    #[error("was replaced by another file")]
    Replaced,
    /// Two names lead to it.
    #[error("has a second name (a hard link); remove that name")]
    SecondName,
    /// The write-ahead log beside the file was removed or replaced.
    #[error("lost its log: the file beside it that ends in -wal was removed or replaced")]
    NoLog,
    /// The run is not in it.
    #[error("was written over, and does not hold the run as it was recorded")]
    WrittenOver,
    /// The file was there when the program began.
    #[error("is gone")]
    Gone,
}
