//! Cases as they are counted: a fault with its repairs, or several faults of a unit that one part explains.

use super::counts::{Bins, Counts, CountsByKey, Key};
use super::repairs::within_us;
use super::{StatKey, StatQuery, by_row};
use crate::backend::{Backend, SqlResult};
use crate::query::fault_filter::{FilteredTable, Resolved};

/// A fault, or the faults of a unit that come from one part and were not closed at the same time.
#[derive(Clone, Debug)]
pub(super) struct Case {
    /// Where its key is counted.
    pub place: usize,
    pub unit: i64,
    pub first_us: i64,
    pub last_us: i64,
    /// `None` while a fault of it is not closed.
    pub closed_us: Option<i64>,
    pub is_repaired: bool,
    pub repairs: Vec<CaseRepair>,
}

/// A repair of a case, once for all its faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct CaseRepair {
    pub at_us: i64,
    pub opened_us: i64,
    pub back_us: Option<i64>,
}

/// When a repair is judged.
#[derive(Clone, Copy)]
pub(super) struct RepairTimes {
    /// A fault seen again within this time is back.
    within_us: i64,
    /// From then on a repair is too recent.
    young_us: i64,
}

impl RepairTimes {
    pub fn of(query: &StatQuery) -> Self {
        Self {
            within_us: within_us(query),
            young_us: query.now_us - within_us(query) + 1,
        }
    }
}

impl Case {
    /// Counts its opening, its end and its repairs; `add` changes the counts at a time, if they are asked for.
    pub fn count(&self, times: RepairTimes, mut add: impl FnMut(i64, &dyn Fn(&mut Counts))) {
        add(self.first_us, &|counts| counts.opened += 1);
        match self.closed_us {
            Some(at_us) => add(at_us, &|counts| {
                counts.closed += 1;
                counts.closed_without_repair += u32::from(!self.is_repaired);
            }),
            None => add(self.last_us, &|counts| counts.not_closed += 1),
        }
        for repair in &self.repairs {
            let after_us = repair.back_us.map(|back_us| back_us - repair.at_us);
            let is_back = after_us.is_some_and(|after_us| after_us < times.within_us);
            add(repair.at_us, &|counts| {
                let repairs = &mut counts.repairs;
                repairs.all += 1;
                repairs.us += repair.at_us - repair.opened_us;
                repairs.back += u32::from(is_back);
                repairs.young += u32::from(!is_back && repair.at_us >= times.young_us);
            });
        }
    }

    /// Takes in another fault of the case. A repair made for several of its faults is one.
    fn take(&mut self, other: Self) {
        self.last_us = self.last_us.max(other.last_us);
        self.closed_us = self.closed_us.zip(other.closed_us).map(|(a, b)| a.max(b));
        self.is_repaired |= other.is_repaired;
        for repair in other.repairs {
            match self
                .repairs
                .iter_mut()
                .find(|one| one.at_us == repair.at_us)
            {
                Some(one) => {
                    one.opened_us = one.opened_us.min(repair.opened_us);
                    one.back_us = [one.back_us, repair.back_us].into_iter().flatten().min();
                }
                None => self.repairs.push(repair),
            }
        }
    }
}

/// Faults that are attributed to a part, as cases.
pub(super) fn cases_of(mut attributed: Vec<Case>) -> Vec<Case> {
    attributed.sort_by_key(|fault| (fault.place, fault.unit, fault.first_us));
    let mut cases: Vec<Case> = Vec::new();
    for fault in attributed {
        let last = cases.last_mut().filter(|case| {
            (case.place, case.unit) == (fault.place, fault.unit)
                && case
                    .closed_us
                    .is_none_or(|closed_us| fault.first_us <= closed_us)
        });
        match last {
            Some(case) => case.take(fault),
            None => cases.push(fault),
        }
    }
    cases
}

/// Counts cases by cause, row by row.
pub(super) fn count(
    backend: &Backend,
    resolved: &Resolved<'_>,
    query: &StatQuery,
    bins: &Bins,
) -> SqlResult<CountsByKey> {
    let mut counted = by_row::seen(backend, resolved, StatKey::Cause, bins)?;
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
    counted.retain(|_, counts| !counts.is_nothing() || counts.not_closed > 0);
    Ok(counted)
}

/// The faults that the filter selects, at any time, with their repairs: the part each counts for, and whether it is
/// attributed to it.
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
        let case = Case {
            place: 0,
            unit: row.get(2)?,
            first_us: row.get(3)?,
            last_us: row.get(4)?,
            closed_us: row.get(5)?,
            is_repaired: row.get::<i64>(6)? > 0,
            repairs: Vec::new(),
        };
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
            faults[place].2.repairs.push(CaseRepair {
                at_us: row.get(1)?,
                opened_us: row.get(2)?,
                back_us: row.get(3)?,
            });
        }
        Ok(())
    })?;
    Ok(faults)
}
