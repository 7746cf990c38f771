//! The least-squares line through the samples, and the forecast of when the line crosses a limit.

use serde::Serialize;

use super::Sample;

/// Microseconds of a day.
const DAY_US: f64 = 86.4e9;

/// Longest forecast, days.
const FORESEEN_DAYS: f64 = 3650.0;

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Line {
    /// Change in a day.
    pub slope_per_day: f64,
    /// Standard error of the slope.
    pub slope_error: f64,
    /// Value at the last sample.
    pub now: f64,
    #[serde(skip)]
    middle: (f64, f64),
    #[serde(skip)]
    weight: f64,
    /// 0.975 quantile of Student's t for the line's degrees of freedom.
    #[serde(skip)]
    likely: f64,
    #[serde(skip)]
    last_us: i64,
}

/// When a limit will be crossed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Forecast {
    pub limit: f64,
    /// When the line crosses the limit, µs; before the last sample if it has crossed already.
    pub at_us: i64,
    /// Start of the 95 % interval, µs.
    pub earliest_us: i64,
    /// End of the 95 % interval, µs; `None` if the line may never cross the limit.
    pub latest_us: Option<i64>,
}

impl Line {
    pub(super) fn through(samples: &[Sample]) -> Option<Self> {
        let (first, last) = (samples.first()?, samples.last()?);
        let day = |sample: &Sample| (sample.at_us - first.at_us) as f64 / DAY_US;
        let weight: f64 = samples.iter().map(|sample| f64::from(sample.n)).sum();
        let mean = |of: &dyn Fn(&Sample) -> f64| -> f64 {
            let sum: f64 = samples
                .iter()
                .map(|sample| f64::from(sample.n) * of(sample))
                .sum();
            sum / weight
        };
        let middle = (mean(&day), mean(&|sample| sample.value));
        let spread = weight * mean(&|sample| (day(sample) - middle.0).powi(2));
        if samples.len() < 3 || spread <= 0.0 {
            return None;
        }
        let together =
            weight * mean(&|sample| (day(sample) - middle.0) * (sample.value - middle.1));
        let slope = together / spread;
        let off =
            |sample: &Sample| (sample.value - middle.1 - slope * (day(sample) - middle.0)).powi(2);
        let free = samples.len() - 2;
        let variance = weight * mean(&off) / free as f64;
        Some(Self {
            slope_per_day: slope,
            slope_error: (variance / spread).sqrt(),
            now: middle.1 + slope * (day(last) - middle.0),
            middle: (middle.0 - day(last), middle.1),
            weight: variance / weight,
            likely: student(free),
            last_us: last.at_us,
        })
    }

    /// Half the 95 % interval of the slope, per day: the fewer samples, the more standard errors.
    pub fn slope_reach(&self) -> f64 {
        self.likely * self.slope_error
    }

    /// Whether the slope is significant.
    pub fn is_certain(&self) -> bool {
        self.slope_per_day.abs() > self.slope_reach()
    }

    /// Where the line, and its 95 % band, cross a value.
    pub(super) fn crosses(&self, limit: f64) -> Option<Forecast> {
        if !self.is_certain() {
            return None;
        }
        let (b, c) = (self.slope_per_day, limit - self.middle.1);
        let days = self.middle.0 + c / b;
        if days > FORESEEN_DAYS {
            return None;
        }
        // (c - b u)² = k² (v + e² u²): the edge of the band reaches the limit u days from the middle.
        let k2 = self.likely * self.likely;
        let square = b * b - k2 * self.slope_error.powi(2);
        let root = ((c * b).powi(2) - square * (c * c - k2 * self.weight))
            .max(0.0)
            .sqrt();
        let at = |u: f64| self.last_us + ((self.middle.0 + u) * DAY_US) as i64;
        let (one, other) = ((c * b - root) / square, (c * b + root) / square);
        let latest = one.max(other);
        Some(Forecast {
            limit,
            at_us: at(c / b),
            earliest_us: at(one.min(other)),
            latest_us: (self.middle.0 + latest < FORESEEN_DAYS).then(|| at(latest)),
        })
    }
}

/// The 0.975 quantile of Student's t distribution. For few degrees of freedom from a table (Abramowitz and
/// Stegun, Handbook of Mathematical Functions, table 26.10), for more by the expansion about the normal
/// quantile (there, 26.7.5), with an error below 0.001.
pub(super) fn student(free: usize) -> f64 {
    const NORMAL: f64 = 1.959_964;
    const OF_FEW: [f64; 5] = [f64::INFINITY, 12.706, 4.303, 3.182, 2.776];
    if let Some(quantile) = OF_FEW.get(free) {
        return *quantile;
    }
    let n = free as f64;
    let x = |power: i32| NORMAL.powi(power);
    let terms = [
        (x(3) + x(1)) / 4.0,
        (5.0 * x(5) + 16.0 * x(3) + 3.0 * x(1)) / 96.0,
        (3.0 * x(7) + 19.0 * x(5) + 17.0 * x(3) - 15.0 * x(1)) / 384.0,
        (79.0 * x(9) + 776.0 * x(7) + 1482.0 * x(5) - 1920.0 * x(3) - 945.0 * x(1)) / 92160.0,
    ];
    terms.iter().rev().fold(0.0, |sum, term| (sum + term) / n) + NORMAL
}
