//! Fault statistics: frequency, mean time between faults, mean time to repair, and repairs that held.
//!
//! A file answers from the counts that its triggers maintain if the filter allows it; the incomplete days
//! at both ends of the span, and every other filter, are counted row by row. A server always counts row by
//! row.

mod counted;
mod exposure;
mod plain;
mod repairs;
mod tallied;

use serde::Serialize;

pub(crate) use counted::Bins;
use counted::{Counts, Key};
use exposure::Exposure;

use super::fault_filter::{FaultFilter, FilteredTable, Resolved};
use crate::backend::{Backend, values};
use crate::error::StoreError;
use crate::store::Store;

/// Microseconds of an hour.
const HOUR_US: f64 = 3.6e9;

/// What to count faults by.
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
    /// Nothing: all together.
    All,
}

/// Which faults to count, and how.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatQuery {
    /// By what.
    pub by: StatKey,
    /// Which faults, and when.
    pub filter: FaultFilter,
    /// The end of history, for what is still going on.
    pub now_us: i64,
    /// A fault that is seen again within so many days after its repair is back.
    pub back_within_days: u32,
}

/// The faults of one code, part, unit or line in a span of time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FaultStat {
    /// The number as text, the part, the serial number, the line.
    pub key: String,
    /// The fault's name; empty for all but a code.
    pub name: String,
    /// Faults first seen, closed ones too.
    pub faults: u32,
    /// Faults last seen that are not closed now.
    pub not_closed: u32,
    /// Times seen.
    pub occurrences: u64,
    /// Units that had it.
    pub units: u32,
    /// Last seen; none if it was not.
    pub last_at_us: Option<i64>,
    /// Faults closed.
    pub closed: u32,
    /// Of these without a repair: no fault was found.
    pub no_fault_found: u32,
    /// Repairs.
    pub repairs: u32,
    /// Repairs that are old enough to know whether they held, or did not hold before that.
    pub repairs_judged: u32,
    /// Of these the repairs after which the unit had the same fault again in time.
    pub repairs_back: u32,
    /// Mean time between faults: days the units were known for, by faults first seen. None without a
    /// fault.
    pub mtbf_days: Option<f64>,
    /// Mean time to repair: hours from a fault's opening to its repair. None without a repair.
    pub mttr_hours: Option<f64>,
    /// Times seen by day or by month (UTC), in order.
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
            Backend::File(_) => tallied::reads(&resolved, query.by),
            Backend::Server(_) => None,
        };
        let counted = match &kept {
            Some(kept) => tallied::count(self.backend(), kept, &query.filter, &bins),
            None => plain::count(self.backend(), &resolved, query.by, &bins),
        };
        let mut counted = counted.map_err(failed)?;
        counted.retain(|_, counts| !counts.is_nothing());
        self.add_not_closed(&resolved, query.by, &mut counted)
            .map_err(failed)?;
        if kept.is_none() || query.back_within_days != repairs::KEPT_DAYS {
            repairs::add(self.backend(), &resolved, query, &mut counted).map_err(failed)?;
        }
        repairs::add_young(self.backend(), &resolved, query, &mut counted).map_err(failed)?;
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

    fn add_not_closed(
        &self,
        resolved: &Resolved<'_>,
        by: StatKey,
        counted: &mut counted::Counted,
    ) -> crate::backend::SqlResult<()> {
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

    /// The first and the last time of anything that is counted: a run begun, a fault seen, repaired or
    /// closed. None of an empty history.
    ///
    /// # Errors
    /// Of the file or server.
    pub fn history_span(&self) -> Result<Option<(i64, i64)>, StoreError> {
        // Each time by its index: of two in one question neither would be.
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
    /// The column of faults, occurrences and repairs it is, of rows called `x`.
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

/// What keys are called by people.
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
