//! Counts from a file's table `tally`: whole months and days, with the incomplete days at both ends counted
//! row by row.

use super::super::fault_filter::{FaultFilter, Resolved};
use super::StatKey;
use super::counts::{Bins, Counts, CountsByKey, Key, Tally, Units};
use super::repairs::KEPT_DAYS;
use crate::backend::{Backend, Row, SqlResult, Value, values};
use crate::sql_functions::{DAY_US, month_start_us, utc_day, utc_month};
use crate::units;

/// Granularities in the table `tally`.
const MONTHS: i64 = 0;
const DAYS: i64 = 1;

/// The part of `tally` that answers a query.
pub(super) struct TallyPart {
    dim: i64,
    column: &'static str,
    /// Restricts it to one key.
    only: Option<Value<'static>>,
    /// Whether all keys are added up.
    together: bool,
}

impl TallyPart {
    /// Whether the key is the unit.
    fn tells_units_apart(&self) -> bool {
        self.column == "unit" && !self.together
    }
}

/// The part of `tally` that answers this query, if there is one.
pub(super) fn part_for(resolved: &Resolved<'_>, by: StatKey) -> Option<TallyPart> {
    let asked = resolved.identity_filters_only()?;
    let (dim, column) = match by {
        StatKey::All => (0, "''"),
        StatKey::Code => (1, "code"),
        StatKey::Lru => (2, "lru"),
        StatKey::Cause => return None,
        StatKey::Unit => (3, "unit"),
        StatKey::Line => (4, "line"),
    };
    let kept = |dim, column, only| TallyPart {
        dim,
        column,
        only,
        together: by == StatKey::All,
    };
    if asked == 0 {
        return Some(kept(dim, column, None));
    }
    // With one condition, the counts under that key answer, if no other key is to be told apart.
    let (own, own_column, only): (_, _, Value<'static>) = match resolved {
        _ if asked > 1 => return None,
        one if one.unit().is_some() => (3, "unit", one.unit()?.into()),
        one if one.codes().is_some() => match one.codes()? {
            [code] => (1, "code", (*code).into()),
            _ => return None,
        },
        one if one.lrus().is_some() => match one.lrus()? {
            [lru] => (2, "lru", lru.clone().into()),
            _ => return None,
        },
        one => (4, "line", one.filter().line.clone()?.into()),
    };
    (dim == 0 || dim == own).then(|| kept(own, own_column, Some(only)))
}

/// Counts in the filter's span of time.
pub(super) fn count(
    backend: &Backend,
    kept: &TallyPart,
    filter: &FaultFilter,
    bins: &Bins,
) -> SqlResult<CountsByKey> {
    let mut counting = Counting {
        backend,
        kept,
        bins,
        counted: CountsByKey::new(),
    };
    let (since, until) = (filter.since_us, filter.until_us);
    // A span without an end has no incomplete day there.
    let days = (
        since.map_or(i64::MIN / 2, |us| {
            us.div_euclid(DAY_US) + i64::from(us.rem_euclid(DAY_US) > 0)
        }),
        until.map_or(i64::MAX / 2, utc_day),
    );
    if days.0 >= days.1 {
        counting.rows(since.unwrap_or(i64::MIN), until.unwrap_or(i64::MAX))?;
    } else {
        if let Some(since) = since {
            counting.rows(since, days.0 * DAY_US)?;
        }
        if let Some(until) = until {
            counting.rows(days.1 * DAY_US, until)?;
        }
        counting.whole(since.map(|_| days.0), until.map(|_| days.1))?;
    }
    counting.last(since, until)?;
    if kept.tells_units_apart() {
        for (key, counts) in &mut counting.counted {
            counts.units = match key {
                Key::Number(unit) if counts.occurrences > 0 => Units::Set(units::with(&[], *unit)),
                _ => Units::default(),
            };
        }
    }
    Ok(counting.counted)
}

struct Counting<'a> {
    backend: &'a Backend,
    kept: &'a TallyPart,
    bins: &'a Bins,
    counted: CountsByKey,
}

impl Counting<'_> {
    /// Whole months, and the days before and after them.
    fn whole(&mut self, since: Option<i64>, until: Option<i64>) -> SqlResult<()> {
        let (low, high) = (since.unwrap_or(i64::MIN), until.unwrap_or(i64::MAX));
        if self.bins.by_day {
            return self.kept(DAYS, low, high);
        }
        let from = since.map_or(i64::MIN, |day| utc_month(day * DAY_US - 1) + 1);
        let to = until.map_or(i64::MAX, |day| utc_month(day * DAY_US));
        if from >= to {
            return self.kept(DAYS, low, high);
        }
        let first_of = |month| utc_day(month_start_us(month));
        self.kept(MONTHS, from, to)?;
        if since.is_some() {
            self.part(from - 1, low, first_of(from))?;
        }
        if until.is_some() {
            self.part(to, first_of(to), high)?;
        }
        Ok(())
    }

    /// Days of one month: either added one by one, or the month without the others, whichever reads fewer
    /// rows. Sets of units cannot be reduced, so the second needs the unit as the key.
    fn part(&mut self, month: i64, from: i64, to: i64) -> SqlResult<()> {
        let (first, last) = (
            utc_day(month_start_us(month)),
            utc_day(month_start_us(month + 1)),
        );
        if !self.kept.tells_units_apart() || 2 * (to - from) <= last - first {
            return self.kept(DAYS, from, to);
        }
        self.kept(MONTHS, month, month + 1)?;
        self.left_out(first, from)?;
        self.left_out(to, last)
    }

    fn kept(&mut self, grain: i64, from: i64, to: i64) -> SqlResult<()> {
        self.read(grain, from, to, Counts::add)
    }

    /// Subtracts days of a month that are outside the span.
    fn left_out(&mut self, from: i64, to: i64) -> SqlResult<()> {
        self.read(DAYS, from, to, Counts::subtract)
    }

    fn read(
        &mut self,
        grain: i64,
        from: i64,
        to: i64,
        count: fn(&mut Counts, &Tally<'_>),
    ) -> SqlResult<()> {
        let only = match &self.kept.only {
            Some(_) => "AND key = ?5",
            None => "",
        };
        let sql = format!(
            "SELECT key, at, seen, opened, closed, bare, units, repairs, repair_us, back FROM tally
             WHERE dim = ?1 AND grain = ?2 AND at >= ?3 AND at < ?4 {only}"
        );
        let mut values = values![self.kept.dim, grain, from, to].to_vec();
        values.extend(self.kept.only.clone());
        let bins = self.bins;
        let place = |at: i64| match (grain == DAYS, bins.by_day) {
            (true, false) => bins.place_at(at * DAY_US),
            _ => bins.place(at),
        };
        let (kept, counted) = (self.kept, &mut self.counted);
        self.backend.each(&sql, &values, |row| {
            let counts = counted.entry(kept.key(row)?).or_default();
            count(
                counts,
                &Tally {
                    bins,
                    bin: place(row.get(1)?),
                    occurrences: row.get(2)?,
                    opened: row.get(3)?,
                    closed: row.get(4)?,
                    closed_without_repair: row.get(5)?,
                    units: row.get(6)?,
                    repairs: row.get(7)?,
                    repair_us: row.get(8)?,
                    back: row.get(9)?,
                },
            );
            Ok(())
        })
    }

    /// Counts an incomplete day row by row.
    fn rows(&mut self, from_us: i64, to_us: i64) -> SqlResult<()> {
        if from_us >= to_us {
            return Ok(());
        }
        let TallyPart { column, only, .. } = self.kept;
        let mut values = values![from_us, to_us].to_vec();
        values.extend(only.clone());
        let only = match only {
            Some(_) => format!("AND {column} = ?3"),
            None => String::new(),
        };
        let (kept, bins, counted) = (self.kept, self.bins, &mut self.counted);
        let sql = format!(
            "SELECT {column}, at_us, unit FROM fault_occurrence
             WHERE at_us >= ?1 AND at_us < ?2 {only}"
        );
        self.backend.each(&sql, &values, |row| {
            let counts = counted.entry(kept.key(row)?).or_default();
            counts.add_occurrences(bins, bins.place_at(row.get(1)?), 1);
            counts.units.add_one(row.get(2)?);
            Ok(())
        })?;
        let sql = format!(
            "SELECT {column}, count(*) FROM fault
             WHERE first_at_us >= ?1 AND first_at_us < ?2 {only} GROUP BY 1"
        );
        self.backend.each(&sql, &values, |row| {
            counted.entry(kept.key(row)?).or_default().opened += row.get::<u32>(1)?;
            Ok(())
        })?;
        let sql = format!(
            "SELECT {column}, count(*), sum(CASE WHEN repairs = 0 THEN 1 ELSE 0 END) FROM fault
             WHERE closed_at_us >= ?1 AND closed_at_us < ?2 {only} GROUP BY 1"
        );
        self.backend.each(&sql, &values, |row| {
            let counts = counted.entry(kept.key(row)?).or_default();
            counts.closed += row.get::<u32>(1)?;
            counts.closed_without_repair += row.get::<u32>(2)?;
            Ok(())
        })?;
        let within_us = i64::from(KEPT_DAYS) * DAY_US;
        let sql = format!(
            "SELECT {column}, count(*), sum(at_us - opened_at_us),
                sum(CASE WHEN back_at_us - at_us < {within_us} THEN 1 ELSE 0 END) FROM repair
             WHERE at_us >= ?1 AND at_us < ?2 {only} GROUP BY 1"
        );
        self.backend.each(&sql, &values, |row| {
            let repairs = &mut counted.entry(kept.key(row)?).or_default().repairs;
            repairs.all += row.get::<u32>(1)?;
            repairs.us += row.get::<i64>(2)?;
            repairs.back += row.get::<u32>(3)?;
            Ok(())
        })
    }

    /// The last occurrence of each key, by index.
    fn last(&mut self, since: Option<i64>, until: Option<i64>) -> SqlResult<()> {
        let span = [since.unwrap_or(i64::MIN), until.unwrap_or(i64::MAX)];
        for (key, counts) in &mut self.counted {
            let mut values = values![span[0], span[1]].to_vec();
            let meant = match (&self.kept.only, key) {
                (Some(only), _) => Some(only.clone()),
                (None, _) if self.kept.dim == 0 => None,
                (None, Key::Number(number)) => Some((*number).into()),
                (None, Key::Text(text)) => Some(Value::from(text.clone())),
            };
            let only = match &meant {
                Some(_) => format!("AND {} = ?3", self.kept.column),
                None => String::new(),
            };
            values.extend(meant);
            let sql = format!(
                "SELECT max(at_us) FROM fault_occurrence WHERE at_us >= ?1 AND at_us < ?2 {only}"
            );
            let last = self
                .backend
                .first(&sql, &values, |row| row.get::<Option<i64>>(0))?;
            counts.last_at_us = last.flatten();
        }
        Ok(())
    }
}

impl TallyPart {
    fn key(&self, row: Row<'_>) -> SqlResult<Key> {
        Ok(match self.together {
            true => Key::Text(String::new()),
            false => Key::from_field(row.field(0)?),
        })
    }
}
