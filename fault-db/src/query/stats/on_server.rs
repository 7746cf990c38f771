//! Counts on a server, in SQL: it groups its rows faster than it returns them.

use super::super::fault_filter::{FilteredTable, Resolved};
use super::super::filter::Conditions;
use super::cases::{Case, CaseRepair, RepairTimes, cases_of};
use super::counts::{Bins, Counts, CountsByKey, Key, Repairs, Units};
use super::{StatKey, StatQuery};
use crate::backend::{Backend, Row, SqlResult, from_row};

/// Counts what the filter selects, in the filter's span of time.
pub(super) fn count(
    backend: &Backend,
    resolved: &Resolved<'_>,
    query: &StatQuery,
    bins: &Bins,
) -> SqlResult<CountsByKey> {
    let mut counted = occurrences(backend, resolved, query.by, bins)?;
    if query.by == StatKey::Cause {
        add_cases(backend, resolved, query, &mut counted)?;
    } else {
        add_faults(backend, resolved, query.by, &mut counted)?;
        add_repairs(backend, resolved, query, &mut counted)?;
    }
    counted.retain(|_, counts| !counts.is_nothing() || counts.not_closed > 0);
    Ok(counted)
}

impl StatKey {
    /// SQL: the key in rows `x` of faults, occurrences or repairs.
    fn column(self) -> &'static str {
        match self {
            Self::Code => "x.code",
            Self::Lru => "x.lru",
            // The cause of an occurrence; faults themselves are never grouped by cause here.
            Self::Cause => "(SELECT coalesce(f.cause, f.lru) FROM fault f WHERE f.seq = x.fault)",
            Self::Unit => "x.unit",
            Self::Line => "x.line",
            Self::All => "''",
        }
    }
}

fn occurrences(
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
    let units = "count(DISTINCT x.unit)";
    let of = ("fault_occurrence", &seen);
    by_key(backend, by, of, units, &mut counted, |counts, row| {
        counts.units = Units::Number(row.get(1)?);
        Ok(())
    })?;
    Ok(counted)
}

/// Reads one row for each key (column 0) and lets `add` count the other columns.
fn by_key(
    backend: &Backend,
    by: StatKey,
    (table, conditions): (&str, &Conditions),
    columns: &str,
    counted: &mut CountsByKey,
    mut add: impl FnMut(&mut Counts, Row<'_>) -> SqlResult<()>,
) -> SqlResult<()> {
    let (key, which) = (by.column(), conditions.sql());
    let sql = format!("SELECT {key}, {columns} FROM {table} x {which} GROUP BY 1");
    backend.each(&sql, conditions.values(), |row| {
        let key = Key::from_field(row.field(0)?);
        add(counted.entry(key).or_default(), row)
    })
}

/// Counts the faults first seen, the closed ones, and those last seen that are not closed.
fn add_faults(
    backend: &Backend,
    resolved: &Resolved<'_>,
    by: StatKey,
    counted: &mut CountsByKey,
) -> SqlResult<()> {
    let at = |at| resolved.conditions_at(backend, FilteredTable::Faults, at);
    let opened = ("fault", &at("first_at_us"));
    by_key(backend, by, opened, "count(*)", counted, |counts, row| {
        counts.opened = row.get(1)?;
        Ok(())
    })?;
    let mut closed = at("closed_at_us");
    closed.require("x.closed_at_us IS NOT NULL");
    let numbers = "count(*), sum(CASE WHEN x.repairs = 0 THEN 1 ELSE 0 END)";
    let closed = ("fault", &closed);
    by_key(backend, by, closed, numbers, counted, |counts, row| {
        (counts.closed, counts.closed_without_repair) = (row.get(1)?, row.get(2)?);
        Ok(())
    })?;
    let mut not_closed = at("last_at_us");
    not_closed.require("x.state <> 'closed'");
    let not_closed = ("fault", &not_closed);
    by_key(
        backend,
        by,
        not_closed,
        "count(*)",
        counted,
        |counts, row| {
            counts.not_closed = row.get(1)?;
            Ok(())
        },
    )
}

/// Counts the repairs, and those too recent to be judged.
fn add_repairs(
    backend: &Backend,
    resolved: &Resolved<'_>,
    query: &StatQuery,
    counted: &mut CountsByKey,
) -> SqlResult<()> {
    let times = RepairTimes::of(query);
    let mut conditions = resolved.conditions_at(backend, FilteredTable::Repairs, "at_us");
    let (within, young) = (
        conditions.place(times.within_us),
        conditions.place(times.young_us),
    );
    let is_back = format!("coalesce(x.back_at_us - x.at_us < {within}, false)");
    let numbers = format!(
        "count(*), CAST(sum(x.at_us - x.opened_at_us) AS BIGINT),
            sum(CASE WHEN {is_back} THEN 1 ELSE 0 END),
            sum(CASE WHEN NOT {is_back} AND x.at_us >= {young} THEN 1 ELSE 0 END)"
    );
    let of = ("repair", &conditions);
    by_key(backend, query.by, of, &numbers, counted, |counts, row| {
        counts.repairs = from_row!(row => Repairs: _, all, us, back, young);
        Ok(())
    })
}

/// Counts the cases of each cause.
fn add_cases(
    backend: &Backend,
    resolved: &Resolved<'_>,
    query: &StatQuery,
    counted: &mut CountsByKey,
) -> SqlResult<()> {
    let mut parts: Vec<Key> = Vec::new();
    let (mut alone, mut attributed) = (Vec::new(), Vec::new());
    for (part, is_attributed, mut fault) in read(backend, resolved)? {
        let known = parts.iter().position(|known| *known == part);
        fault.place = known.unwrap_or(parts.len());
        if known.is_none() {
            parts.push(part);
        }
        match is_attributed {
            true => attributed.push(fault),
            false => alone.push(fault),
        }
    }
    alone.extend(cases_of(attributed));
    let filter = resolved.filter();
    let times = RepairTimes::of(query);
    for case in alone {
        let counts = counted.entry(parts[case.place].clone()).or_default();
        case.count(times, |at_us, change| {
            let is_asked = filter.since_us.is_none_or(|since_us| at_us >= since_us)
                && filter.until_us.is_none_or(|until_us| at_us < until_us);
            if is_asked {
                change(counts);
            }
        });
    }
    Ok(())
}

/// The faults that the filter selects, at any time, with their repairs: the part that each counts for, and whether the
/// fault is attributed to that part.
fn read(backend: &Backend, resolved: &Resolved<'_>) -> SqlResult<Vec<(Key, bool, Case)>> {
    let conditions = resolved.conditions_at_any_time(backend, FilteredTable::Faults);
    let sql = format!(
        "SELECT coalesce(x.cause, x.lru), CASE WHEN x.cause IS NULL THEN 0 ELSE 1 END, x.unit, x.first_at_us,
            x.last_at_us, x.closed_at_us, x.repairs, x.seq FROM fault x {} ORDER BY x.seq",
        conditions.sql()
    );
    let mut seqs: Vec<i64> = Vec::new();
    let mut faults = backend.select(&sql, conditions.values(), |row| {
        seqs.push(row.get(7)?);
        let case = from_row!(row => Case:
            _, _, unit, first_us, last_us, closed_us;
            place: 0,
            is_repaired: row.get::<i64>(6)? > 0,
            repairs: Vec::new()
        );
        Ok((
            Key::from_field(row.field(0)?),
            row.get::<i64>(1)? == 1,
            case,
        ))
    })?;
    let conditions = resolved.conditions_at_any_time(backend, FilteredTable::Repairs);
    let sql = format!(
        "SELECT x.fault, x.at_us, x.opened_at_us, x.back_at_us FROM repair x {}",
        conditions.sql()
    );
    backend.each(&sql, conditions.values(), |row| {
        if let Ok(place) = seqs.binary_search(&row.get(0)?) {
            faults[place].2.repairs.push(from_row!(row => CaseRepair:
                _, at_us, opened_us, back_us
            ));
        }
        Ok(())
    })?;
    Ok(faults)
}
