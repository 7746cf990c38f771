//! Why a bench file or the driver of an instrument is refused.

use std::ops::Range;

use thiserror::Error;

/// Why a bench file or a driver is refused.
#[derive(Debug, Error)]
pub enum PlacesError {
    /// The file is not TOML, or has a key that is not known.
    #[error("{0}")]
    Toml(#[from] toml::de::Error),
    /// A value of the file does not fit.
    #[error("line {line}: {why}")]
    Wrong {
        /// Number of the line in the file, counted from 1.
        line: usize,
        /// Why the value in this line does not fit.
        why: String,
    },
}

impl PlacesError {
    /// Error in the line of the file's text in which this range begins.
    pub(super) fn at(text: &str, range: &Range<usize>, why: impl Into<String>) -> Self {
        Self::Wrong {
            line: 1 + text[..range.start].matches('\n').count(),
            why: why.into(),
        }
    }
}
