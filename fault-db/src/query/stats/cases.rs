//! Cases in statistics: a fault with its repairs, or several faults of a unit that one part explains.

use super::StatQuery;
use super::counts::Counts;
use crate::schema::sql_functions::DAY_US;

/// A fault, or faults of a unit that come from one part and whose times from first sight to closing overlap.
#[derive(Clone, Debug)]
pub(super) struct Case {
    /// Index of the counts of the case's key.
    pub place: usize,
    pub unit: i64,
    pub first_us: i64,
    pub last_us: i64,
    /// Time of closing, µs since 1970; `None` while a fault of the case is not closed.
    pub closed_us: Option<i64>,
    pub is_repaired: bool,
    pub repairs: Vec<CaseRepair>,
}

/// A repair of a case: one for all faults of the case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct CaseRepair {
    pub at_us: i64,
    pub opened_us: i64,
    pub back_us: Option<i64>,
}

/// Times by which repairs are judged.
#[derive(Clone, Copy)]
pub(super) struct RepairTimes {
    /// A repair did not hold if the fault is seen again within this time, µs.
    pub within_us: i64,
    /// A repair from this time on, µs since 1970, is too recent to be judged.
    pub young_us: i64,
}

impl RepairTimes {
    pub fn of(query: &StatQuery) -> Self {
        let within_us = i64::from(query.back_within_days) * DAY_US;
        Self {
            within_us,
            young_us: query.now_us - within_us + 1,
        }
    }
}

impl Case {
    /// Counts the opening, the end and the repairs of the case: calls `add` with the time and the change of the counts.
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

    /// Adds another fault of the case. A repair made for several faults of the case counts once.
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

/// Joins faults that are attributed to a part into cases.
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
