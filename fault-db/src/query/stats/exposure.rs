//! Observation time of units, from a unit's first run, within the span asked for.

use super::super::fault_filter::Resolved;
use super::StatKey;
use super::counts::Key;
use crate::backend::values;
use crate::error::StoreError;
use crate::sql_functions::DAY_US;
use crate::store::Store;

/// Observed days of each unit.
pub(crate) struct Exposure {
    units: Vec<ObservedUnit>,
    since_us: i64,
    until_us: i64,
}

struct ObservedUnit {
    unit: i64,
    line: String,
    days: f64,
}

impl Exposure {
    /// Of the units that match the filter. A unit's line and train are those of its latest run.
    pub fn read(store: &Store, resolved: &Resolved<'_>, now_us: i64) -> Result<Self, StoreError> {
        let filter = resolved.filter();
        let until_us = filter.until_us.map_or(now_us, |until| until.min(now_us));
        let first = "SELECT min(started_at_us) FROM run";
        let first = store.first("looking for the first run", first, &[], |row| row.get(0))?;
        let first_us = first.flatten().unwrap_or(until_us);
        let sql = "SELECT u.seq,
                (SELECT min(r.started_at_us) FROM run r WHERE r.unit = u.seq),
                (SELECT r.line FROM run r WHERE r.unit = u.seq ORDER BY r.started_at_us DESC LIMIT 1),
                (SELECT r.train FROM run r WHERE r.unit = u.seq ORDER BY r.started_at_us DESC LIMIT 1)
            FROM unit u WHERE u.seq = coalesce(?1, u.seq)";
        let all = store.select("listing units", sql, &values![resolved.unit()], |row| {
            let first: Option<i64> = row.get(1)?;
            let line: Option<String> = row.get(2)?;
            let train: Option<String> = row.get(3)?;
            Ok((
                row.get::<i64>(0)?,
                first,
                line.unwrap_or_default(),
                train.unwrap_or_default(),
            ))
        })?;
        let mut units = Vec::new();
        for (unit, first, line, train) in all {
            let Some(first) = first else { continue };
            let is_meant = resolved.unit().is_none_or(|meant| meant == unit)
                && filter.line.as_ref().is_none_or(|meant| *meant == line)
                && filter.train.as_ref().is_none_or(|meant| *meant == train);
            if !is_meant {
                continue;
            }
            let since_us = filter.since_us.map_or(first, |since| since.max(first));
            let days = (until_us - since_us).max(0) as f64 / DAY_US as f64;
            units.push(ObservedUnit { unit, line, days });
        }
        let since_us = filter
            .since_us
            .map_or(first_us, |since| since.max(first_us));
        Ok(Self {
            units,
            since_us,
            until_us,
        })
    }

    /// The start of the span, or of the history.
    pub fn since_us(&self) -> i64 {
        self.since_us
    }

    pub fn until_us(&self) -> i64 {
        self.until_us
    }

    /// Observed days of all units that belong to a key.
    pub fn days(&self, by: StatKey, key: &Key) -> f64 {
        let is_meant = |observed: &&ObservedUnit| match (by, key) {
            (StatKey::Unit, Key::Number(unit)) => observed.unit == *unit,
            (StatKey::Line, Key::Text(line)) => observed.line == *line,
            _ => true,
        };
        self.units
            .iter()
            .filter(is_meant)
            .map(|observed| observed.days)
            .sum()
    }
}
