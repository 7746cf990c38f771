//! Encodes a trace into one blob with the layout that `layout` describes.
//!
//! A compressed body is the varint length of the plain body, then a zstd frame without its four-byte magic number.
//! Every column is compressed separately: one channel is then read in a few microseconds, at the price of a third more
//! bytes than one frame for all would take.

use std::ops::Range;

use zstd::bulk::{Compressor, Decompressor};

use super::column::{self, Scratch, Tag};
use super::layout::{self, Layout, Shape};
use super::varint::{put, take};
use super::{TraceData, TraceError};

/// Greatest number of rows in a trace.
pub const MAX_ROWS: usize = 1_000_000;

/// Most samples of a trace, and of a single read (64 MiB of doubles).
pub const MAX_SAMPLES: usize = 8 << 20;

/// Compression level 1 is within a per cent of level 3 on columns this short, at half its time.
const ZSTD_LEVEL: i32 = 1;
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];
/// Plain bodies below this length, bytes, are not compressed: about the overhead of a frame.
const ZSTD_WORTH: usize = 24;

/// Encodes and decodes traces; reuses its buffers and compressor.
pub struct TraceCodec {
    compressor: Compressor<'static>,
    decompressor: Decompressor<'static>,
    scratch: Scratch,
    plain: Vec<u8>,
    frame: Vec<u8>,
    directory: Vec<u8>,
    bodies: Vec<u8>,
}

impl TraceCodec {
    /// Fails only if the compressor cannot be allocated.
    pub fn new() -> Result<Self, TraceError> {
        let mut compressor = Compressor::new(ZSTD_LEVEL).map_err(compression)?;
        // The directory has a checksum of every body, compressed or not.
        compressor.include_checksum(false).map_err(compression)?;
        Ok(Self {
            compressor,
            decompressor: Decompressor::new().map_err(compression)?,
            scratch: Scratch::default(),
            plain: Vec::new(),
            frame: Vec::new(),
            directory: Vec::new(),
            bodies: Vec::new(),
        })
    }

    /// Encodes a trace; refuses a trace that could not be read back.
    pub fn encode(&mut self, trace: &TraceData) -> Result<Vec<u8>, TraceError> {
        trace.check()?;
        self.directory.clear();
        self.bodies.clear();
        for (channel, samples) in trace.channels.iter().zip(&trace.columns) {
            let lsb = channel.kind.lsb();
            for block in layout::blocks(samples) {
                let mut tag = column::pack(block, lsb, &mut self.scratch, &mut self.plain);
                let before = self.bodies.len();
                tag.compressed = self.put_compressed()?;
                if !tag.compressed {
                    self.bodies.extend_from_slice(&self.plain);
                }
                layout::put_piece(&mut self.directory, tag, &self.bodies[before..]);
            }
        }
        let mut blob = Vec::with_capacity(self.directory.len() + self.bodies.len() + 32);
        layout::put_head(
            &mut blob,
            trace.rows(),
            trace.columns.len(),
            &self.directory,
        );
        blob.extend_from_slice(&self.bodies);
        Ok(blob)
    }

    /// Appends the plain body as a zstd frame, if that makes it smaller.
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

    /// Decodes `rows` of the columns at `wanted`, indexes of the shape's channels, in that order.
    pub fn decode(
        &mut self,
        blob: &[u8],
        shape: &Shape<'_>,
        wanted: &[usize],
        rows: Range<usize>,
    ) -> Result<Vec<Vec<f64>>, TraceError> {
        check_size(shape.rows, 1)?;
        check_size(rows.len(), wanted.len())?;
        let head = Layout::head_length(blob, blob.len(), shape)?;
        let layout = Layout::read(&blob[..head], blob.len(), shape)?;
        wanted
            .iter()
            .map(|&place| {
                let bytes = layout.span(place, &rows);
                self.part(&layout, shape, place, &rows, &blob[bytes])
            })
            .collect()
    }

    /// Decodes `rows` of the channel at index `place`; `bytes` are the bytes of the layout's span.
    pub(crate) fn part(
        &mut self,
        layout: &Layout,
        shape: &Shape<'_>,
        place: usize,
        rows: &Range<usize>,
        bytes: &[u8],
    ) -> Result<Vec<f64>, TraceError> {
        let channel = &shape.channels[place];
        let damaged = |what| TraceError::Column {
            channel: channel.name.clone(),
            what,
        };
        let mut samples = Vec::new();
        let mut rest = bytes;
        for piece in layout.pieces(place, rows) {
            let parts = rest.split_at_checked(piece.bytes.len());
            let (body, after) = parts.ok_or_else(|| damaged("it is cut off"))?;
            rest = after;
            piece.check(body).map_err(damaged)?;
            let block = self.column(piece.tag, body, piece.rows.len(), channel.kind.lsb());
            let block = block.map_err(damaged)?;
            let from = rows.start.saturating_sub(piece.rows.start);
            let to = rows.end.min(piece.rows.end) - piece.rows.start;
            if samples.is_empty() && (from, to) == (0, block.len()) {
                samples = block;
            } else {
                samples.extend_from_slice(&block[from..to]);
            }
        }
        Ok(samples)
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
        // The buffer may have been larger from an earlier column: the length is checked, too.
        if found.map_err(|_| "it does not decompress")? != plain {
            return Err("it decompresses to another length");
        }
        column::unpack(tag, &self.plain, rows, lsb)
    }
}

/// Greatest length of a column's plain body, bytes: presence and raw doubles, or the longest varints.
fn max_plain(rows: usize) -> usize {
    rows * 20 + 32
}

/// Refuses too many rows or samples, before memory is allocated for them.
pub(crate) fn check_size(rows: usize, columns: usize) -> Result<(), TraceError> {
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
