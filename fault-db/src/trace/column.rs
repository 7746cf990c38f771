//! The encoding of one column of a trace.
//!
//! Terms: *scaled* samples are whole multiples of the channel's lsb, so the column is a list of
//! integers; *presence* says which samples exist. The plain body of a column is
//!
//! ```text
//! [presence runs, if flagged: varints, present first, alternating, summing to the rows]
//! constant:  zigzag varint
//! runs:      (zigzag varint of the change, varint of the run length - 1) until the rows are full
//! delta:     zigzag varint of the change, per row; the first row changes from 0
//! delta2:    zigzag varint of the change of the change, per row
//! f32, f64:  the little-endian bytes as planes, all first bytes, then all second bytes …
//! ```

use super::scale::{changes, has_gaps, per_unit, scale};
use super::varint::{put, take, unzigzag, zigzag};

/// The form of a column's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    Constant,
    Runs,
    Delta,
    Delta2,
    RawF32,
    RawF64,
}

/// The first byte of a column in the directory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tag {
    pub form: Form,
    /// The body is a zstd frame.
    pub compressed: bool,
    /// The body begins with presence runs.
    pub sparse: bool,
    /// A sample is integer / (1 / lsb) instead of integer * lsb: 3 / 10 is 0.3, 3 * 0.1 is not.
    pub divided: bool,
}

const COMPRESSED: u8 = 0x08;
const SPARSE: u8 = 0x10;
const DIVIDED: u8 = 0x20;

/// Beyond this, doubles do not represent every integer.
const MAX_INTEGER: i64 = 1 << 53;

impl Tag {
    pub fn byte(self) -> u8 {
        let flag = |on, bit| if on { bit } else { 0 };
        self.form as u8
            | flag(self.compressed, COMPRESSED)
            | flag(self.sparse, SPARSE)
            | flag(self.divided, DIVIDED)
    }

    pub fn from_byte(byte: u8) -> Option<Self> {
        let form = match byte & 0x07 {
            0 => Form::Constant,
            1 => Form::Runs,
            2 => Form::Delta,
            3 => Form::Delta2,
            4 => Form::RawF32,
            5 => Form::RawF64,
            _ => return None,
        };
        let on = |bit| byte & bit != 0;
        (byte & 0xC0 == 0).then_some(Self {
            form,
            compressed: on(COMPRESSED),
            sparse: on(SPARSE),
            divided: on(DIVIDED),
        })
    }
}

/// Buffers reused between columns, to avoid an allocation per column.
#[derive(Default)]
pub(super) struct Scratch {
    integers: Vec<i64>,
    filled: Vec<f64>,
}

/// Writes the plain body of a column to `out`; returns its tag.
pub(super) fn pack(samples: &[f64], lsb: f64, scratch: &mut Scratch, out: &mut Vec<u8>) -> Tag {
    out.clear();
    let sparse = has_gaps(samples);
    if sparse {
        put_presence(samples, out);
        filled(samples, &mut scratch.filled);
    }
    let present = if sparse { &scratch.filled } else { samples };
    let plain = |form, divided| Tag {
        form,
        compressed: false,
        sparse,
        divided,
    };
    if let Some(divided) = scale(present, lsb, &mut scratch.integers) {
        return plain(put_integers(&scratch.integers, out), divided);
    }
    let fits_f32 = samples
        .iter()
        .all(|s| s.is_nan() || f64::from(*s as f32) == *s);
    if fits_f32 {
        put_planes(samples, |sample| (sample as f32).to_le_bytes(), out);
        plain(Form::RawF32, false)
    } else {
        put_planes(samples, f64::to_le_bytes, out);
        plain(Form::RawF64, false)
    }
}

/// Fills each missing sample with the sample before, or 0.
fn filled(samples: &[f64], out: &mut Vec<f64>) {
    out.clear();
    let filled = samples.iter().scan(0.0, |last, sample| {
        if !sample.is_nan() {
            *last = *sample;
        }
        Some(*last)
    });
    out.extend(filled);
}

/// Writes integers in the form that probably compresses best.
fn put_integers(integers: &[i64], out: &mut Vec<u8>) -> Form {
    let changes = changes(integers);
    if changes == 0 {
        put(out, zigzag(integers.first().copied().unwrap_or(0)));
        return Form::Constant;
    }
    if changes * RUNS_WORTH <= integers.len() {
        put_runs(integers, out);
        return Form::Runs;
    }
    let (mut delta_bits, mut delta2_bits) = (0u32, 0u32);
    let (mut last, mut last_delta) = (0i64, 0i64);
    for &integer in integers {
        let delta = integer - last;
        delta_bits += bits(delta);
        delta2_bits += bits(delta - last_delta);
        (last, last_delta) = (integer, delta);
    }
    if delta_bits <= delta2_bits {
        put_deltas(integers, out);
        Form::Delta
    } else {
        put_deltas2(integers, out);
        Form::Delta2
    }
}

/// Runs are used if at most one sample in this many changes: a run costs at least two bytes, and zstd does better on
/// deltas.
const RUNS_WORTH: usize = 8;

#[inline]
fn bits(value: i64) -> u32 {
    64 - zigzag(value).leading_zeros()
}

fn put_runs(integers: &[i64], out: &mut Vec<u8>) {
    let mut last = 0;
    for run in integers.chunk_by(|a, b| a == b) {
        put(out, zigzag(run[0] - last));
        put(out, run.len() as u64 - 1);
        last = run[0];
    }
}

fn put_deltas(integers: &[i64], out: &mut Vec<u8>) {
    let mut last = 0;
    for &integer in integers {
        put(out, zigzag(integer - last));
        last = integer;
    }
}

fn put_deltas2(integers: &[i64], out: &mut Vec<u8>) {
    let (mut last, mut last_delta) = (0, 0);
    for &integer in integers {
        let delta = integer - last;
        put(out, zigzag(delta - last_delta));
        (last, last_delta) = (integer, delta);
    }
}

fn put_presence(samples: &[f64], out: &mut Vec<u8>) {
    let mut present = true;
    let mut length = 0u64;
    for sample in samples {
        if sample.is_nan() == present {
            put(out, length);
            (present, length) = (!present, 0);
        }
        length += 1;
    }
    put(out, length);
}

fn put_planes<const N: usize>(samples: &[f64], bytes: impl Fn(f64) -> [u8; N], out: &mut Vec<u8>) {
    for plane in 0..N {
        // `presence` marks a missing sample; its value here only has to compress well.
        out.extend(
            samples
                .iter()
                .map(|s| if s.is_nan() { 0 } else { bytes(*s)[plane] }),
        );
    }
}

/// Reads a plain body back; the error says what is inconsistent.
pub(super) fn unpack(
    tag: Tag,
    mut body: &[u8],
    rows: usize,
    lsb: f64,
) -> Result<Vec<f64>, &'static str> {
    let missing = if tag.sparse {
        take_presence(&mut body, rows)?
    } else {
        Vec::new()
    };
    let mut samples = match tag.form {
        Form::RawF32 => take_planes(&mut body, rows, |bytes| {
            f64::from(f32::from_le_bytes(bytes))
        })?,
        Form::RawF64 => take_planes(&mut body, rows, f64::from_le_bytes)?,
        _ => {
            let per_unit = per_unit(lsb);
            if tag.divided {
                take_integers(tag.form, &mut body, rows, |integer| {
                    integer as f64 / per_unit
                })?
            } else {
                take_integers(tag.form, &mut body, rows, |integer| integer as f64 * lsb)?
            }
        }
    };
    if !body.is_empty() {
        return Err("bytes are left over");
    }
    if samples.iter().any(|sample| sample.is_nan()) {
        return Err("a sample is not a number");
    }
    for range in missing {
        samples[range].fill(f64::NAN);
    }
    Ok(samples)
}

fn take_presence(
    body: &mut &[u8],
    rows: usize,
) -> Result<Vec<std::ops::Range<usize>>, &'static str> {
    let mut missing = Vec::new();
    let (mut row, mut present) = (0usize, true);
    while row < rows {
        let length = take(body).ok_or("presence is cut off")?;
        if length == 0 && !(row == 0 && present) {
            return Err("an empty presence run");
        }
        let end = usize::try_from(length)
            .ok()
            .and_then(|length| row.checked_add(length));
        let end = end
            .filter(|end| *end <= rows)
            .ok_or("presence is longer than the trace")?;
        if !present {
            missing.push(row..end);
        }
        (row, present) = (end, !present);
    }
    Ok(missing)
}

fn take_planes<const N: usize>(
    body: &mut &[u8],
    rows: usize,
    value: impl Fn([u8; N]) -> f64,
) -> Result<Vec<f64>, &'static str> {
    let planes = body
        .split_at_checked(rows * N)
        .ok_or("samples are cut off")?;
    *body = planes.1;
    let planes = planes.0;
    Ok((0..rows)
        .map(|row| value(std::array::from_fn(|n| planes[n * rows + row])))
        .collect())
}

fn take_integers(
    form: Form,
    body: &mut &[u8],
    rows: usize,
    value: impl Fn(i64) -> f64,
) -> Result<Vec<f64>, &'static str> {
    const CUT: &str = "values are cut off";
    let mut samples = Vec::with_capacity(rows);
    let (mut last, mut delta) = (0i64, 0i64);
    match form {
        Form::Constant => {
            let integer = checked(unzigzag(take(body).ok_or(CUT)?))?;
            samples.resize(rows, value(integer));
        }
        Form::Runs => {
            while samples.len() < rows {
                last = checked(last.wrapping_add(unzigzag(take(body).ok_or(CUT)?)))?;
                let length = take(body).ok_or(CUT)?;
                let left = (rows - samples.len()) as u64;
                if length >= left {
                    return Err("a run is longer than the trace");
                }
                samples.resize(samples.len() + length as usize + 1, value(last));
            }
        }
        _ => {
            for _ in 0..rows {
                let change = unzigzag(take(body).ok_or(CUT)?);
                delta = if form == Form::Delta2 {
                    delta.wrapping_add(change)
                } else {
                    change
                };
                last = checked(last.wrapping_add(delta))?;
                samples.push(value(last));
            }
        }
    }
    Ok(samples)
}

#[inline]
fn checked(integer: i64) -> Result<i64, &'static str> {
    if integer.unsigned_abs() <= MAX_INTEGER as u64 {
        Ok(integer)
    } else {
        Err("out of range")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packed(samples: &[f64], lsb: f64) -> (Tag, Vec<u8>) {
        let mut out = Vec::new();
        let tag = pack(samples, lsb, &mut Scratch::default(), &mut out);
        (tag, out)
    }

    /// 0.3, 0.3 … with lsb 0.1: 3 steps, zigzag 6; 17 of them, then a step of -1: zigzag 1.
    #[test]
    fn runs_are_as_worked_by_hand() {
        let samples: Vec<f64> = [0.3; 17].into_iter().chain([0.2; 3]).collect();
        let (tag, body) = packed(&samples, 0.1);
        assert_eq!(body, [6, 16, 1, 2]);
        assert_eq!(tag.byte(), 0x21, "runs, divided");
    }

    /// Rows 1 and 2 of 4 missing: present 1, missing 2, present 1; then the constant 5, zigzag 10.
    #[test]
    fn presence_is_as_worked_by_hand() {
        let (tag, body) = packed(&[5.0, f64::NAN, f64::NAN, 5.0], 1.0);
        assert_eq!(body, [1, 2, 1, 10]);
        assert_eq!(tag.byte(), 0x10, "constant, sparse");
    }

    #[test]
    fn samples_that_are_no_multiples_are_stored_exactly_as_floats() {
        for (samples, form) in [
            (vec![0.5, 0.25, -7.0], Form::RawF32),
            (vec![0.1, 1.0 / 3.0, 1e300], Form::RawF64),
            (vec![f64::INFINITY, 0.0], Form::RawF32),
            (vec![9.1e15, 1.0], Form::RawF64),
            // Saturates as an integer, where its magnitude exceeds an i64.
            (vec![i64::MIN as f64, 0.0], Form::RawF32),
        ] {
            let (tag, body) = packed(&samples, 1.0);
            assert_eq!(tag.form, form, "{samples:?}");
            assert_eq!(
                unpack(tag, &body, samples.len(), 1.0).expect("readable"),
                samples
            );
        }
    }

    #[test]
    fn every_tag_byte_is_a_tag_or_refused() {
        for byte in 0..=255u8 {
            if let Some(tag) = Tag::from_byte(byte) {
                assert_eq!(tag.byte(), byte);
            }
        }
    }
}
