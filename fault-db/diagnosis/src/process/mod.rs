//! Statistical process control of a measured value over time: mean, spread, drift, and when a limit will
//! be crossed. Shewhart's charts of individuals and of averages, on plain lists of numbers.

mod control;
mod line;

use serde::Serialize;

pub use control::Sign;
use control::{CONTROL, sigma, signs};
pub use line::{Forecast, Line};

/// One value, or the mean of several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time of the value, µs.
    pub at_us: i64,
    pub value: f64,
    /// Number of values.
    pub n: u32,
    /// Sum of the values' squared distances from their mean; 0 for a single value.
    pub scatter: f64,
}

/// The statistics of a series of samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Process {
    /// Number of values.
    pub n: u32,
    pub mean: f64,
    /// Short-term standard deviation: of single values from their moving range, of groups from the scatter within each.
    /// `None` for fewer than two values.
    pub sigma: Option<f64>,
    /// Standard deviation of all values about their mean, including drift.
    pub sigma_overall: Option<f64>,
    /// Control limits. For means of groups of unequal size these are the limits for the average size; `signs` uses each
    /// group's own limits.
    pub control: Option<(f64, f64)>,
    /// Least-squares line through the values; `None` for fewer than three times.
    pub line: Option<Line>,
    /// Violations of the control rules, by kind.
    pub signs: Vec<Sign>,
}

/// Process capability: the spread compared with the limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Capability {
    /// Width between the limits over six standard deviations; `None` with one limit.
    pub cp: Option<f64>,
    /// Distance of the mean from the nearer limit over three standard deviations.
    pub cpk: f64,
}

impl Process {
    /// Statistics of samples in order of time; `None` without values.
    pub fn of(samples: &[Sample]) -> Option<Self> {
        let n: f64 = samples.iter().map(|sample| f64::from(sample.n)).sum();
        if n <= 0.0 {
            return None;
        }
        let weighted = |of: &dyn Fn(&Sample) -> f64| -> f64 {
            samples
                .iter()
                .map(|sample| f64::from(sample.n) * of(sample))
                .sum()
        };
        let mean = weighted(&|sample| sample.value) / n;
        let within: f64 = samples.iter().map(|sample| sample.scatter).sum();
        let about_mean = within + weighted(&|sample| (sample.value - mean).powi(2));
        let sigma_overall = (n > 1.0).then(|| (about_mean / (n - 1.0)).max(0.0).sqrt());
        let sigma = sigma(samples, n, within);
        let typical_n = n / samples.len() as f64;
        let control = sigma.map(|sigma| {
            let reach = CONTROL * sigma / typical_n.sqrt();
            (mean - reach, mean + reach)
        });
        Some(Self {
            n: samples.iter().map(|sample| sample.n).sum(),
            mean,
            sigma,
            sigma_overall,
            control,
            line: Line::through(samples),
            signs: signs(samples, mean, sigma),
        })
    }

    /// Capability for these limits; `None` without a limit or without scatter.
    pub fn capability(&self, low: Option<f64>, high: Option<f64>) -> Option<Capability> {
        let sigma = self.sigma.filter(|sigma| *sigma > 0.0)?;
        let below = low.map(|low| (self.mean - low) / (3.0 * sigma));
        let above = high.map(|high| (high - self.mean) / (3.0 * sigma));
        let cpk = match (below, above) {
            (Some(below), Some(above)) => below.min(above),
            (below, above) => below.or(above)?,
        };
        let cp = low
            .zip(high)
            .map(|(low, high)| (high - low) / (6.0 * sigma));
        Some(Capability { cp, cpk })
    }

    /// When the values will cross the limit they drift towards; `None` if the drift is not significant, not towards a
    /// limit, or crosses it later than in ten years.
    pub fn forecast(&self, low: Option<f64>, high: Option<f64>) -> Option<Forecast> {
        let line = self.line.as_ref()?;
        let limit = if line.slope_per_day > 0.0 { high } else { low }?;
        line.crosses(limit)
    }
}

#[cfg(test)]
mod tests;
