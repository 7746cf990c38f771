//! Counting row by row: any filter, any base.

use super::super::fault_filter::{Of, Resolved};
use super::StatKey;
use super::counted::{Bins, Counted, Key, Units};
use crate::base::{Base, SqlResult};

/// Counts what the filter leaves.
pub(super) fn count(
    base: &Base,
    resolved: &Resolved<'_>,
    by: StatKey,
    bins: &Bins,
) -> SqlResult<Counted> {
    let mut counted = match base {
        Base::File(_) => seen_in_file(base, resolved, by, bins)?,
        Base::Server(_) => seen_on_server(base, resolved, by, bins)?,
    };
    let column = by.column();
    let opened = resolved.conditions_at(base, Of::Faults, "first_at_us");
    let sql = format!(
        "SELECT {column}, count(*) FROM fault x {} GROUP BY 1",
        opened.sql()
    );
    base.each(&sql, opened.values(), |row| {
        counted
            .entry(Key::from_field(row.field(0)?))
            .or_default()
            .opened = row.get(1)?;
        Ok(())
    })?;
    let mut closed = resolved.conditions_at(base, Of::Faults, "closed_at_us");
    closed.require("x.closed_at_us IS NOT NULL");
    let sql = format!(
        "SELECT {column}, count(*), sum(CASE WHEN x.repairs = 0 THEN 1 ELSE 0 END)
         FROM fault x {} GROUP BY 1",
        closed.sql()
    );
    base.each(&sql, closed.values(), |row| {
        let counts = counted.entry(Key::from_field(row.field(0)?)).or_default();
        (counts.closed, counts.bare) = (row.get(1)?, row.get(2)?);
        Ok(())
    })?;
    Ok(counted)
}

/// A file hands out its rows faster than it groups them.
fn seen_in_file(
    base: &Base,
    resolved: &Resolved<'_>,
    by: StatKey,
    bins: &Bins,
) -> SqlResult<Counted> {
    let mut counted = Counted::new();
    let seen = resolved.conditions_at(base, Of::Occurrences, "at_us");
    let sql = format!(
        "SELECT {}, x.at_us, x.unit FROM fault_occurrence x {}",
        by.column(),
        seen.sql()
    );
    base.each(&sql, seen.values(), |row| {
        let counts = counted.entry(Key::from_field(row.field(0)?)).or_default();
        let at_us = row.get(1)?;
        counts.see(bins, bins.place_at(at_us), 1);
        counts.seen_at(at_us);
        counts.units.add_one(row.get(2)?);
        Ok(())
    })?;
    Ok(counted)
}

/// A server groups its rows faster than it hands them out.
fn seen_on_server(
    base: &Base,
    resolved: &Resolved<'_>,
    by: StatKey,
    bins: &Bins,
) -> SqlResult<Counted> {
    let mut counted = Counted::new();
    let column = by.column();
    let bin = match bins.by_day {
        true => "utc_day(x.at_us)",
        false => "utc_month(x.at_us)",
    };
    let seen = resolved.conditions_at(base, Of::Occurrences, "at_us");
    let sql = format!(
        "SELECT {column}, {bin}, count(*), max(x.at_us) FROM fault_occurrence x {} GROUP BY 1, 2",
        seen.sql()
    );
    base.each(&sql, seen.values(), |row| {
        let counts = counted.entry(Key::from_field(row.field(0)?)).or_default();
        counts.see(bins, bins.place(row.get(1)?), row.get(2)?);
        counts.seen_at(row.get(3)?);
        Ok(())
    })?;
    let sql = format!(
        "SELECT {column}, count(DISTINCT x.unit) FROM fault_occurrence x {} GROUP BY 1",
        seen.sql()
    );
    base.each(&sql, seen.values(), |row| {
        let counts = counted.entry(Key::from_field(row.field(0)?)).or_default();
        counts.units = Units::Number(row.get(1)?);
        Ok(())
    })?;
    Ok(counted)
}
