//! Fault statistics: frequency, mean time between faults, mean time to repair, and repairs that held.
//!
//! A file answers from the counts that its triggers maintain if the filter allows it, with the incomplete days
//! at both ends of the span counted row by row; other filters from the packed faults, but those on one unit,
//! train or run, which select few rows, row by row. A server always counts row by row.

mod by_row;
mod counts;
mod exposure;
mod from_packed;
mod from_tally;
mod repairs;

use serde::Serialize;

pub(crate) use counts::Bins;
use counts::{Counted, Counts, Key};
use exposure::Exposure;
use from_tally::TallyPart;

use super::fault_filter::{FaultFilter, FilteredTable, Resolved};
use crate::backend::{Backend, SqlResult, values};
use crate::error::StoreError;
use crate::store::Store;

/// Microseconds of an hour.
const HOUR_US: f64 = 3.6e9;

/// The key by which faults are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StatKey {
    /// The fault's number.
    Code,
    /// The part it points at.
    Lru,
    /// The unit that had it.
    Unit,
    /// The line its unit was on.
    Line,
    /// No key: all faults in one count.
    All,
}

/// Selects the faults to count.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatQuery {
    /// The key.
    pub by: StatKey,
    /// Which faults, and the span of time.
    pub filter: FaultFilter,
    /// The present time, µs since 1970: the end of the observation.
    pub now_us: i64,
    /// A repair did not hold if the fault is seen again within this many days.
    pub back_within_days: u32,
}

/// The faults of one code, part, unit or line in a span of time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FaultStat {
    /// Depending on the key: the number as text, the part, the serial number, the line.
    pub key: String,
    /// The fault's name; empty for all but a code.
    pub name: String,
    /// Faults first seen, closed ones too.
    pub faults: u32,
    /// Faults last seen that are not closed now.
    pub not_closed: u32,
    /// Number of occurrences.
    pub occurrences: u64,
    /// Number of units affected.
    pub units: u32,
    /// Last occurrence; `None` without any.
    pub last_at_us: Option<i64>,
    /// Faults closed.
    pub closed: u32,
    /// Of these, closed without a repair (no fault found).
    pub no_fault_found: u32,
    /// Number of repairs.
    pub repairs: u32,
    /// Repairs old enough to be judged, and younger ones that have failed already.
    pub repairs_judged: u32,
    /// Repairs that did not hold.
    pub repairs_back: u32,
    /// Mean time between faults: observed days of the units over the number of faults. `None` without a
    /// fault.
    pub mtbf_days: Option<f64>,
    /// Mean time to repair: hours from a fault's opening to its repair. `None` without a repair.
    pub mttr_hours: Option<f64>,
    /// Occurrences by day or by month (UTC), in order.
    pub course: Vec<u64>,
}

impl Store {
    /// Counts faults by code, part, unit or line, the most frequent first.
    ///
    /// # Errors
    /// Of the filter, or of the file or server.
    pub fn stats(&self, query: &StatQuery) -> Result<Vec<FaultStat>, StoreError> {
        const DOING: &str = "counting faults";
        let failed = |error| self.failed(DOING, error);
        let resolved = query.filter.resolve(self)?;
        let exposure = Exposure::read(self, &resolved, query.now_us)?;
        let bins = Bins::of(exposure.since_us(), exposure.until_us());
        let kept = match self.backend() {
            Backend::File(_) => from_tally::part_for(&resolved, query.by),
            Backend::Server(_) => None,
        };
        let packed = match &kept {
            None => from_packed::count(self.backend(), &resolved, query, &bins).map_err(failed)?,
            Some(_) => None,
        };
        let counted = match packed {
            Some(counted) => counted,
            None => self
                .count_rows(&resolved, query, &bins, kept.as_ref())
                .map_err(failed)?,
        };
        let names = Names::read(self, query.by)?;
        let mut stats: Vec<FaultStat> = counted
            .into_iter()
            .map(|(key, mut counts)| {
                counts.course.resize(bins.len(), 0);
                let days = exposure.days(query.by, &key);
                names.name(key, counts.stat(days))
            })
            .collect();
        stats.sort_by(|a, b| (b.occurrences, &a.key).cmp(&(a.occurrences, &b.key)));
        Ok(stats)
    }

    /// Counts from the tables of counts as far as they answer, else row by row.
    fn count_rows(
        &self,
        resolved: &Resolved<'_>,
        query: &StatQuery,
        bins: &Bins,
        kept: Option<&TallyPart>,
    ) -> SqlResult<Counted> {
        let backend = self.backend();
        let mut counted = match kept {
            Some(kept) => from_tally::count(backend, kept, &query.filter, bins)?,
            None => by_row::count(backend, resolved, query.by, bins)?,
        };
        counted.retain(|_, counts| !counts.is_nothing());
        self.add_not_closed(resolved, query.by, &mut counted)?;
        if kept.is_none() || query.back_within_days != repairs::KEPT_DAYS {
            repairs::add(backend, resolved, query, &mut counted)?;
        }
        repairs::add_young(backend, resolved, query, &mut counted)?;
        Ok(counted)
    }

    fn add_not_closed(
        &self,
        resolved: &Resolved<'_>,
        by: StatKey,
        counted: &mut Counted,
    ) -> SqlResult<()> {
        let mut conditions =
            resolved.conditions_at(self.backend(), FilteredTable::Faults, "last_at_us");
        conditions.require("x.state <> 'closed'");
        let sql = format!(
            "SELECT {}, count(*) FROM fault x {} GROUP BY 1",
            by.column(),
            conditions.sql()
        );
        self.backend().each(&sql, conditions.values(), |row| {
            let key = Key::from_field(row.field(0)?);
            counted.entry(key).or_default().not_closed = row.get(1)?;
            Ok(())
        })
    }

    /// The first and the last time of any run, occurrence or event, µs since 1970. `None` for an empty
    /// history.
    ///
    /// # Errors
    /// Of the file or server.
    pub fn history_span(&self) -> Result<Option<(i64, i64)>, StoreError> {
        // Each time by its own index: two in one query would use none.
        let found = self.first(
            "looking for the span of the history",
            "SELECT min(began_us), max(ended_us) FROM (
                SELECT (SELECT min(started_at_us) FROM run) AS began_us,
                    (SELECT max(started_at_us) FROM run) AS ended_us
                UNION ALL SELECT (SELECT min(at_us) FROM fault_occurrence),
                    (SELECT max(at_us) FROM fault_occurrence)
                UNION ALL SELECT (SELECT min(at_us) FROM fault_event),
                    (SELECT max(at_us) FROM fault_event)
            ) AS spans",
            &[],
            |row| Ok((row.get::<Option<i64>>(0)?, row.get::<Option<i64>>(1)?)),
        )?;
        Ok(found.and_then(|(first, last)| Some((first?, last?))))
    }
}

impl StatKey {
    /// The column of this key in faults, occurrences and repairs called `x`.
    fn column(self) -> &'static str {
        match self {
            Self::Code => "x.code",
            Self::Lru => "x.lru",
            Self::Unit => "x.unit",
            Self::Line => "x.line",
            Self::All => "''",
        }
    }
}

/// Readable names of keys.
enum Names {
    OfNumbers(std::collections::BTreeMap<i64, String>, StatKey),
    AsTheyAre,
}

impl Names {
    fn read(store: &Store, by: StatKey) -> Result<Self, StoreError> {
        Ok(match by {
            StatKey::Code => Self::OfNumbers(store.known_codes()?.into_iter().collect(), by),
            StatKey::Unit => {
                let units = store.select(
                    "listing units",
                    "SELECT seq, serial FROM unit",
                    &values![],
                    |row| Ok((row.get(0)?, row.get(1)?)),
                )?;
                Self::OfNumbers(units.into_iter().collect(), by)
            }
            StatKey::Lru | StatKey::Line | StatKey::All => Self::AsTheyAre,
        })
    }

    fn name(&self, key: Key, mut stat: FaultStat) -> FaultStat {
        let (key, name) = match (self, key) {
            (Self::OfNumbers(names, by), Key::Number(number)) => {
                let name = names.get(&number).cloned().unwrap_or_default();
                match by {
                    StatKey::Unit => (name, String::new()),
                    _ => (number.to_string(), name),
                }
            }
            (_, Key::Number(number)) => (number.to_string(), String::new()),
            (_, Key::Text(text)) => (text, String::new()),
        };
        (stat.key, stat.name) = (key, name);
        stat
    }
}

impl Counts {
    fn stat(self, days: f64) -> FaultStat {
        FaultStat {
            key: String::new(),
            name: String::new(),
            faults: self.opened,
            not_closed: self.not_closed,
            occurrences: self.occurrences,
            units: self.units.count(),
            last_at_us: self.last_at_us,
            closed: self.closed,
            no_fault_found: self.closed_without_repair,
            repairs: self.repairs.all,
            repairs_judged: self.repairs.all.saturating_sub(self.repairs.young),
            repairs_back: self.repairs.back,
            mtbf_days: (self.opened > 0).then(|| days / f64::from(self.opened)),
            mttr_hours: self.repairs.mean_hours(),
            course: self.course,
        }
    }
}
