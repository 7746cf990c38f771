//! Repairs: how long they took, and whether the fault came back.

use super::super::fault_filter::{FilteredTable, Resolved};
use super::counts::{CountsByKey, Key};
use super::{HOUR_US, StatQuery};
use crate::backend::{Backend, SqlResult};
use crate::sql_functions::DAY_US;

/// The days within which triggers count a fault as back.
pub(super) const KEPT_DAYS: u32 = 30;

/// Counts of repairs of one key.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Repairs {
    pub all: u32,
    pub back: u32,
    /// Have held so far, but are too recent to be judged.
    pub young: u32,
    /// Sum of the times from a fault's opening to its repair, µs.
    pub us: i64,
}

impl Repairs {
    /// Mean time from a fault's opening to its repair, hours.
    pub fn mean_hours(&self) -> Option<f64> {
        (self.all > 0).then(|| self.us as f64 / f64::from(self.all) / HOUR_US)
    }
}

/// Adds the repairs in the span, row by row.
pub(super) fn add(
    backend: &Backend,
    resolved: &Resolved<'_>,
    query: &StatQuery,
    counted: &mut CountsByKey,
) -> SqlResult<()> {
    let mut conditions = resolved.conditions_at(backend, FilteredTable::Repairs, "at_us");
    let within = conditions.place(within_us(query));
    let sql = format!(
        "SELECT {}, count(*), CAST(sum(x.at_us - x.opened_at_us) AS BIGINT),
            sum(CASE WHEN x.back_at_us - x.at_us < {within} THEN 1 ELSE 0 END)
         FROM repair x {} GROUP BY 1",
        query.by.column(),
        conditions.sql()
    );
    backend.each(&sql, conditions.values(), |row| {
        let counts = counted.entry(Key::from_field(row.field(0)?)).or_default();
        counts.repairs = Repairs {
            all: row.get(1)?,
            us: row.get(2)?,
            back: row.get(3)?,
            young: 0,
        };
        Ok(())
    })
}

/// Adds the repairs that are too recent to be judged.
pub(super) fn add_young(
    backend: &Backend,
    resolved: &Resolved<'_>,
    query: &StatQuery,
    counted: &mut CountsByKey,
) -> SqlResult<()> {
    let young_us = query.now_us - within_us(query) + 1;
    if query
        .filter
        .until_us
        .is_some_and(|until_us| until_us <= young_us)
    {
        return Ok(());
    }
    let mut conditions =
        resolved.conditions_from(backend, FilteredTable::Repairs, "at_us", Some(young_us));
    let within = conditions.place(within_us(query));
    conditions.require(format!(
        "(x.back_at_us IS NULL OR x.back_at_us - x.at_us >= {within})"
    ));
    let sql = format!(
        "SELECT {}, count(*) FROM repair x {} GROUP BY 1",
        query.by.column(),
        conditions.sql()
    );
    backend.each(&sql, conditions.values(), |row| {
        let counts = counted.entry(Key::from_field(row.field(0)?)).or_default();
        counts.repairs.young = row.get(1)?;
        Ok(())
    })
}

pub(super) fn within_us(query: &StatQuery) -> i64 {
    i64::from(query.back_within_days) * DAY_US
}
