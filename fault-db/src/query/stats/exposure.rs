//! Time for which units were observed, each from its first run on, within a span.

use super::super::fault_filter::Resolved;
use super::counts::{Bins, Key, StatKey};
use crate::backend::values;
use crate::error::StoreError;
use crate::schema::sql_functions::DAY_US;
use crate::store::Store;

/// The units that match a filter, with the time of each unit's first run.
pub(crate) struct Observed {
    units: Vec<ObservedUnit>,
    /// The first run of any unit; `None` without runs.
    first_us: Option<i64>,
    now_us: i64,
}

struct ObservedUnit {
    unit: i64,
    line: String,
    first_us: i64,
}

/// Observed days of each unit in a span.
pub(crate) struct Exposure<'a> {
    observed: &'a Observed,
    since_us: Option<i64>,
    until_us: i64,
}

impl Observed {
    /// The units that match the filter. A unit's line and train are those of its latest run.
    pub fn read(store: &Store, resolved: &Resolved<'_>, now_us: i64) -> Result<Self, StoreError> {
        let filter = resolved.filter();
        let first = "SELECT min(started_at_us) FROM run";
        let first = store.first("looking for the first run", first, &[], |row| row.get(0))?;
        let sql = "SELECT u.seq,
                (SELECT min(r.started_at_us) FROM run r WHERE r.unit = u.seq),
                (SELECT r.line FROM run r WHERE r.unit = u.seq ORDER BY r.started_at_us DESC LIMIT 1),
                (SELECT r.train FROM run r WHERE r.unit = u.seq ORDER BY r.started_at_us DESC LIMIT 1)
            FROM unit u WHERE u.seq = coalesce(?1, u.seq)";
        let all = store.select("listing units", sql, &values![resolved.unit], |row| {
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
            let Some(first_us) = first else { continue };
            let is_meant = resolved.unit.is_none_or(|meant| meant == unit)
                && filter.line.as_ref().is_none_or(|meant| *meant == line)
                && filter.train.as_ref().is_none_or(|meant| *meant == train);
            if is_meant {
                units.push(ObservedUnit {
                    unit,
                    line,
                    first_us,
                });
            }
        }
        Ok(Self {
            units,
            first_us: first.flatten(),
            now_us,
        })
    }

    /// The observation within a span, up to now.
    pub fn within(&self, since_us: Option<i64>, until_us: Option<i64>) -> Exposure<'_> {
        Exposure {
            observed: self,
            since_us,
            until_us: until_us.map_or(self.now_us, |until| until.min(self.now_us)),
        }
    }
}

impl Exposure<'_> {
    /// The span divided into days or months; a span without a start begins with the first run of any unit.
    pub fn bins(&self) -> Bins {
        let first_us = self.observed.first_us.unwrap_or(self.until_us);
        let since_us = self.since_us.map_or(first_us, |since| since.max(first_us));
        Bins::of(since_us, self.until_us)
    }

    /// Observed days, added over all units of a key; over all units if the key is neither a unit nor a line.
    pub fn days(&self, by: StatKey, key: &Key) -> f64 {
        let is_meant = |observed: &&ObservedUnit| match (by, key) {
            (StatKey::Unit, Key::Number(unit)) => observed.unit == *unit,
            (StatKey::Line, Key::Text(line)) => observed.line == *line,
            _ => true,
        };
        let days = |observed: &ObservedUnit| {
            let first = observed.first_us;
            let since_us = self.since_us.map_or(first, |since| since.max(first));
            (self.until_us - since_us).max(0) as f64 / DAY_US as f64
        };
        let units = self.observed.units.iter().filter(is_meant);
        units.map(days).sum()
    }
}
