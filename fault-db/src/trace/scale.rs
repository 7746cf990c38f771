//! Converts samples to integers, where they are whole multiples of their channel's lsb.
//!
//! The loops over samples have no branches, so that the compiler vectorises them: they take most of the
//! time of encoding a trace.

/// Samples processed at a time.
const LANES: usize = 16;

/// Added to a double of up to 2^51, this rounds it to an integer, which then stands in the low bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52

/// Beyond this, adding [`ROUNDING`] no longer rounds to integers.
const MAX_SCALED: f64 = 2_251_799_813_685_248.0; // 2^51

/// Whether a sample is missing.
pub(super) fn has_gaps(samples: &[f64]) -> bool {
    let (chunks, rest) = samples.as_chunks::<LANES>();
    let gap = |samples: &[f64]| samples.iter().fold(false, |gap, s| gap | s.is_nan());
    chunks.iter().any(|chunk| gap(chunk)) || gap(rest)
}

/// Converts samples, none of which may be missing, to `integers`; returns whether reading has to divide. `None` if
/// reading would not return every sample exactly.
pub(super) fn scale(samples: &[f64], lsb: f64, integers: &mut Vec<i64>) -> Option<bool> {
    let per_unit = per_unit(lsb);
    let divides = per_unit >= 2.0 && (1.0 / per_unit - lsb).abs() <= lsb * 1e-9;
    if divides
        && scale_by(
            samples,
            integers,
            |sample| sample * per_unit,
            |n| n / per_unit,
        )
    {
        return Some(true);
    }
    scale_by(samples, integers, |sample| sample / lsb, |n| n * lsb).then_some(false)
}

fn scale_by(
    samples: &[f64],
    integers: &mut Vec<i64>,
    steps: impl Fn(f64) -> f64,
    sample: impl Fn(f64) -> f64,
) -> bool {
    let whole = |value: f64, out: &mut i64| {
        let placed = steps(value) + ROUNDING;
        let rounded = placed - ROUNDING;
        *out = placed.to_bits().wrapping_sub(ROUNDING.to_bits()) as i64;
        (rounded.abs() <= MAX_SCALED) & (sample(rounded) == value)
    };
    // The old content is overwritten.
    integers.resize(samples.len(), 0);
    let (values, last_values) = samples.as_chunks::<LANES>();
    let (out, last_out) = integers.as_chunks_mut::<LANES>();
    let all = |values: &[f64], out: &mut [i64]| {
        let pairs = values.iter().zip(out);
        pairs.fold(true, |all, (value, out)| all & whole(*value, out))
    };
    values.iter().zip(out).all(|(values, out)| all(values, out)) && all(last_values, last_out)
}

/// Number of lsb in one unit, if the lsb is a fraction of it.
pub(super) fn per_unit(lsb: f64) -> f64 {
    (1.0 / lsb).round()
}

/// Number of samples that differ from the one before.
pub(super) fn changes(integers: &[i64]) -> usize {
    let next = integers.get(1..).unwrap_or_default();
    let pairs = integers.iter().zip(next);
    pairs.fold(0, |changes, (a, b)| changes + usize::from(a != b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The plain conversion, which rounds halves away from zero.
    fn slow(samples: &[f64], lsb: f64) -> Option<Vec<i64>> {
        let whole = |sample: &f64| {
            let n = (sample / lsb).round();
            let divided = n / per_unit(lsb) == *sample || n * lsb == *sample;
            (divided && n.abs() <= MAX_SCALED).then_some(n as i64)
        };
        samples.iter().map(whole).collect()
    }

    #[test]
    fn fast_and_straightforward_agree() {
        let edge = MAX_SCALED;
        for (lsb, samples) in [
            (0.1, vec![0.3, 68.0, -12.7, 0.0, 1e6]),
            (1.0, vec![edge, -edge, 0.0, -0.0, 1.0]),
            (1.0, vec![edge * 2.0]),
            (0.5, vec![0.25]),
            (1.0, vec![0.5, 1.5]),
            (0.01, vec![f64::INFINITY]),
            (1e-300, vec![1.0]),
            (1.0, Vec::new()),
        ] {
            // Long enough for whole chunks and a rest.
            let samples: Vec<f64> = samples.repeat(2 * LANES + 3);
            let mut integers = Vec::new();
            let found = scale(&samples, lsb, &mut integers).map(|_| integers);
            assert_eq!(found, slow(&samples, lsb), "lsb {lsb}");
        }
    }

    #[test]
    fn a_missing_sample_is_detected_at_every_position() {
        for rows in [0, 1, LANES, 3 * LANES + 1] {
            let mut samples = vec![1.0; rows];
            assert!(!has_gaps(&samples));
            for row in 0..rows {
                samples[row] = f64::NAN;
                assert!(has_gaps(&samples), "row {row} of {rows}");
                samples[row] = 1.0;
            }
        }
    }
}
