//! A measured value over time: every value, by day, and by unit.

use serde::Serialize;

use super::distinct_names::each_value;
use super::filter::Conditions;
use crate::backend::{Backend, from_row, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::schema::sql_functions::{DAY_US, month_start_us, utc_day, utc_month};
use crate::store::Store;
use crate::values::record::{Verdict, part_name};

const BY_DAY: &str = "reading a measurement by day";

/// Selects values of a measurement; `None` does not restrict.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TrendQuery {
    /// Name of the measurement.
    pub measurement: String,
    /// Serial number of the unit.
    pub unit: Option<String>,
    /// Line of the run.
    pub line: Option<String>,
    /// The train the unit was in.
    pub train: Option<String>,
    /// The procedure that measured it: each may have its own limits.
    pub procedure: Option<String>,
    /// The step that measured it: each may have its own limits, too.
    pub step: Option<String>,
    /// Runs that started at this time or later, µs since 1970.
    pub since_us: Option<i64>,
    /// Runs that started before this time, µs since 1970.
    pub until_us: Option<i64>,
}

/// One value of a measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrendPoint {
    /// Start of the run, µs since 1970. Points of one run come in the order of its steps.
    pub at_us: i64,
    /// The run.
    pub run_id: Id,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// The value; `None` if nothing could be measured.
    pub value: Option<f64>,
    /// Unit of value and limits.
    pub unit: String,
    /// Lowest allowed value.
    pub low: Option<f64>,
    /// Highest allowed value.
    pub high: Option<f64>,
    /// Verdict of the measurement.
    pub verdict: Verdict,
}

/// The values of one day, UTC.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TrendDay {
    /// Beginning of the day, microseconds since 1970.
    pub day_us: i64,
    /// Number of values.
    pub n: u32,
    /// Their mean.
    pub mean: f64,
    /// Sum of the squares of the values.
    pub sum_of_squares: f64,
    /// Smallest value.
    pub least: f64,
    /// Greatest value.
    pub most: f64,
    /// Number of values whose verdict is not `passed`.
    pub not_passed: u32,
}

/// The values of one unit in whole months, UTC.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrendUnit {
    /// Serial number.
    pub unit_serial: String,
    /// Number of values.
    pub n: u32,
    /// Their mean.
    pub mean: f64,
    /// Change in a day, by least squares; `None` for fewer than two different times.
    pub slope_per_day: Option<f64>,
}

/// A step that makes the measurement, with its limits in one of the latest runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrendStep {
    /// The procedure.
    pub procedure: String,
    /// The step.
    pub step: String,
    /// Lowest allowed value.
    pub low: Option<f64>,
    /// Highest allowed value.
    pub high: Option<f64>,
}

/// The limits of the latest value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrendLimits {
    /// Unit of values and limits.
    pub unit: String,
    /// Lowest allowed value.
    pub low: Option<f64>,
    /// Highest allowed value.
    pub high: Option<f64>,
}

impl Store {
    /// Every value, oldest first.
    ///
    /// # Errors
    /// There is no such measurement or unit, or the file or server cannot be read.
    pub fn trend(&self, query: &TrendQuery) -> Result<Vec<TrendPoint>, StoreError> {
        let mut conditions = self.measured(query)?;
        conditions.require("u.seq = r.unit");
        let sql = format!(
            "SELECT r.started_at_us, r.id, u.serial, m.value, m.unit, m.low, m.high, m.verdict
             FROM run r CROSS JOIN unit u CROSS JOIN measurement m
             {} ORDER BY 1, m.run, m.step_index, m.ordinal",
            conditions.sql()
        );
        self.select("reading a measurement", &sql, conditions.values(), |row| {
            Ok(from_row!(row => TrendPoint:
                at_us, run_id, unit_serial, value, unit, low, high, verdict
            ))
        })
    }

    /// The values day by day, oldest first.
    ///
    /// # Errors
    /// As [`trend`](Self::trend).
    pub fn trend_by_day(&self, query: &TrendQuery) -> Result<Vec<TrendDay>, StoreError> {
        let is_fleet = query.unit.is_none()
            && query.line.is_none()
            && query.train.is_none()
            && query.step.is_none();
        // The file keeps sums of whole days; at both ends of the span an incomplete day may remain.
        let low = query.since_us.map_or(i64::MIN, |us| utc_day(us - 1) + 1);
        let high = query.until_us.map_or(i64::MAX, utc_day);
        if matches!(&self.backend, Backend::Server(_)) || !is_fleet || low >= high {
            return self.days(query);
        }
        self.measured(query)?;
        let mut kept = Conditions::default();
        kept.add("m.name = ?", Some(query.measurement.clone()));
        kept.add("m.procedure = ?", query.procedure.clone());
        kept.add("m.day >= ?", Some(low));
        kept.add("m.day < ?", Some(high));
        let sql = format!(
            "SELECT m.day, CAST(sum(m.n) AS BIGINT), sum(m.x), sum(m.xx), min(m.least), max(m.most),
                CAST(sum(m.not_passed) AS BIGINT)
             FROM measured_day m {} GROUP BY 1",
            kept.sql()
        );
        let mut days = self.select(BY_DAY, &sql, kept.values(), trend_day)?;
        if query.since_us.is_some() {
            days.extend(self.days(&TrendQuery {
                until_us: Some(low * DAY_US),
                ..query.clone()
            })?);
        }
        if query.until_us.is_some() {
            days.extend(self.days(&TrendQuery {
                since_us: Some(high * DAY_US),
                ..query.clone()
            })?);
        }
        days.sort_by_key(|day| day.day_us);
        Ok(days)
    }

    /// The values day by day, computed from single values.
    fn days(&self, query: &TrendQuery) -> Result<Vec<TrendDay>, StoreError> {
        let mut conditions = self.measured(query)?;
        conditions.require("m.value IS NOT NULL");
        let sql = format!(
            "SELECT utc_day(r.started_at_us), count(*), sum(m.value), sum(m.value * m.value),
                min(m.value), max(m.value), sum(CASE WHEN m.verdict <> 'passed' THEN 1 ELSE 0 END)
             FROM run r CROSS JOIN measurement m {} GROUP BY 1 ORDER BY 1",
            conditions.sql()
        );
        self.select(BY_DAY, &sql, conditions.values(), trend_day)
    }

    /// The values by unit, in the whole months that the span touches.
    ///
    /// # Errors
    /// As [`trend`](Self::trend).
    pub fn trend_by_unit(&self, query: &TrendQuery) -> Result<Vec<TrendUnit>, StoreError> {
        const DOING: &str = "reading a measurement by unit";
        let query = TrendQuery {
            since_us: query.since_us.map(|us| month_start_us(utc_month(us))),
            until_us: query
                .until_us
                .map(|us| month_start_us(utc_month(us - 1) + 1)),
            ..query.clone()
        };
        let mut conditions = self.measured(&query)?;
        let is_kept = query.line.is_none() && query.train.is_none() && query.step.is_none();
        let sql = match &self.backend {
            Backend::File(_) if is_kept => {
                conditions = Conditions::default();
                conditions.add("m.name = ?", Some(query.measurement.clone()));
                conditions.add("u.serial = ?", query.unit.clone());
                conditions.add("m.procedure = ?", query.procedure.clone());
                conditions.add("m.month >= ?", query.since_us.map(utc_month));
                conditions.add("m.month < ?", query.until_us.map(utc_month));
                format!(
                    "SELECT u.serial, CAST(sum(m.n) AS BIGINT), sum(m.x), sum(m.t), sum(m.tt), sum(m.tx)
                     FROM measured_month m JOIN unit u ON u.seq = m.unit {}
                     GROUP BY u.serial ORDER BY u.serial",
                    conditions.sql()
                )
            }
            _ => {
                conditions.require("u.seq = r.unit");
                conditions.require("m.value IS NOT NULL");
                // Days since the beginning of 2020, as in the schema.
                let t = "(CAST(r.started_at_us - 1577836800000000 AS DOUBLE PRECISION) / 86400e6)";
                format!(
                    "SELECT u.serial, count(*), sum(m.value), sum({t}), sum({t} * {t}),
                        sum({t} * m.value)
                     FROM run r CROSS JOIN unit u CROSS JOIN measurement m
                     {} GROUP BY u.serial ORDER BY u.serial",
                    conditions.sql()
                )
            }
        };
        self.select(DOING, &sql, conditions.values(), |row| {
            let count: u32 = row.get(1)?;
            let n = f64::from(count);
            let [x, t, tt, tx] = [row.get(2)?, row.get(3)?, row.get(4)?, row.get::<f64>(5)?];
            let spread: f64 = tt - t * t / n;
            Ok(TrendUnit {
                unit_serial: row.get(0)?,
                n: count,
                mean: x / n,
                slope_per_day: (spread > 1e-6 * n).then(|| (tx - t * x / n) / spread),
            })
        })
    }

    /// Unit and limits of the latest value.
    ///
    /// # Errors
    /// As [`trend`](Self::trend).
    pub fn trend_limits(&self, query: &TrendQuery) -> Result<Option<TrendLimits>, StoreError> {
        let conditions = self.measured(query)?;
        let sql = format!(
            "SELECT m.unit, m.low, m.high FROM run r CROSS JOIN measurement m {}
             ORDER BY r.started_at_us DESC, m.step_index DESC LIMIT 1",
            conditions.sql()
        );
        self.first("reading limits", &sql, conditions.values(), |row| {
            Ok(from_row!(row => TrendLimits: unit, low, high))
        })
    }

    /// The steps that made the measurement in the latest runs, with their limits.
    ///
    /// # Errors
    /// As [`trend`](Self::trend).
    pub fn trend_steps(&self, query: &TrendQuery) -> Result<Vec<TrendStep>, StoreError> {
        const LATEST_VALUES: u32 = 500;
        let conditions = self.measured(query)?;
        let sql = format!(
            "SELECT DISTINCT s.procedure, s.name, latest.low, latest.high
             FROM (SELECT m.run, m.step_index, m.low, m.high FROM run r CROSS JOIN measurement m {}
                ORDER BY r.started_at_us DESC, m.step_index DESC LIMIT {LATEST_VALUES}) AS latest
             JOIN step s ON s.run = latest.run AND s.step_index = latest.step_index ORDER BY 1, 2",
            conditions.sql()
        );
        self.select("listing steps", &sql, conditions.values(), |row| {
            Ok(from_row!(row => TrendStep: procedure, step, low, high))
        })
    }

    /// The names of all measurements.
    ///
    /// # Errors
    /// The file or server cannot be read.
    pub fn measurement_names(&self) -> Result<Vec<String>, StoreError> {
        let sql = each_value("name", "measurement", "true");
        self.select("listing measurements", &sql, &[], |row| row.get(0))
    }

    /// The procedures that made the measurement.
    ///
    /// # Errors
    /// The file or server cannot be read.
    pub fn measuring_procedures(&self, measurement: &str) -> Result<Vec<String>, StoreError> {
        let sql = match &self.backend {
            Backend::File(_) => {
                "SELECT DISTINCT procedure FROM measured_day WHERE name = ?1 ORDER BY 1"
            }
            Backend::Server(_) => {
                "SELECT DISTINCT s.procedure FROM measurement m JOIN step s ON s.run = m.run
                    AND s.step_index = m.step_index
                 WHERE m.name = ?1 AND m.value IS NOT NULL ORDER BY 1"
            }
        };
        self.select("listing procedures", sql, &values![measurement], |row| {
            row.get(0)
        })
    }

    /// Time of the last repair of a part of this unit, µs since 1970.
    ///
    /// # Errors
    /// There is no such unit, or the file or server cannot be read.
    pub fn last_repair(&self, unit: &str, part: &str) -> Result<Option<i64>, StoreError> {
        let unit = self.unit_seq(unit)?;
        let found = self.first(
            "looking for a repair",
            "SELECT max(at_us) FROM repair WHERE part = ?1 AND unit = ?2",
            &values![part_name(part), unit],
            |row| row.get::<Option<i64>>(0),
        )?;
        Ok(found.flatten())
    }

    /// The conditions of a query on a measurement `m` in a run `r`.
    fn measured(&self, query: &TrendQuery) -> Result<Conditions, StoreError> {
        let unit = query.unit.as_deref().map(|serial| self.unit_seq(serial));
        let mut conditions = Conditions::default();
        // Runs first, by unit or time, then their values: SQLite follows the order of CROSS JOIN.
        conditions.require("m.run = r.seq");
        conditions.add("m.name = ?", Some(query.measurement.clone()));
        conditions.add("r.unit = ?", unit.transpose()?);
        conditions.add("r.line = ?", query.line.clone());
        conditions.add("r.train = ? AND r.train <> ''", query.train.clone());
        conditions.add(
            "EXISTS (SELECT 1 FROM step s WHERE s.run = m.run AND s.step_index = m.step_index
                AND s.procedure = ?)",
            query.procedure.clone(),
        );
        conditions.add(
            "EXISTS (SELECT 1 FROM step s WHERE s.run = m.run AND s.step_index = m.step_index
                AND s.name = ?)",
            query.step.clone(),
        );
        conditions.add("r.started_at_us >= ?", query.since_us);
        conditions.add("r.started_at_us < ?", query.until_us);
        if !self.has_measurement(&query.measurement)? {
            return Err(StoreError::NotFound {
                what: "measurement",
                asked: query.measurement.clone(),
            });
        }
        Ok(conditions)
    }

    fn has_measurement(&self, name: &str) -> Result<bool, StoreError> {
        let known = "SELECT 1 FROM measurement WHERE name = ?1 LIMIT 1";
        self.has("looking for a measurement", known, &values![name])
    }
}

fn trend_day(row: crate::backend::Row<'_>) -> crate::backend::SqlResult<TrendDay> {
    let n: u32 = row.get(1)?;
    Ok(from_row!(row => TrendDay:
        _, _, _, sum_of_squares, least, most, not_passed;
        day_us: row.get::<i64>(0)? * DAY_US,
        n,
        mean: row.get::<f64>(2)? / f64::from(n)
    ))
}
