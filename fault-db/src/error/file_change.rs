//! Changes of a database file while it is open.

/// A change of the opened file; the text is to follow the file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileChange {
    /// The file has no name any more.
    #[error("was removed")]
    Removed,
    /// The name leads to another file.
    #[error("was replaced by another file")]
    Replaced,
    /// Two names lead to the file.
    #[error("has a second name (a hard link); remove that name")]
    SecondName,
    /// The write-ahead log beside the file was removed or replaced.
    #[error("lost its log: the file beside it that ends in -wal was removed or replaced")]
    NoLog,
    /// The file does not hold the run that was recorded.
    #[error("was written over, and does not hold the run as it was recorded")]
    WrittenOver,
    /// The file existed when the program began, and does not now.
    #[error("is gone")]
    Gone,
}
