//! Code rate and level of a keyed carrier as exactly as a recording has them: a square wave's first harmonics are fitted to
//! all of it, and the level is that in the middle of the times for which it is on.

use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_4, PI, SQRT_2, TAU};

use ato_under_test::receivers::Downmix;

/// Rate of the envelope, Hz, and its pass band, for codes with rates from [`FAST_HZ`] on; for slower codes both are
/// lower in proportion, so that the image of a low carrier stays outside.
const ENVELOPE_HZ: f32 = 600.0;
const PASS_HZ: f32 = 160.0;
const FAST_HZ: f64 = 20.0;
/// Longest part of a code that is fitted, s: its last one.
const LONGEST_S: f64 = 8.0;
/// Time that the filter takes to show a beginning, s.
const SETTLES_S: f64 = 0.02;
/// Harmonics that are fitted as far as the pass band has them, and the number of parameters of all.
const HARMONICS: [f64; 3] = [1.0, 3.0, 5.0];
const PARAMETERS: usize = 1 + 2 * HARMONICS.len();
/// How far from the known rate a rate is sought, Hz, and the steps in one cycle over the fitted part's length.
const AROUND_HZ: f64 = 0.2;
const STEPS: f64 = 6.0;
/// Halvings of the last step.
const HALVINGS: usize = 12;

/// The amplitude of a carrier, as far back as it is fitted.
pub(super) struct Envelope {
    downmix: Downmix,
    pass_hz: f32,
    values: VecDeque<f64>,
    taken: u64,
    sample_hz: f64,
}

impl Envelope {
    /// Envelope of a carrier with code rates up to `fastest_hz`.
    pub(super) fn new(carrier_hz: f64, fastest_hz: f64, sample_hz: f64) -> Self {
        let (downmix, pass_hz) = downmix(carrier_hz, fastest_hz, sample_hz);
        Self {
            downmix,
            pass_hz,
            values: VecDeque::new(),
            taken: 0,
            sample_hz,
        }
    }

    pub(super) fn take(&mut self, sample_mv: f32) {
        self.taken += 1;
        if let Some(value) = self.downmix.take(sample_mv) {
            self.values.push_back(value.abs().into());
            if self.values.len() as f64 > LONGEST_S * f64::from(self.downmix.envelope_hz) {
                self.values.pop_front();
            }
        }
    }

    /// Harmonics of a rate that the pass band has.
    fn harmonics(&self, rate_hz: f64) -> usize {
        let within = |of: &&f64| **of * rate_hz < f64::from(self.pass_hz);
        HARMONICS.iter().filter(within).count()
    }

    /// Rate, Hz, and level, mV rms, of the code heard between these times, s, whose rate is near `about_hz`.
    pub(super) fn fit(&self, [from_s, to_s]: [f64; 2], about_hz: f64) -> Option<(f64, f64)> {
        let value_hz = f64::from(self.downmix.envelope_hz);
        let now_s = self.taken as f64 / self.sample_hz;
        let back = |at_s: f64| (((now_s - at_s) * value_hz).max(0.0)) as usize;
        let last = self.values.len().checked_sub(back(to_s))?;
        let first = self.values.len().saturating_sub(back(from_s + SETTLES_S));
        let values: Vec<f64> = self.values.range(first.min(last)..last).copied().collect();
        let length_s = values.len() as f64 / value_hz;
        if length_s * about_hz < 2.0 {
            return None;
        }
        let explained =
            |hz: f64| fitted(&values, hz / value_hz, self.harmonics(hz)).map_or(0.0, |fit| fit.0);
        let mut step = 1.0 / STEPS / length_s;
        let most = (AROUND_HZ / step) as i32;
        let coarse = (-most..=most).map(|place| about_hz + f64::from(place) * step);
        let mut best = coarse
            .map(|hz| (hz, explained(hz)))
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        for _ in 0..HALVINGS {
            step /= 2.0;
            for hz in [best.0 - step, best.0 + step] {
                let now = explained(hz);
                if now > best.1 {
                    best = (hz, now);
                }
            }
        }
        let (_, [_, cos, sin]) = fitted(&values, best.0 / value_hz, self.harmonics(best.0))?;
        let middle = sin.atan2(cos);
        // A pause is noise alone; with the carrier there is as much noise, which is taken off.
        let mean_square = |phase: f64| {
            let near = values.iter().enumerate().filter(|(place, _)| {
                let angle = TAU * best.0 / value_hz * *place as f64 - middle - phase;
                (angle - TAU * (angle / TAU).round()).abs() < FRAC_PI_4
            });
            let (sum, count) = near.fold((0.0, 0), |(sum, count), (_, value)| {
                (sum + value * value, count + 1)
            });
            (count > 0).then(|| sum / f64::from(count))
        };
        let square = mean_square(0.0)? - mean_square(PI)?;
        Some((best.0, square.max(0.0).sqrt() / SQRT_2))
    }
}

/// The filter from samples to the envelope of a carrier with code rates up to `fastest_hz`; and its pass band, Hz.
pub(super) fn downmix(carrier_hz: f64, fastest_hz: f64, sample_hz: f64) -> (Downmix, f32) {
    let slow = (fastest_hz / FAST_HZ).min(1.0) as f32;
    let (envelope_hz, pass_hz) = (slow * ENVELOPE_HZ, slow * PASS_HZ);
    let downmix = Downmix::new(carrier_hz as f32, sample_hz as f32, envelope_hz, pass_hz);
    (downmix, pass_hz)
}

/// How much of the values so many harmonics of a rate, in cycles a value, explain; and mean, cosine, sine of the first.
fn fitted(values: &[f64], rate: f64, harmonics: usize) -> Option<(f64, [f64; 3])> {
    let size = 1 + 2 * harmonics;
    let mut matrix = [[0.0; PARAMETERS + 1]; PARAMETERS];
    for (place, value) in values.iter().enumerate() {
        let mut row = [1.0; PARAMETERS];
        for (harmonic, pair) in HARMONICS.iter().zip(row[1..size].chunks_exact_mut(2)) {
            let angle = TAU * harmonic * rate * place as f64;
            (pair[1], pair[0]) = angle.sin_cos();
        }
        for (one, line) in row.iter().zip(&mut matrix[..size]) {
            for (other, sum) in row[..size].iter().zip(&mut *line) {
                *sum += one * other;
            }
            line[PARAMETERS] += one * value;
        }
    }
    let sums = matrix.map(|line| line[PARAMETERS]);
    for pivot in 0..size {
        let line = matrix[pivot];
        if line[pivot].abs() < 1e-9 {
            return None;
        }
        for (place, other) in matrix[..size].iter_mut().enumerate() {
            let factor = other[pivot] / line[pivot];
            if place != pivot {
                for (value, of) in other.iter_mut().zip(line) {
                    *value -= factor * of;
                }
            }
        }
    }
    let parameter = |place: usize| matrix[place][PARAMETERS] / matrix[place][place];
    let explained = (0..size).map(|place| parameter(place) * sums[place]).sum();
    Some((explained, [0, 1, 2].map(parameter)))
}
