//! Counts row by row, for any filter and either backend.

use super::super::fault_filter::{FilteredTable, Resolved};
use super::StatKey;
use super::counts::{Bins, CountsByKey, Key, Units};
use crate::backend::{Backend, SqlResult};

/// Counts the rows that match the filter.
pub(super) fn count(
    backend: &Backend,
    resolved: &Resolved<'_>,
    by: StatKey,
    bins: &Bins,
) -> SqlResult<CountsByKey> {
    let mut counted = seen(backend, resolved, by, bins)?;
    let column = by.column();
    let opened = resolved.conditions_at(backend, FilteredTable::Faults, "first_at_us");
    let sql = format!(
        "SELECT {column}, count(*) FROM fault x {} GROUP BY 1",
        opened.sql()
    );
    backend.each(&sql, opened.values(), |row| {
        counted
            .entry(Key::from_field(row.field(0)?))
            .or_default()
            .opened = row.get(1)?;
        Ok(())
    })?;
    let mut closed = resolved.conditions_at(backend, FilteredTable::Faults, "closed_at_us");
    closed.require("x.closed_at_us IS NOT NULL");
    let sql = format!(
        "SELECT {column}, count(*), sum(CASE WHEN x.repairs = 0 THEN 1 ELSE 0 END)
         FROM fault x {} GROUP BY 1",
        closed.sql()
    );
    backend.each(&sql, closed.values(), |row| {
        let counts = counted.entry(Key::from_field(row.field(0)?)).or_default();
        (counts.closed, counts.closed_without_repair) = (row.get(1)?, row.get(2)?);
        Ok(())
    })?;
    Ok(counted)
}

/// Counts the occurrences that match the filter.
pub(super) fn seen(
    backend: &Backend,
    resolved: &Resolved<'_>,
    by: StatKey,
    bins: &Bins,
) -> SqlResult<CountsByKey> {
    match backend {
        Backend::File(_) => seen_in_file(backend, resolved, by, bins),
        Backend::Server(_) => seen_on_server(backend, resolved, by, bins),
    }
}

/// A file returns its rows faster than it groups them.
fn seen_in_file(
    backend: &Backend,
    resolved: &Resolved<'_>,
    by: StatKey,
    bins: &Bins,
) -> SqlResult<CountsByKey> {
    let mut counted = CountsByKey::new();
    let seen = resolved.conditions_at(backend, FilteredTable::Occurrences, "at_us");
    let sql = format!(
        "SELECT {}, x.at_us, x.unit FROM fault_occurrence x {}",
        by.column(),
        seen.sql()
    );
    backend.each(&sql, seen.values(), |row| {
        let counts = counted.entry(Key::from_field(row.field(0)?)).or_default();
        let at_us = row.get(1)?;
        counts.add_occurrences(bins, bins.place_at(at_us), 1);
        counts.seen_at(at_us);
        counts.units.add_one(row.get(2)?);
        Ok(())
    })?;
    Ok(counted)
}

/// A server groups its rows faster than it returns them.
fn seen_on_server(
    backend: &Backend,
    resolved: &Resolved<'_>,
    by: StatKey,
    bins: &Bins,
) -> SqlResult<CountsByKey> {
    let mut counted = CountsByKey::new();
    let column = by.column();
    let bin = match bins.by_day {
        true => "utc_day(x.at_us)",
        false => "utc_month(x.at_us)",
    };
    let seen = resolved.conditions_at(backend, FilteredTable::Occurrences, "at_us");
    let sql = format!(
        "SELECT {column}, {bin}, count(*), max(x.at_us) FROM fault_occurrence x {} GROUP BY 1, 2",
        seen.sql()
    );
    backend.each(&sql, seen.values(), |row| {
        let counts = counted.entry(Key::from_field(row.field(0)?)).or_default();
        counts.add_occurrences(bins, bins.place(row.get(1)?), row.get(2)?);
        counts.seen_at(row.get(3)?);
        Ok(())
    })?;
    let sql = format!(
        "SELECT {column}, count(DISTINCT x.unit) FROM fault_occurrence x {} GROUP BY 1",
        seen.sql()
    );
    backend.each(&sql, seen.values(), |row| {
        let counts = counted.entry(Key::from_field(row.field(0)?)).or_default();
        counts.units = Units::Number(row.get(1)?);
        Ok(())
    })?;
    Ok(counted)
}

/// Adds the faults that are not closed.
pub(super) fn add_not_closed(
    backend: &Backend,
    resolved: &Resolved<'_>,
    by: StatKey,
    counted: &mut CountsByKey,
) -> SqlResult<()> {
    let mut conditions = resolved.conditions_at(backend, FilteredTable::Faults, "last_at_us");
    conditions.require("x.state <> 'closed'");
    // An operation on the column keeps SQLite from reading all faults in its order: few are not closed.
    let group = match backend {
        Backend::File(_) => format!("+{}", by.column()),
        Backend::Server(_) => "1".to_owned(),
    };
    let sql = format!(
        "SELECT {}, count(*) FROM fault x {} GROUP BY {group}",
        by.column(),
        conditions.sql()
    );
    backend.each(&sql, conditions.values(), |row| {
        let key = Key::from_field(row.field(0)?);
        counted.entry(key).or_default().not_closed = row.get(1)?;
        Ok(())
    })
}
