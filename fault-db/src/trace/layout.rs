//! Where in a trace's blob each piece of a channel lies.
//!
//! Encoding 1:
//!
//! ```text
//! varint rows, varint columns, varint bytes of the directory
//! directory, per column and block of 4096 rows:  tag byte, varint length of its body, CRC-32 of it
//! CRC-32 of all so far
//! bodies, channel by channel, block by block
//! ```
//! Every piece has its own checksum, so a channel, or a part of one, is read and verified without reading the others.

use std::cmp::Ordering;
use std::ops::Range;

use super::column::Tag;
use super::varint::{put, take};
use super::{Channel, TraceError};

/// The number of the encoding, in the trace table.
pub const ENCODING: i64 = 1;

/// Rows of a block: 3.4 minutes at 50 ms. A fault's trace is one block, an hour is eighteen.
const BLOCK_ROWS: usize = 4096;
const CRC_BYTES: usize = 4;

/// Description of a trace's blob, from the trace's row.
#[derive(Clone, Copy, Debug)]
pub struct Shape<'a> {
    /// Number of the encoding.
    pub encoding: i64,
    /// Rows of the trace.
    pub rows: usize,
    /// All channels of the trace.
    pub channels: &'a [Channel],
}

impl Shape<'_> {
    fn blocks(&self) -> usize {
        self.rows.div_ceil(BLOCK_ROWS)
    }
}

/// The samples of each block of a column.
pub(super) fn blocks(column: &[f64]) -> impl Iterator<Item = &[f64]> {
    column.chunks(BLOCK_ROWS)
}

/// Writes the head of a blob, around its directory.
pub(super) fn put_head(out: &mut Vec<u8>, rows: usize, columns: usize, directory: &[u8]) {
    put(out, rows as u64);
    put(out, columns as u64);
    put(out, directory.len() as u64);
    out.extend_from_slice(directory);
    let crc = crc32fast::hash(out);
    out.extend_from_slice(&crc.to_le_bytes());
}

/// Writes a piece's entry in the directory.
pub(super) fn put_piece(directory: &mut Vec<u8>, tag: Tag, body: &[u8]) {
    directory.push(tag.byte());
    put(directory, body.len() as u64);
    directory.extend_from_slice(&crc32fast::hash(body).to_le_bytes());
}

/// One block of one channel.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub tag: Tag,
    pub rows: Range<usize>,
    /// Range of the piece's bytes in the blob.
    pub bytes: Range<usize>,
    crc: u32,
}

impl Piece {
    /// Refuses a body that does not match its checksum.
    pub fn check(&self, body: &[u8]) -> Result<(), &'static str> {
        if self.crc == crc32fast::hash(body) {
            return Ok(());
        }
        Err("it does not match its checksum: it was changed after it was written")
    }
}

pub(crate) struct Layout {
    pieces: Vec<Piece>,
    blocks: usize,
}

impl Layout {
    /// Bytes of a blob's head, up to the end of the directory; `start` has the blob's first 32 bytes, or all of it.
    pub fn head_length(
        start: &[u8],
        length: usize,
        shape: &Shape<'_>,
    ) -> Result<usize, TraceError> {
        let mut rest = start;
        let damaged = |rest: &[u8], what| TraceError::Blob {
            offset: start.len() - rest.len(),
            what,
        };
        if take(&mut rest) != Some(shape.rows as u64) {
            let what = "its row count is another than its row in the table says";
            return Err(damaged(rest, what));
        }
        if take(&mut rest) != Some(shape.channels.len() as u64) {
            let what = "its column count is another than its channel list has";
            return Err(damaged(rest, what));
        }
        if shape.encoding != ENCODING {
            let found = shape.encoding;
            return Err(TraceError::Encoding { found });
        }
        let directory = take(&mut rest).and_then(|bytes| usize::try_from(bytes).ok());
        let end =
            directory.and_then(|bytes| bytes.checked_add(start.len() - rest.len() + CRC_BYTES));
        end.filter(|end| *end <= length)
            .ok_or_else(|| damaged(rest, "the directory is cut off"))
    }

    /// Reads the directory; `head` is the part of the blob that `head_length` gives, `length` the length of the whole
    /// blob.
    pub fn read(head: &[u8], length: usize, shape: &Shape<'_>) -> Result<Self, TraceError> {
        let mut rest = head;
        // `head_length` has checked this.
        let (_, _) = (take(&mut rest), take(&mut rest));
        let damaged = |rest: &[u8], what| TraceError::Blob {
            offset: head.len() - rest.len(),
            what,
        };
        let (before, crc) = head
            .split_last_chunk::<CRC_BYTES>()
            .ok_or_else(|| damaged(head, "the directory is cut off"))?;
        if crc32fast::hash(before) != u32::from_le_bytes(*crc) {
            return Err(damaged(rest, "the directory does not match its checksum"));
        }
        take(&mut rest);
        rest = &rest[..rest.len().saturating_sub(CRC_BYTES)];
        let blocks = shape.blocks();
        let count = blocks.saturating_mul(shape.channels.len());
        // A piece's entry takes at least two bytes, so no more is allocated than the blob has.
        if rest.len() / 2 < count {
            return Err(damaged(rest, "the directory is cut off"));
        }
        let mut pieces = Vec::with_capacity(count);
        let mut at = head.len();
        for place in 0..count {
            let (&byte, after) = rest.split_first().ok_or_else(|| damaged(rest, "cut off"))?;
            let tag = Tag::from_byte(byte).ok_or_else(|| damaged(rest, "unknown column form"))?;
            rest = after;
            let bytes = take(&mut rest).and_then(|bytes| usize::try_from(bytes).ok());
            let end = bytes.and_then(|bytes| at.checked_add(bytes));
            let end = end.ok_or_else(|| damaged(rest, "bad column length"))?;
            let crc = rest.split_first_chunk::<CRC_BYTES>();
            let (crc, after) = crc.ok_or_else(|| damaged(rest, "cut off"))?;
            rest = after;
            let first = place % blocks * BLOCK_ROWS;
            pieces.push(Piece {
                tag,
                rows: first..shape.rows.min(first + BLOCK_ROWS),
                bytes: at..end,
                crc: u32::from_le_bytes(*crc),
            });
            at = end;
        }
        if !rest.is_empty() {
            return Err(damaged(rest, "bytes after the directory"));
        }
        let what = match at.cmp(&length) {
            Ordering::Equal => return Ok(Self { pieces, blocks }),
            Ordering::Less => "bytes after the last column",
            Ordering::Greater => "a column is cut off",
        };
        let offset = at.min(length);
        Err(TraceError::Blob { offset, what })
    }

    /// The pieces of the channel at `place` that contain any of `rows`, in order; they are adjacent.
    pub(super) fn pieces(&self, place: usize, rows: &Range<usize>) -> &[Piece] {
        if rows.is_empty() {
            return &[];
        }
        let column = &self.pieces[place * self.blocks..(place + 1) * self.blocks];
        let first = column.partition_point(|piece| piece.rows.end <= rows.start);
        let end = column.partition_point(|piece| piece.rows.start < rows.end);
        column.get(first..end).unwrap_or_default()
    }

    /// The byte range of the pieces that [`Self::pieces`] gives.
    pub fn span(&self, place: usize, rows: &Range<usize>) -> Range<usize> {
        match self.pieces(place, rows) {
            [] => 0..0,
            [first, .., last] => first.bytes.start..last.bytes.end,
            [only] => only.bytes.clone(),
        }
    }
}
