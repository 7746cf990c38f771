//! A trace as one blob, encoding 1.
//!
//! ```text
//! varint rows, varint columns
//! directory, per column:  tag byte, varint length of its body
//! bodies, one after the other, in channel order
//! ```
//! A compressed body is the varint length of the plain body, then a zstd frame without its
//! four-byte magic number. Every column is compressed alone: one channel is then read in a few
//! microseconds, for a third more bytes than one frame around all would take.

use zstd::bulk::{Compressor, Decompressor};

use super::column::{self, Scratch, Tag};
use super::varint::{put, take};
use super::{Channel, TraceData, TraceError};

/// The number of this encoding in the trace table.
pub const ENCODING: i64 = 1;

/// A trace has at most this many rows.
pub const MAX_ROWS: usize = 1_000_000;

/// A trace, and what is decoded of it at once, has at most this many samples (64 MiB of doubles).
pub const MAX_SAMPLES: usize = 8 << 20;

/// Level 1 is within a per cent of level 3 on columns this short, at half its time.
const ZSTD_LEVEL: i32 = 1;
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];
/// A frame costs about this much before it saves anything.
const ZSTD_WORTH: usize = 24;

/// Packs and unpacks traces; keeps its buffers and compressor from one to the next.
pub struct TraceCodec {
    compressor: Compressor<'static>,
    decompressor: Decompressor<'static>,
    scratch: Scratch,
    plain: Vec<u8>,
    frame: Vec<u8>,
    bodies: Vec<u8>,
}

impl TraceCodec {
    /// A codec with its compressor made.
    pub fn new() -> Result<Self, TraceError> {
        let mut compressor = Compressor::new(ZSTD_LEVEL).map_err(compression)?;
        // The row's sha256 covers every byte; a checksum per column would only cost room.
        compressor.include_checksum(false).map_err(compression)?;
        Ok(Self {
            compressor,
            decompressor: Decompressor::new().map_err(compression)?,
            scratch: Scratch::default(),
            plain: Vec::new(),
            frame: Vec::new(),
            bodies: Vec::new(),
        })
    }

    /// Packs a trace; refuses one that could not be read back.
    pub fn encode(&mut self, trace: &TraceData) -> Result<Vec<u8>, TraceError> {
        trace.check()?;
        self.bodies.clear();
        let mut blob = Vec::with_capacity(4096);
        put(&mut blob, trace.rows() as u64);
        put(&mut blob, trace.columns.len() as u64);
        for (channel, samples) in trace.channels.iter().zip(&trace.columns) {
            let lsb = channel.kind.lsb();
            let mut tag = column::pack(samples, lsb, &mut self.scratch, &mut self.plain);
            let before = self.bodies.len();
            tag.compressed = self.put_compressed()?;
            if !tag.compressed {
                self.bodies.extend_from_slice(&self.plain);
            }
            blob.push(tag.byte());
            put(&mut blob, (self.bodies.len() - before) as u64);
        }
        blob.extend_from_slice(&self.bodies);
        Ok(blob)
    }

    /// Appends the plain body as a frame, unless that would not make it smaller.
    fn put_compressed(&mut self) -> Result<bool, TraceError> {
        if self.plain.len() < ZSTD_WORTH {
            return Ok(false);
        }
        self.frame.clear();
        self.frame
            .reserve(zstd::zstd_safe::compress_bound(self.plain.len()));
        let length = self
            .compressor
            .compress_to_buffer(&self.plain[..], &mut self.frame);
        let length = length.map_err(compression)?;
        let Some(frame) = self.frame[..length].strip_prefix(&ZSTD_MAGIC) else {
            return Ok(false);
        };
        if frame.len() + 3 >= self.plain.len() {
            return Ok(false);
        }
        put(&mut self.bodies, self.plain.len() as u64);
        self.bodies.extend_from_slice(frame);
        Ok(true)
    }

    /// Unpacks the columns at `wanted`, places in `channels`, in that order.
    pub fn decode(
        &mut self,
        blob: &[u8],
        channels: &[Channel],
        rows: usize,
        wanted: &[usize],
    ) -> Result<Vec<Vec<f64>>, TraceError> {
        check_size(rows, wanted.len())?;
        let directory = Directory::read(blob, channels.len(), rows)?;
        let mut columns = Vec::with_capacity(wanted.len());
        for &place in wanted {
            let channel = &channels[place];
            let (tag, body) = directory.columns[place];
            let samples = self.column(tag, body, rows, channel.kind.lsb());
            let damaged = |what| TraceError::Column {
                channel: channel.name.clone(),
                what,
            };
            columns.push(samples.map_err(damaged)?);
        }
        Ok(columns)
    }

    fn column(
        &mut self,
        tag: Tag,
        mut body: &[u8],
        rows: usize,
        lsb: f64,
    ) -> Result<Vec<f64>, &'static str> {
        if !tag.compressed {
            return column::unpack(tag, body, rows, lsb);
        }
        let plain = take(&mut body).ok_or("its length is cut off")?;
        let plain = usize::try_from(plain)
            .ok()
            .filter(|plain| *plain <= max_plain(rows));
        let plain = plain.ok_or("it claims to be larger than it can be")?;
        self.frame.clear();
        self.frame.extend_from_slice(&ZSTD_MAGIC);
        self.frame.extend_from_slice(body);
        self.plain.clear();
        self.plain.reserve_exact(plain);
        let found = self
            .decompressor
            .decompress_to_buffer(&self.frame[..], &mut self.plain);
        // The buffer may have been larger from an earlier column: the length is checked too.
        if found.map_err(|_| "it does not decompress")? != plain {
            return Err("it decompresses to another length");
        }
        column::unpack(tag, &self.plain, rows, lsb)
    }
}

/// The largest plain body of a column: presence and raw doubles, or the widest varints.
fn max_plain(rows: usize) -> usize {
    rows * 20 + 32
}

/// The parts of a blob, before any of them is unpacked.
struct Directory<'a> {
    columns: Vec<(Tag, &'a [u8])>,
}

impl<'a> Directory<'a> {
    fn read(blob: &'a [u8], channels: usize, rows: usize) -> Result<Self, TraceError> {
        let mut rest = blob;
        let damaged = |rest: &[u8], what| TraceError::Blob {
            offset: blob.len() - rest.len(),
            what,
        };
        if take(&mut rest) != Some(rows as u64) {
            return Err(damaged(
                rest,
                "its row count is another than its row in the table says",
            ));
        }
        if take(&mut rest) != Some(channels as u64) {
            return Err(damaged(
                rest,
                "its column count is another than its channel list has",
            ));
        }
        // Two bytes of directory per column at least, so this allocates no more than the blob did.
        if rest.len() / 2 < channels {
            return Err(damaged(rest, "the directory is cut off"));
        }
        let mut entries = Vec::with_capacity(channels);
        for _ in 0..channels {
            let (&byte, after) = rest.split_first().ok_or_else(|| damaged(rest, "cut off"))?;
            let tag = Tag::from_byte(byte).ok_or_else(|| damaged(rest, "unknown column form"))?;
            rest = after;
            let length = take(&mut rest).and_then(|length| usize::try_from(length).ok());
            entries.push((
                tag,
                length.ok_or_else(|| damaged(rest, "bad column length"))?,
            ));
        }
        let mut columns = Vec::with_capacity(channels);
        for (tag, length) in entries {
            let parts = rest.split_at_checked(length);
            let (body, after) = parts.ok_or_else(|| damaged(rest, "a column is cut off"))?;
            columns.push((tag, body));
            rest = after;
        }
        if !rest.is_empty() {
            return Err(damaged(rest, "bytes after the last column"));
        }
        Ok(Self { columns })
    }
}

/// Refuses sizes before anything is allocated for them.
pub(super) fn check_size(rows: usize, columns: usize) -> Result<(), TraceError> {
    let samples = rows.checked_mul(columns);
    if rows > MAX_ROWS || samples.is_none_or(|samples| samples > MAX_SAMPLES) {
        return Err(TraceError::TooLarge { rows, columns });
    }
    Ok(())
}

fn compression(error: std::io::Error) -> TraceError {
    TraceError::Compression {
        detail: error.to_string(),
    }
}
