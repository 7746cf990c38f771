//! The counts of one key, however they are obtained.

use std::collections::BTreeMap;

use crate::backend::Field;
use crate::sql_functions::{DAY_US, month_start_us, utc_day, utc_month};
use crate::units;

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
    pub repairs: super::repairs::Repairs,
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

    /// Adds the counts of a day or month.
    pub fn add(&mut self, tally: &Tally<'_>) {
        self.add_occurrences(tally.bins, tally.bin, tally.occurrences);
        self.opened += tally.opened;
        self.closed += tally.closed;
        self.closed_without_repair += tally.closed_without_repair;
        self.units.add(tally.units);
        self.repairs.all += tally.repairs;
        self.repairs.us += tally.repair_us;
        self.repairs.back += tally.back;
    }

    /// Subtracts the counts of a day from those of its month. The set of units cannot be reduced by this.
    pub fn subtract(&mut self, tally: &Tally<'_>) {
        let less = |count: &mut u32, by: u32| *count = count.saturating_sub(by);
        self.occurrences = self.occurrences.saturating_sub(tally.occurrences);
        if let Some(count) = self.course.get_mut(tally.bin) {
            *count = count.saturating_sub(tally.occurrences);
        }
        less(&mut self.opened, tally.opened);
        less(&mut self.closed, tally.closed);
        less(&mut self.closed_without_repair, tally.closed_without_repair);
        less(&mut self.repairs.all, tally.repairs);
        self.repairs.us -= tally.repair_us;
        less(&mut self.repairs.back, tally.back);
    }

    /// Adds the counts of another key that has none of the same faults.
    pub fn add_key(&mut self, other: &Self) {
        self.occurrences += other.occurrences;
        self.opened += other.opened;
        self.not_closed += other.not_closed;
        self.closed += other.closed;
        self.closed_without_repair += other.closed_without_repair;
        if let Units::Set(units) = &other.units {
            self.units.add(units);
        }
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

    /// Takes the numbers of cases from those of all causes; the rest stays.
    pub fn take_cases(&mut self, by_cause: &CountsByKey) {
        let mut all = Self::default();
        by_cause.values().for_each(|of_cause| all.add_key(of_cause));
        self.opened = all.opened;
        self.not_closed = all.not_closed;
        self.closed = all.closed;
        self.closed_without_repair = all.closed_without_repair;
        self.repairs = all.repairs;
    }

    /// Records an occurrence at this time, for the latest one.
    pub fn seen_at(&mut self, at_us: i64) {
        self.last_at_us = self.last_at_us.max(Some(at_us));
    }
}

/// The stored counts of a key on a day or in a month.
pub(crate) struct Tally<'a> {
    pub bins: &'a Bins,
    pub bin: usize,
    pub occurrences: u64,
    pub opened: u32,
    pub closed: u32,
    pub closed_without_repair: u32,
    pub units: &'a [u8],
    pub repairs: u32,
    pub repair_us: i64,
    pub back: u32,
}

/// The set of units, or only their number.
#[derive(Clone, Debug)]
pub(crate) enum Units {
    Set(Vec<u8>),
    Number(u32),
}

impl Default for Units {
    fn default() -> Self {
        Self::Number(0)
    }
}

impl Units {
    pub fn count(&self) -> u32 {
        match self {
            Self::Set(set) => units::count(set),
            Self::Number(number) => *number,
        }
    }

    /// Adds the units of a set.
    pub fn add(&mut self, more: &[u8]) {
        match self {
            Self::Set(set) => units::add(set, more),
            Self::Number(_) => *self = Self::Set(more.to_vec()),
        }
    }

    pub fn add_one(&mut self, unit: i64) {
        match self {
            Self::Set(set) => units::insert(set, unit),
            Self::Number(_) => *self = Self::Set(units::with(&[], unit)),
        }
    }
}

/// A span divided into days or months (UTC); days if there are few.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bins {
    pub by_day: bool,
    first: i64,
    last: i64,
}

/// Most days of a table of bins: a hundred years.
const MOST_DAYS_OF_TABLE: i64 = 36_600;

/// Longest span shown by day, days.
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
