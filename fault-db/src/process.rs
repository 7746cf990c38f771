//! Statistical process control of a measured value over time: mean, spread, drift, and when a limit will
//! be crossed. Shewhart's charts of individuals and of averages, on plain lists of numbers.

use serde::Serialize;

/// Microseconds of a day.
const DAY_US: f64 = 86.4e9;

/// Mean moving range of two over the standard deviation of a normal process: d2 for n = 2.
const D2_OF_TWO: f64 = std::f64::consts::FRAC_2_SQRT_PI;

/// Distance of the control limits from the mean, in standard deviations.
const CONTROL: f64 = 3.0;

/// Consecutive values on one side of the mean that chance does not explain.
const ON_ONE_SIDE: usize = 9;

/// Consecutive rising, or falling, values that chance does not explain.
const IN_A_ROW: usize = 6;

/// Limit of a forecast, days.
const FORESEEN_DAYS: f64 = 3650.0;

/// One value, or the mean of several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When, microseconds.
    pub at_us: i64,
    /// The value or mean.
    pub value: f64,
    /// Number of values.
    pub n: u32,
    /// Sum of their squared distances from their mean; 0 for a single value.
    pub scatter: f64,
}

/// The statistics of a series of samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Process {
    /// Number of values.
    pub n: u32,
    /// Mean.
    pub mean: f64,
    /// Short-term standard deviation: of single values from their moving range, of groups from their own
    /// scatter. `None` for fewer than two.
    pub sigma: Option<f64>,
    /// Standard deviation of all values about their mean, including drift.
    pub sigma_overall: Option<f64>,
    /// Control limits. For means of groups of unequal size these are the limits for the average size; the
    /// signs below use each group's own limits.
    pub control: Option<(f64, f64)>,
    /// Least-squares line through the values; `None` for fewer than three times.
    pub line: Option<Line>,
    /// Violations of the control rules, by kind.
    pub signs: Vec<Sign>,
}

/// A least-squares line.
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
    /// 0.975 quantile of Student's t for its degrees of freedom.
    #[serde(skip)]
    likely: f64,
    #[serde(skip)]
    last_us: i64,
}

/// A violation of a control rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Sign {
    /// beyond_control (three standard deviations of a mean of as many values as it is of), nine_on_one_side
    /// or six_in_a_row.
    pub kind: &'static str,
    /// Number of violations.
    pub times: u32,
    /// The first.
    pub first_at_us: i64,
    /// The last.
    pub last_at_us: i64,
}

/// Process capability: the spread compared with the limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Capability {
    /// Width between the limits over six standard deviations; `None` with one limit.
    pub cp: Option<f64>,
    /// Distance of the mean from the nearer limit over three standard deviations.
    pub cpk: f64,
}

/// When a limit will be crossed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Forecast {
    /// The limit.
    pub limit: f64,
    /// When the line crosses it; before the last sample if it has done so already.
    pub at_us: i64,
    /// Start of the 95 % interval.
    pub earliest_us: i64,
    /// End of the 95 % interval; `None` if the crossing may never happen.
    pub latest_us: Option<i64>,
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

    /// When the limit that it drifts towards will be crossed; `None` if the drift is not significant, or not
    /// towards a limit, or not within ten years.
    pub fn forecast(&self, low: Option<f64>, high: Option<f64>) -> Option<Forecast> {
        let line = self.line.as_ref()?;
        let limit = if line.slope_per_day > 0.0 { high } else { low }?;
        line.crosses(limit)
    }
}

impl Line {
    fn through(samples: &[Sample]) -> Option<Self> {
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

    /// Half the 95 % interval of the slope, in a day. The fewer samples, the more standard errors it has.
    pub fn slope_reach(&self) -> f64 {
        self.likely * self.slope_error
    }

    /// Whether the slope is significant.
    pub fn is_certain(&self) -> bool {
        self.slope_per_day.abs() > self.slope_reach()
    }

    /// Where the line, and its 95 % band, cross a value.
    fn crosses(&self, limit: f64) -> Option<Forecast> {
        if !self.is_certain() {
            return None;
        }
        let (b, c) = (self.slope_per_day, limit - self.middle.1);
        let days = self.middle.0 + c / b;
        if days > FORESEEN_DAYS {
            return None;
        }
        // (c - b u)² = k² (v + e² u²): where the band's edge is at the limit, u days from the middle.
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
fn student(free: usize) -> f64 {
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

fn sigma(samples: &[Sample], n: f64, within: f64) -> Option<f64> {
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

fn signs(samples: &[Sample], mean: f64, sigma: Option<f64>) -> Vec<Sign> {
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

#[cfg(test)]
mod tests {
    use super::*;

    const DAY: i64 = 86_400_000_000;

    fn single(values: &[f64]) -> Vec<Sample> {
        let sample = |(day, value): (usize, &f64)| Sample {
            at_us: day as i64 * DAY,
            value: *value,
            n: 1,
            scatter: 0.0,
        };
        values.iter().enumerate().map(sample).collect()
    }

    /// Montgomery's paint viscosity batches (Statistical Quality Control, example 6.5): mean 33.52,
    /// mean moving range 0.48, limits 32.24 and 34.80.
    #[test]
    fn control_limits_are_those_of_an_individuals_chart() {
        let values = [
            33.75, 33.05, 34.00, 33.81, 33.46, 34.02, 33.68, 33.27, 33.49, 33.20, 33.62, 33.00,
            33.54, 33.12, 33.84,
        ];
        let process = Process::of(&single(&values)).expect("values");
        let (low, high) = process.control.expect("limits");
        assert!((process.mean - 33.52).abs() < 0.01, "{}", process.mean);
        assert!(
            (low - 32.24).abs() < 0.01 && (high - 34.80).abs() < 0.01,
            "{low} {high}"
        );
        assert!(process.signs.is_empty());
    }

    /// 0.42 s rising 1 ms a day: 0.58 s after 160 days, whatever the noise.
    #[test]
    fn a_creeping_value_crosses_its_limit_when_it_does() {
        let noise = [0.004, -0.003, 0.001, -0.005, 0.003, 0.0, 0.002, -0.002];
        let values: Vec<f64> = (0..60)
            .map(|day| 0.42 + 0.001 * f64::from(day) + noise[day as usize % noise.len()])
            .collect();
        let process = Process::of(&single(&values)).expect("values");
        let forecast = process.forecast(None, Some(0.58)).expect("it will");
        let days = |at_us: i64| at_us as f64 / DAY as f64;
        assert!(
            (days(forecast.at_us) - 160.0).abs() < 4.0,
            "{}",
            days(forecast.at_us)
        );
        assert!(forecast.earliest_us < forecast.at_us);
        assert!(forecast.latest_us.expect("soon") > forecast.at_us);
        assert!(
            process.forecast(Some(0.2), None).is_none(),
            "it moves away from it"
        );
        assert!(
            process
                .signs
                .iter()
                .any(|sign| sign.kind == "nine_on_one_side")
        );
    }

    #[test]
    fn noise_without_drift_foretells_nothing() {
        let values: Vec<f64> = (0..50)
            .map(|n| 0.42 + 0.01 * f64::from(n * 7 % 11 - 5))
            .collect();
        let process = Process::of(&single(&values)).expect("values");
        assert_eq!(process.forecast(Some(0.0), Some(0.58)), None);
        let fit = process.capability(Some(0.2), Some(0.58)).expect("limits");
        assert!(fit.cp.expect("two limits") > fit.cpk);
        assert!(process.capability(None, None).is_none());
    }

    #[test]
    fn days_of_several_values_count_as_all_of_them() {
        let single = Process::of(&single(&[1.0, 3.0, 1.0, 3.0])).expect("values");
        let day = |day: i64| Sample {
            at_us: day * DAY,
            value: 2.0,
            n: 2,
            scatter: 2.0,
        };
        let daily = Process::of(&[day(0), day(1)]).expect("values");
        assert_eq!((single.mean, single.n), (daily.mean, daily.n));
        assert_eq!(single.sigma_overall, daily.sigma_overall);
        assert_eq!(Process::of(&[]), None);
        assert_eq!(Process::of(&[day(0)]).and_then(|one| one.line), None);
    }

    #[test]
    fn equal_values_are_a_process_without_scatter() {
        let process = Process::of(&single(&[2.0; 12])).expect("values");
        assert_eq!(process.capability(Some(1.0), Some(3.0)), None);
        assert_eq!(process.forecast(Some(1.0), Some(3.0)), None);
        assert!(process.signs.is_empty(), "{:?}", process.signs);
    }

    /// Against the table of Abramowitz and Stegun, and the normal quantile.
    #[test]
    fn the_fewer_values_the_more_standard_errors_are_likely() {
        for (free, expected) in [
            (1, 12.706),
            (2, 4.303),
            (3, 3.182),
            (4, 2.776),
            (5, 2.571),
            (6, 2.447),
            (10, 2.228),
            (30, 2.042),
            (120, 1.980),
            (100_000_000, 1.960),
        ] {
            let found = student(free);
            assert!((found - expected).abs() <= 0.001, "{free}: {found}");
        }
    }

    /// Goal: three values that rise about evenly give no forecast: with one degree of freedom their slope is
    /// not significant. With as many again it is.
    /// Method: a slope of three and a half standard errors, more than 1.96 and less than 12.7.
    #[test]
    fn three_values_are_too_few_to_be_certain() {
        let three = Process::of(&single(&[1.0, 2.5, 3.0])).expect("values");
        let line = three.line.expect("a line");
        let errors = line.slope_per_day / line.slope_error;
        assert!((3.0..12.0).contains(&errors), "{errors}");
        assert!(!line.is_certain());
        assert!((line.slope_reach() - 12.706 * line.slope_error).abs() < 1e-9);
        assert_eq!(three.forecast(None, Some(5.0)), None);
        let six = Process::of(&single(&[1.0, 2.5, 3.0, 4.0, 5.5, 6.0])).expect("values");
        assert!(six.line.expect("a line").is_certain());
        assert!(six.forecast(None, Some(8.0)).is_some());
    }

    /// Goal: each mean is judged by the limits for means of as many values.
    /// Method: sigma is 1. A single value may be 2.5 off among days of many values, and a mean of 99 not 0.4
    /// among days of few; limits for the average number of values a day would say the reverse of both.
    #[test]
    fn each_day_is_judged_by_the_limits_of_as_many_values() {
        let day = |day: i64, n: u32, value: f64| Sample {
            at_us: day * DAY,
            value,
            n,
            scatter: f64::from(n - 1),
        };
        let beyond = |samples: &[Sample]| -> Vec<i64> {
            let signs = Process::of(samples).expect("values").signs;
            let beyond = signs.iter().filter(|sign| sign.kind == "beyond_control");
            beyond.map(|sign| sign.first_at_us / DAY).collect()
        };
        let one_among_many = [day(0, 99, 0.0), day(1, 1, 2.5), day(2, 99, 0.0)];
        assert_eq!(beyond(&one_among_many), [0; 0]);
        let mut many_among_few: Vec<_> = (0..200).map(|n| day(n, 2, 0.0)).collect();
        many_among_few.push(day(200, 99, 0.5));
        assert_eq!(beyond(&many_among_few), [200]);
    }
}
