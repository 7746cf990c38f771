//! Heads of WAV files: RIFF, its form for more than 4 GB (RF64, EBU Tech 3306), and Sony's Wave64. What follows the head
//! are samples in containers of whole bytes, the highest bits of which are used (WAVEFORMATEXTENSIBLE).

use std::io::{self, Read, Seek, SeekFrom};

/// Pieces of a file before its samples; one of a program that writes recordings has a few.
const MOST_CHUNKS: usize = 1_000;
/// Most bytes that are read of a piece: a format has no more that matters here.
const FORMAT: u64 = 40;
/// A length that its writer did not know, or that stands elsewhere.
const OPEN: u64 = 0xffff_ffff;
/// What a Wave64 file begins with, and what stands behind the length of the whole.
pub(super) const W64_RIFF: [u8; 16] = *b"riff\x2e\x91\xcf\x11\xa5\xd6\x28\xdb\x04\xc1\x00\x00";
pub(super) const W64_WAVE: [u8; 16] = *b"wave\xf3\xac\xd3\x11\x8c\xd1\x00\xc0\x4f\x8e\xdb\x8a";
const PCM: u16 = 1;
const FLOAT: u16 = 3;
const EXTENSIBLE: u16 = 0xfffe;

/// Form of the samples of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Head {
    pub channels: u16,
    /// Hz.
    pub sample_hz: u32,
    /// Bytes of one sample of one channel.
    pub bytes: usize,
    pub is_float: bool,
    /// Bytes of all samples; `None` up to the end of the file, as a recorder that was killed leaves it.
    pub length: Option<u64>,
}

impl Head {
    /// The value of one sample's bytes, as a part of full scale.
    pub fn sample(&self, bytes: &[u8]) -> f64 {
        match *bytes {
            // Samples of eight bits alone have no sign.
            [byte] => (f64::from(byte) - 128.0) / 128.0,
            [a, b, c, d] if self.is_float => f32::from_le_bytes([a, b, c, d]).into(),
            [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            _ => {
                // The highest bits count.
                let mut number = [0; 4];
                number[4 - bytes.len()..].copy_from_slice(bytes);
                f64::from(i32::from_le_bytes(number)) / 2f64.powi(31)
            }
        }
    }
}

/// One piece of a file.
struct Chunk {
    name: [u8; 4],
    length: u64,
}

/// How pieces are named and measured.
#[derive(Clone, Copy)]
enum Form {
    Riff,
    Wave64,
}

/// Reads up to the first sample.
///
/// # Errors
/// Why it is no WAV file that can be read.
pub(super) fn read(file: &mut (impl Read + Seek)) -> Result<Head, String> {
    let mut name = [0; 4];
    file.read_exact(&mut name).map_err(ended)?;
    let form = match &name {
        b"RIFF" | b"RF64" | b"BW64" => Form::Riff,
        b"riff" => Form::Wave64,
        _ => return Err("it begins as no WAV file does".to_owned()),
    };
    let mut rest = [0; 36];
    let rest = match form {
        Form::Riff => &mut rest[..8],
        Form::Wave64 => &mut rest[..],
    };
    file.read_exact(rest).map_err(ended)?;
    let is_whole = match form {
        Form::Riff => rest[4..] == *b"WAVE",
        Form::Wave64 => rest[..12] == W64_RIFF[4..] && rest[20..] == W64_WAVE,
    };
    if !is_whole {
        return Err("it begins as no WAV file does".to_owned());
    }
    // Of RIFF the length of the whole; of Wave64 a part of the name, which is no such number.
    let size = at(rest, 0).map(u32::from_le_bytes);
    let is_open = matches!(size.map(u64::from), Some(0 | OPEN));
    let (mut head, mut long) = (None, None);
    for _ in 0..MOST_CHUNKS {
        let chunk = form.chunk(file).map_err(ended)?;
        match &chunk.name {
            b"fmt " => head = Some(format(&start(file, &chunk, form)?)?),
            b"ds64" => long = at(&start(file, &chunk, form)?, 8).map(u64::from_le_bytes),
            b"data" => {
                let head: Head = head.ok_or("its samples come before what they are")?;
                let length = match (chunk.length, long) {
                    (OPEN, Some(long)) => Some(long),
                    (OPEN, None) => None,
                    (0, _) if is_open => None,
                    (length, _) => Some(length),
                };
                return Ok(Head { length, ..head });
            }
            _ => form.pass(file, &chunk, 0).map_err(ended)?,
        }
    }
    Err("it has no samples".to_owned())
}

impl Form {
    fn chunk(self, file: &mut impl Read) -> io::Result<Chunk> {
        let mut head = [0; 24];
        let head = match self {
            Self::Riff => &mut head[..8],
            Self::Wave64 => &mut head[..],
        };
        file.read_exact(head)?;
        let length = match self {
            Self::Riff => at(head, 4).map(|size| u64::from(u32::from_le_bytes(size))),
            // The length of a piece counts its own head.
            Self::Wave64 => at(head, 16).map(|size| u64::from_le_bytes(size).saturating_sub(24)),
        };
        Ok(Chunk {
            name: at(head, 0).unwrap_or_default(),
            length: length.unwrap_or_default(),
        })
    }

    /// Goes from `taken` bytes into a piece to the next, which begins at a multiple of some bytes. A damaged length may be any.
    fn pass(self, file: &mut impl Seek, chunk: &Chunk, taken: u64) -> io::Result<()> {
        let step = match self {
            Self::Riff => 2,
            Self::Wave64 => 8,
        };
        let filled = chunk.length.checked_next_multiple_of(step);
        let rest = filled.and_then(|filled| i64::try_from(filled - taken).ok());
        let rest = rest.ok_or(io::ErrorKind::UnexpectedEof)?;
        file.seek(SeekFrom::Current(rest)).map(drop)
    }
}

/// The beginning of a piece, behind which the file then stands.
fn start(file: &mut (impl Read + Seek), chunk: &Chunk, form: Form) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let taken = chunk.length.min(FORMAT);
    file.take(taken).read_to_end(&mut bytes).map_err(ended)?;
    if bytes.len() as u64 != taken {
        return Err(ended(io::ErrorKind::UnexpectedEof.into()));
    }
    form.pass(file, chunk, taken).map_err(ended)?;
    Ok(bytes)
}

fn format(bytes: &[u8]) -> Result<Head, String> {
    let number = |place| at(bytes, place).map(u16::from_le_bytes);
    let missing = "what its samples are is cut off";
    let kind = match number(0).ok_or(missing)? {
        EXTENSIBLE => number(24).ok_or(missing)?,
        kind => kind,
    };
    let channels = number(2).ok_or(missing)?;
    let sample_hz = at(bytes, 4).map(u32::from_le_bytes).ok_or(missing)?;
    let (frame, bits) = (number(12).ok_or(missing)?, number(14).ok_or(missing)?);
    let bytes = match channels {
        0 => 0,
        _ if frame % channels == 0 && frame >= channels => usize::from(frame / channels),
        _ => usize::from(bits.div_ceil(8)),
    };
    match (kind, bytes) {
        (PCM, 1..=4) | (FLOAT, 4 | 8) => Ok(Head {
            channels,
            sample_hz,
            bytes,
            is_float: kind == FLOAT,
            length: None,
        }),
        (PCM | FLOAT, _) => Err(format!("samples of {bytes} bytes")),
        (other, _) => Err(format!("its samples are packed, as format {other}")),
    }
}

/// So many bytes from a place on, if there are as many.
fn at<const N: usize>(bytes: &[u8], place: usize) -> Option<[u8; N]> {
    bytes.get(place..place + N)?.try_into().ok()
}

fn ended(error: io::Error) -> String {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => "it ends before its samples".to_owned(),
        _ => error.to_string(),
    }
}
