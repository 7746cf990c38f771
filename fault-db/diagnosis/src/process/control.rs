//! Control charts: the short-term standard deviation, and violations of the control rules.

use serde::Serialize;

use super::Sample;

/// Mean moving range of two over the standard deviation of a normal process: d2 for n = 2.
const D2_OF_TWO: f64 = std::f64::consts::FRAC_2_SQRT_PI;

/// Distance of the control limits from the mean, in standard deviations.
pub(super) const CONTROL: f64 = 3.0;

/// Number of consecutive values on one side of the mean that chance does not explain.
const ON_ONE_SIDE: usize = 9;

/// Number of consecutive rising, or falling, values that chance does not explain.
const IN_A_ROW: usize = 6;

/// A violation of a control rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Sign {
    /// beyond_control (further from the mean than three standard deviations of an average of as many values),
    /// nine_on_one_side or six_in_a_row.
    pub kind: &'static str,
    /// Number of violations.
    pub times: u32,
    pub first_at_us: i64,
    pub last_at_us: i64,
}

pub(super) fn sigma(samples: &[Sample], n: f64, within: f64) -> Option<f64> {
    let free = n - samples.len() as f64;
    if free > 0.0 {
        return Some((within / free).max(0.0).sqrt());
    }
    let ranges = samples
        .windows(2)
        .map(|two| (two[1].value - two[0].value).abs());
    let mean = ranges.sum::<f64>() / (samples.len() as f64 - 1.0);
    (samples.len() > 1).then_some(mean / D2_OF_TWO)
}

pub(super) fn signs(samples: &[Sample], mean: f64, sigma: Option<f64>) -> Vec<Sign> {
    let mut found: Vec<Sign> = Vec::new();
    let mut note = |kind: &'static str, at_us: i64| {
        match found.iter_mut().find(|sign| sign.kind == kind) {
            Some(sign) => (sign.times, sign.last_at_us) = (sign.times + 1, at_us),
            None => found.push(Sign {
                kind,
                times: 1,
                first_at_us: at_us,
                last_at_us: at_us,
            }),
        };
    };
    let (mut side, mut rising) = ((0i8, 0usize), (0i8, 0usize));
    let go_on = |run: &mut (i8, usize), way: i8| {
        *run = if way != 0 && run.0 == way {
            (way, run.1 + 1)
        } else {
            (way, 1)
        };
        run.1
    };
    let way = |a: f64, b: f64| (a > b) as i8 - (a < b) as i8;
    for (index, sample) in samples.iter().enumerate() {
        // The mean of many values scatters less than that of few.
        let reach = sigma.map(|sigma| CONTROL * sigma / f64::from(sample.n).sqrt());
        if reach.is_some_and(|reach| (sample.value - mean).abs() > reach) {
            note("beyond_control", sample.at_us);
        }
        if go_on(&mut side, way(sample.value, mean)) == ON_ONE_SIDE {
            note("nine_on_one_side", sample.at_us);
        }
        if index > 0 && go_on(&mut rising, way(sample.value, samples[index - 1].value)) == IN_A_ROW
        {
            note("six_in_a_row", sample.at_us);
        }
    }
    found
}
