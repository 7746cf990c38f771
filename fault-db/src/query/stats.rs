//! Counts of faults, and a measurement over time.

use rusqlite::params;
use serde::Serialize;

use crate::error::StoreError;
use crate::id::Id;
use crate::record::Verdict;
use crate::store::Store;

/// What to count faults by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StatKey {
    /// The fault's number.
    Code,
    /// The part it points at.
    Lru,
}

/// The faults of one code, or of one part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultStat {
    /// The number as text, or the part.
    pub key: String,
    /// The fault's name; empty for a part.
    pub name: String,
    /// Faults, closed ones too.
    pub faults: u32,
    /// Faults that are not closed.
    pub not_closed: u32,
    /// Times seen.
    pub occurrences: u64,
    /// Units that had it.
    pub units: u32,
    /// Last seen.
    pub last_at_us: i64,
}

/// A measurement taken once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrendPoint {
    /// When: the run's start. Within a run, points come in the order of its steps.
    pub at_us: i64,
    /// The run.
    pub run_id: Id,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// The value; none if nothing could be measured.
    pub value: Option<f64>,
    /// Unit of value and limits.
    pub unit: String,
    /// Lowest allowed value.
    pub low: Option<f64>,
    /// Highest allowed value.
    pub high: Option<f64>,
    /// How it came out.
    pub verdict: Verdict,
}

impl Store {
    /// Counts faults by code or by part, the most frequent first.
    pub fn stats(&self, key: StatKey) -> Result<Vec<FaultStat>, StoreError> {
        let (key, name) = match key {
            StatKey::Code => ("CAST(code AS TEXT)", "max(code_name)"),
            StatKey::Lru => ("lru", "''"),
        };
        let sql = format!(
            "SELECT {key}, {name}, count(*), sum(state <> 'closed'), sum(occurrences),
                count(DISTINCT unit), max(last_at_us)
             FROM fault GROUP BY {key} ORDER BY sum(occurrences) DESC, {key}"
        );
        let list = || -> rusqlite::Result<Vec<_>> {
            self.conn
                .prepare_cached(&sql)?
                .query_map([], |row| {
                    Ok(FaultStat {
                        key: row.get(0)?,
                        name: row.get(1)?,
                        faults: row.get(2)?,
                        not_closed: row.get(3)?,
                        occurrences: row.get(4)?,
                        units: row.get(5)?,
                        last_at_us: row.get(6)?,
                    })
                })?
                .collect()
        };
        list().map_err(|error| self.failed("counting faults", error))
    }

    /// A measurement over time, oldest first, of one unit or of all.
    pub fn trend(
        &self,
        measurement: &str,
        unit: Option<&str>,
    ) -> Result<Vec<TrendPoint>, StoreError> {
        let list = || -> rusqlite::Result<Vec<_>> {
            self.conn
                .prepare_cached(
                    "SELECT r.started_at_us, r.id, u.serial, m.value, m.unit,
                        m.low, m.high, m.verdict
                     FROM measurement m JOIN run r ON r.seq = m.run JOIN unit u ON u.seq = r.unit
                     WHERE m.name = ?1 AND (?2 IS NULL OR u.serial = ?2)
                     ORDER BY 1, m.run, m.step_index, m.ordinal",
                )?
                .query_map(params![measurement, unit], |row| {
                    Ok(TrendPoint {
                        at_us: row.get(0)?,
                        run_id: row.get(1)?,
                        unit_serial: row.get(2)?,
                        value: row.get(3)?,
                        unit: row.get(4)?,
                        low: row.get(5)?,
                        high: row.get(6)?,
                        verdict: row.get(7)?,
                    })
                })?
                .collect()
        };
        let points: Vec<TrendPoint> =
            list().map_err(|error| self.failed("reading a measurement", error))?;
        if points.is_empty() && !self.has_measurement(measurement)? {
            let asked = measurement.to_owned();
            return Err(StoreError::NotFound {
                what: "measurement",
                asked,
            });
        }
        Ok(points)
    }

    /// The names of all measurements ever taken.
    pub fn measurement_names(&self) -> Result<Vec<String>, StoreError> {
        let list = || -> rusqlite::Result<Vec<_>> {
            self.conn
                .prepare_cached("SELECT DISTINCT name FROM measurement ORDER BY name")?
                .query_map([], |row| row.get(0))?
                .collect()
        };
        list().map_err(|error| self.failed("listing measurements", error))
    }

    fn has_measurement(&self, name: &str) -> Result<bool, StoreError> {
        self.conn
            .prepare_cached("SELECT EXISTS(SELECT 1 FROM measurement WHERE name = ?1)")
            .and_then(|mut select| select.query_row([name], |row| row.get(0)))
            .map_err(|error| self.failed("looking for a measurement", error))
    }
}
