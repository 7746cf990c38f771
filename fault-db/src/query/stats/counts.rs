//! The counts of one key, however they are obtained.

use std::collections::BTreeMap;

use crate::backend::Field;
use crate::schema::sql_functions::{DAY_US, month_start_us, utc_day, utc_month};

/// Microseconds of an hour.
const HOUR_US: f64 = 3.6e9;

/// The key by which faults are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StatKey {
    /// The fault's number.
    Code,
    /// The part that the fault points at.
    Lru,
    /// The part that the fault comes from; the faults of a unit that one part explains are counted once, as a case.
    Cause,
    /// The unit that had it.
    Unit,
    /// The line its unit was on.
    Line,
    /// No key: all faults in one count.
    All,
}

/// The key of a count: a code or unit by its number, a part or line by its name; empty for all faults.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Key {
    Number(i64),
    Text(String),
}

impl Key {
    pub fn from_field(field: Field<'_>) -> Self {
        match field {
            Field::Integer(number) => Self::Number(number),
            Field::Text(text) => Self::Text(text.to_owned()),
            Field::Null | Field::Real(_) | Field::Bytes(_) => Self::Text(String::new()),
        }
    }
}

pub(crate) type CountsByKey = BTreeMap<Key, Counts>;

#[derive(Clone, Debug, Default)]
pub(crate) struct Counts {
    pub occurrences: u64,
    pub opened: u32,
    pub not_closed: u32,
    pub closed: u32,
    pub closed_without_repair: u32,
    pub units: Units,
    pub last_at_us: Option<i64>,
    pub course: Vec<u64>,
    pub repairs: Repairs,
}

impl Counts {
    pub fn is_nothing(&self) -> bool {
        self.occurrences == 0 && self.opened == 0 && self.closed == 0 && self.repairs.all == 0
    }

    pub fn add_occurrences(&mut self, bins: &Bins, bin: usize, times: u64) {
        self.occurrences += times;
        self.course.resize(bins.len(), 0);
        if let Some(count) = self.course.get_mut(bin) {
            *count += times;
        }
    }

    /// Adds the counts of another key; the two must share no fault.
    pub fn add_key(&mut self, other: &Self) {
        self.occurrences += other.occurrences;
        self.opened += other.opened;
        self.not_closed += other.not_closed;
        self.closed += other.closed;
        self.closed_without_repair += other.closed_without_repair;
        self.units.add(&other.units);
        self.last_at_us = self.last_at_us.max(other.last_at_us);
        let bins = self.course.len().max(other.course.len());
        self.course.resize(bins, 0);
        for (sum, more) in self.course.iter_mut().zip(&other.course) {
            *sum += more;
        }
        self.repairs.all += other.repairs.all;
        self.repairs.back += other.repairs.back;
        self.repairs.young += other.repairs.young;
        self.repairs.us += other.repairs.us;
    }

    /// Replaces the numbers of faults by the numbers of cases of all causes; the rest stays.
    pub fn take_cases(&mut self, by_cause: &CountsByKey) {
        let mut all = Self::default();
        by_cause.values().for_each(|of_cause| all.add_key(of_cause));
        self.opened = all.opened;
        self.not_closed = all.not_closed;
        self.closed = all.closed;
        self.closed_without_repair = all.closed_without_repair;
        self.repairs = all.repairs;
    }

    /// Keeps the time of the latest occurrence.
    pub fn seen_at(&mut self, at_us: i64) {
        self.last_at_us = self.last_at_us.max(Some(at_us));
    }
}

/// Counts of repairs of one key.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Repairs {
    pub all: u32,
    pub back: u32,
    /// Repairs that have held so far, but are too recent to be judged.
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

/// The units of a key: a bit for each row number, or, from a server, only how many there are.
#[derive(Clone, Debug)]
pub(crate) enum Units {
    Set(Vec<u64>),
    Number(u32),
}

impl Default for Units {
    fn default() -> Self {
        Self::Set(Vec::new())
    }
}

impl Units {
    pub fn count(&self) -> u32 {
        match self {
            Self::Set(set) => set.iter().map(|bits| bits.count_ones()).sum(),
            Self::Number(number) => *number,
        }
    }

    pub fn add_one(&mut self, unit: i64) {
        let (Self::Set(set), Ok(unit)) = (self, usize::try_from(unit)) else {
            return;
        };
        let (place, bit) = (unit / 64, unit % 64);
        if set.len() <= place {
            set.resize(place + 1, 0);
        }
        set[place] |= 1 << bit;
    }

    fn add(&mut self, more: &Self) {
        let (Self::Set(set), Self::Set(more)) = (self, more) else {
            return;
        };
        if set.len() < more.len() {
            set.resize(more.len(), 0);
        }
        for (bits, more) in set.iter_mut().zip(more) {
            *bits |= more;
        }
    }
}

/// A span divided into days, or into months if it is long (UTC).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bins {
    pub by_day: bool,
    first: i64,
    last: i64,
}

/// Greatest number of days in the table of bins: a hundred years.
const MOST_DAYS_OF_TABLE: i64 = 36_600;

/// Greatest span that is divided into days, days.
const MOST_DAYS: i64 = 62;

impl Bins {
    /// The span from `since_us` until just before `until_us`.
    pub fn of(since_us: i64, until_us: i64) -> Self {
        let last_us = since_us.max(until_us.saturating_sub(1));
        let by_day = (last_us - since_us) / DAY_US < MOST_DAYS;
        let number = if by_day { utc_day } else { utc_month };
        Self {
            by_day,
            first: number(since_us),
            last: number(last_us),
        }
    }

    pub fn len(&self) -> usize {
        usize::try_from(self.last - self.first + 1).unwrap_or(0)
    }

    /// The bin of a day or month, by its number.
    pub fn place(&self, number: i64) -> usize {
        usize::try_from((number - self.first).max(0)).unwrap_or(0)
    }

    /// Number of the first day in the first bin, and the bins of the days from then on.
    pub fn of_days(&self) -> (i64, Vec<usize>) {
        let (first, last) = match self.by_day {
            true => (self.first, self.last),
            false => {
                let first_of = |month| utc_day(month_start_us(month));
                (first_of(self.first), first_of(self.last + 1) - 1)
            }
        };
        let last = last.min(first + MOST_DAYS_OF_TABLE);
        let bins = (first..=last).map(|day| self.place_at(day * DAY_US));
        (first, bins.collect())
    }

    /// The bin of a time.
    pub fn place_at(&self, at_us: i64) -> usize {
        self.place(if self.by_day {
            utc_day(at_us)
        } else {
            utc_month(at_us)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_unit_is_counted_once() {
        let mut units = Units::default();
        [3, 900, 3].iter().for_each(|unit| units.add_one(*unit));
        assert_eq!(units.count(), 2);
        let mut more = Units::default();
        [4, 900].iter().for_each(|unit| more.add_one(*unit));
        units.add(&more);
        assert_eq!(units.count(), 3);
    }
}
