//! How loud a channel is, whether or not a receiver understands it, and fewer samples of what has too many.

use std::f64::consts::TAU;

use super::picture::Spectrum;

/// Level and strongest line of a channel.
pub(super) struct Meter {
    /// The strongest line is that of this spectrum.
    pub(super) spectrum: Spectrum,
    sum: f64,
    count: u64,
    /// Greatest mean square of a part, mV².
    most: f64,
}

impl Meter {
    pub(super) fn new(sample_hz: f64) -> Self {
        Self {
            spectrum: Spectrum::new(sample_hz, 1),
            sum: 0.0,
            count: 0,
            most: 0.0,
        }
    }

    /// Takes samples, mV; the greatest level is that of a part of so many.
    pub(super) fn take(&mut self, samples: &[f32], part: usize) {
        for part in samples.chunks(part) {
            let squares = part.iter().map(|sample| f64::from(sample * sample));
            let sum: f64 = squares.sum();
            self.sum += sum;
            self.count += part.len() as u64;
            self.most = self.most.max(sum / part.len() as f64);
        }
        samples.iter().for_each(|mv| self.spectrum.take(*mv));
    }

    /// Level of the whole and of its loudest part, mV rms.
    pub(super) fn levels_mv(&self) -> (f64, f64) {
        let mean = self.sum / self.count.max(1) as f64;
        (mean.sqrt(), self.most.sqrt())
    }
}

/// Length of the filter over the number of samples that are taken together.
const LENGTH: usize = 16;
/// Edge of the filter's pass band over the rate of the samples that the filter gives.
const EDGE: f64 = 0.375;

/// Makes one sample of so many, without what is too high for the lower rate.
#[derive(Clone)]
pub(super) struct Decimator {
    pub(super) by: usize,
    taps: Vec<f32>,
    line: Vec<f32>,
}

impl Decimator {
    pub(super) fn new(by: usize) -> Self {
        let length = LENGTH * by;
        let taps = (0..length).map(|place| {
            let at = (place as f64 - (length - 1) as f64 / 2.0) / by as f64;
            let angle = TAU * EDGE * at;
            let hann = 0.5 + 0.5 * (TAU * at / LENGTH as f64).cos();
            let sinc = if angle == 0.0 {
                1.0
            } else {
                angle.sin() / angle
            };
            (2.0 * EDGE / by as f64 * sinc * hann) as f32
        });
        Self {
            by,
            taps: taps.collect(),
            line: vec![0.0; length - by],
        }
    }

    pub(super) fn take(&mut self, samples: &[f32]) -> Vec<f32> {
        self.line.extend_from_slice(samples);
        let windows = self.line.windows(self.taps.len()).step_by(self.by);
        let slower: Vec<f32> = windows
            .map(|line| line.iter().zip(&self.taps).map(|(a, b)| a * b).sum())
            .collect();
        self.line.drain(..slower.len() * self.by);
        slower
    }
}
