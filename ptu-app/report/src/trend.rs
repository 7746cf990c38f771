//! A measurement over time with its control limits, for the command line and the window.

use diagnosis::process::{Process, Sample};
use fault_db::{
    Store, StoreError, TrendDay, TrendLimits, TrendPoint, TrendQuery, TrendStep, TrendUnit,
};

use ptu_runs::clock::{local_day, utc_day};

/// Values of a measurement over time.
pub struct Trend {
    pub query: TrendQuery,
    /// The latest limits, with their unit; no limits if the steps have several.
    pub limits: TrendLimits,
    /// Value by value, or day by day.
    pub course: TimeSeries,
    pub process: Option<Process>,
    /// Procedures with this measurement.
    pub procedures: Vec<String>,
    /// Steps with this measurement in the latest runs, with their limits.
    pub steps: Vec<TrendStep>,
}

/// Values over time.
pub enum TimeSeries {
    Points(Vec<TrendPoint>),
    Days(Vec<TrendDay>, Vec<TrendUnit>),
}

impl Trend {
    /// The trend of one unit value by value, of all units day by day; none if the query finds no
    /// measurement.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn read(store: &Store, query: TrendQuery) -> Result<Option<Self>, StoreError> {
        let Some(mut limits) = store.trend_limits(&query)? else {
            return Ok(None);
        };
        let steps = store.trend_steps(&query)?;
        if limits_differ(&steps) {
            // No limit holds for all values.
            (limits.low, limits.high) = (None, None);
        }
        let course = match query.unit {
            Some(_) => TimeSeries::Points(store.trend(&query)?),
            None => TimeSeries::Days(store.trend_by_day(&query)?, store.trend_by_unit(&query)?),
        };
        Ok(Some(Self {
            process: Process::of(&course.samples()),
            limits,
            course,
            procedures: store.measuring_procedures(&query.measurement)?,
            steps,
            query,
        }))
    }

    /// Whether the values are of steps with different limits.
    pub fn limits_differ(&self) -> bool {
        limits_differ(&self.steps)
    }
}

impl TimeSeries {
    /// Names of the days. Days of a fleet are counted in UTC; west of Greenwich such a day begins the evening before.
    pub fn day_name(&self) -> fn(i64) -> String {
        match self {
            Self::Points(_) => local_day,
            Self::Days(..) => utc_day,
        }
    }

    pub fn samples(&self) -> Vec<Sample> {
        match self {
            Self::Points(points) => points
                .iter()
                .filter_map(|point| {
                    Some(Sample {
                        at_us: point.at_us,
                        value: point.value?,
                        n: 1,
                        scatter: 0.0,
                    })
                })
                .collect(),
            Self::Days(days, _) => days
                .iter()
                .map(|day| Sample {
                    at_us: day.day_us,
                    value: day.mean,
                    n: day.n,
                    scatter: (day.sum_of_squares - f64::from(day.n) * day.mean * day.mean).max(0.0),
                })
                .collect(),
        }
    }
}

fn limits_differ(steps: &[TrendStep]) -> bool {
    let limits = |step: &TrendStep| (step.low, step.high);
    steps
        .windows(2)
        .any(|pair| limits(&pair[0]) != limits(&pair[1]))
}
