//! Traces: equally spaced rows of named channels.
//!
//! `codec` encodes a trace into a blob, column by column, so that one channel is read without decompressing the others;
//! `layout` describes the blob, `column` the encoding of a column.

mod codec;
mod column;
mod layout;
mod scale;
mod varint;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub(crate) use codec::check_size;
pub use codec::{MAX_ROWS, MAX_SAMPLES, TraceCodec};
pub(crate) use layout::Layout;
pub use layout::{ENCODING, Shape};

/// One channel of a trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Channel {
    /// Name of the channel, unique in the trace.
    pub name: String,
    /// Unit of its samples; empty for an enum or a bit.
    pub unit: String,
    /// The kind of its samples.
    pub kind: ChannelKind,
}

/// The kind of a channel's samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChannelKind {
    /// A quantity; its samples should be whole multiples of `lsb`. Other samples are stored as floating-point numbers:
    /// exact, but larger.
    Number {
        /// Resolution of the quantity.
        lsb: f64,
    },
    /// An enum; each sample is one of the numbers in `labels`.
    Enum {
        /// Number to word.
        labels: BTreeMap<i64, String>,
    },
    /// A bit: 0 or 1.
    Bit,
}

impl ChannelKind {
    pub(crate) fn lsb(&self) -> f64 {
        match self {
            Self::Number { lsb } => *lsb,
            Self::Enum { .. } | Self::Bit => 1.0,
        }
    }
}

/// A trace: all its channels, or some.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TraceData {
    /// Bench time of row 0.
    pub t0_bench_us: i64,
    /// UTC of row 0.
    pub t0_us: i64,
    /// Time from row to row.
    pub period_us: i64,
    /// The row at which the trace was triggered.
    pub trigger_row: Option<u32>,
    /// The trace ends earlier than planned: the link dropped or the program was closed.
    pub partial: bool,
    /// Some samples are missing.
    pub gaps: bool,
    /// The channels, one per column.
    pub channels: Vec<Channel>,
    /// Samples by channel, then by row; a missing sample is NaN here and null in JSON.
    pub columns: Vec<Vec<f64>>,
}

impl TraceData {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// Whether a sample is missing.
    pub(crate) fn has_gaps(&self) -> bool {
        self.columns.iter().any(|column| scale::has_gaps(column))
    }

    /// The samples of the channel of that name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let place = self
            .channels
            .iter()
            .position(|channel| channel.name == name)?;
        self.columns.get(place).map(Vec::as_slice)
    }

    /// Refuses a trace that could not be read back.
    pub(crate) fn check(&self) -> Result<(), TraceError> {
        if self.columns.len() != self.channels.len() {
            let (channels, columns) = (self.channels.len(), self.columns.len());
            return Err(TraceError::ChannelCount { channels, columns });
        }
        let rows = self.rows();
        codec::check_size(rows, self.columns.len())?;
        if self.period_us <= 0 {
            return Err(TraceError::Period {
                period_us: self.period_us,
            });
        }
        if let Some(row) = self.trigger_row.filter(|row| *row as usize >= rows) {
            return Err(TraceError::TriggerRow { row, rows });
        }
        let mut names: Vec<_> = self.channels.iter().map(|c| c.name.as_str()).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(TraceError::DuplicateChannel {
                channel: pair[0].to_owned(),
            });
        }
        for (channel, column) in self.channels.iter().zip(&self.columns) {
            let lsb = channel.kind.lsb();
            if !(lsb.is_finite() && lsb > 0.0) {
                return Err(TraceError::Lsb {
                    channel: channel.name.clone(),
                    lsb,
                });
            }
            if column.len() != rows {
                let found = column.len();
                return Err(TraceError::RowCount {
                    channel: channel.name.clone(),
                    rows,
                    found,
                });
            }
        }
        Ok(())
    }
}

/// A trace that cannot be stored, or a stored one that cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TraceError {
    /// The numbers of channels and columns differ.
    #[error("{channels} channels but {columns} columns")]
    ChannelCount {
        /// Number of channels.
        channels: usize,
        /// Number of columns.
        columns: usize,
    },
    /// A column has another number of samples than the trace has rows.
    #[error("channel {channel:?} has {found} samples, the others {rows}")]
    RowCount {
        /// The channel.
        channel: String,
        /// Rows of the trace.
        rows: usize,
        /// Samples of this channel.
        found: usize,
    },
    /// Two channels have the same name.
    #[error("channel {channel:?} comes twice")]
    DuplicateChannel {
        /// The name.
        channel: String,
    },
    /// The resolution is not a positive number.
    #[error("channel {channel:?} has the lsb {lsb}; it must be a positive number")]
    Lsb {
        /// The channel.
        channel: String,
        /// Resolution of the channel.
        lsb: f64,
    },
    /// The time from row to row is not positive.
    #[error("the period is {period_us} µs; it must be positive")]
    Period {
        /// The period given.
        period_us: i64,
    },
    /// The trigger's row is not in the trace.
    #[error("trigger row {row} of a trace with {rows} rows")]
    TriggerRow {
        /// The trigger's row as given.
        row: u32,
        /// Number of rows in the trace.
        rows: usize,
    },
    /// The trace has more than [`MAX_ROWS`] or [`MAX_SAMPLES`].
    #[error(
        "{rows} rows of {columns} channels are too many (at most {MAX_ROWS} rows and {MAX_SAMPLES} samples)"
    )]
    TooLarge {
        /// Number of rows.
        rows: usize,
        /// Number of channels.
        columns: usize,
    },
    /// There is no channel of that name.
    #[error("no channel {channel:?} in the trace; it has {}", .known.join(", "))]
    UnknownChannel {
        /// The name asked for.
        channel: String,
        /// The names of the trace's channels.
        known: Vec<String>,
    },
    /// A later version of the program encoded the trace.
    #[error("encoding {found} is not known; a newer version of the program wrote it")]
    Encoding {
        /// The encoding's number.
        found: i64,
    },
    /// The checksum does not match.
    #[error("the stored data does not match its checksum: it was damaged")]
    Checksum,
    /// The channel list does not match its hash, or cannot be parsed.
    #[error("the channel list cannot be read: {detail}")]
    ChannelSet {
        /// The reason.
        detail: String,
    },
    /// The blob is too short or too long, or contains inconsistent sizes.
    #[error("damaged at byte {offset}: {what}")]
    Blob {
        /// Byte of the blob at which reading failed.
        offset: usize,
        /// Defect of the blob.
        what: &'static str,
    },
    /// A column cannot be decoded.
    #[error("channel {channel:?} is damaged: {what}")]
    Column {
        /// The channel.
        channel: String,
        /// Defect of the column.
        what: &'static str,
    },
    /// The compressor failed.
    #[error("compression failed: {detail}")]
    Compression {
        /// Message of the compressor.
        detail: String,
    },
}
