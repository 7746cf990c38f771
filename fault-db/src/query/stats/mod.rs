//! Fault statistics: frequency, mean time between faults, mean time to repair, and repairs that held.
//!
//! In a file, packed faults are counted for every filter and for several spans at once (`in_file`); a server is asked
//! in SQL (`on_server`), because it groups its rows faster than it returns them. SQLite does not: it took 0.8 to 1.5 s
//! to group 375 000 occurrences by key and month, where a million may take 0.3 s.

mod cases;
mod counts;
mod exposure;
mod in_file;
mod on_server;

use serde::Serialize;

pub(crate) use counts::Bins;
pub use counts::StatKey;
use counts::{Counts, CountsByKey, Key};
use exposure::{Exposure, Observed};

use super::fault_filter::{FaultFilter, Resolved};
use crate::backend::{Backend, values};
use crate::error::StoreError;
use crate::store::Store;

/// Selects the faults to count.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatQuery {
    /// Key by which the faults are grouped.
    pub by: StatKey,
    /// Filter of the faults, and the span of time.
    pub filter: FaultFilter,
    /// The present time, µs since 1970: the end of the observation.
    pub now_us: i64,
    /// A repair did not hold if the fault is seen again within this many days.
    pub back_within_days: u32,
}

/// Counts of the faults of one code, part, unit or line in a span of time; of a cause, of its cases.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FaultStat {
    /// The code's number as text, the part, the unit's serial number or the line, depending on the key.
    pub key: String,
    /// The fault's name if the key is a code; else empty.
    pub name: String,
    /// Faults (of a cause: cases) first seen in the span, including closed ones.
    pub faults: u32,
    /// Faults last seen in the span that are not closed now.
    pub not_closed: u32,
    /// Number of occurrences.
    pub occurrences: u64,
    /// Number of units affected.
    pub units: u32,
    /// Time of the last occurrence, µs since 1970; `None` without any.
    pub last_at_us: Option<i64>,
    /// Faults closed in the span.
    pub closed: u32,
    /// Faults closed without a repair (no fault found).
    pub no_fault_found: u32,
    /// Number of repairs.
    pub repairs: u32,
    /// Repairs that are old enough to be judged, and younger ones that have already failed.
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

/// Start and end of a span to count, and its parts.
struct CountedSpan {
    since_us: Option<i64>,
    until_us: Option<i64>,
    bins: Bins,
}

const DOING: &str = "counting faults";

impl Store {
    /// Counts faults by code, part, unit or line, or cases by cause, the most frequent first.
    ///
    /// # Errors
    /// The filter names what is not there, or the file or server cannot be read.
    pub fn stats(&self, query: &StatQuery) -> Result<Vec<FaultStat>, StoreError> {
        Ok(self.count_and_total(query, false)?.0)
    }

    /// Counts as [`Store::stats`], and the counts of all keys together.
    ///
    /// # Errors
    /// The filter names what is not there, or the file or server cannot be read.
    pub fn stats_and_total(
        &self,
        query: &StatQuery,
    ) -> Result<(Vec<FaultStat>, FaultStat), StoreError> {
        self.count_and_total(query, true)
    }

    /// Counts faults in each of several spans instead of the filter's; the spans are in order and do not
    /// overlap.
    ///
    /// # Errors
    /// The filter names what is not there, or the file or server cannot be read.
    pub fn stats_of_spans(
        &self,
        query: &StatQuery,
        spans: &[std::ops::Range<i64>],
    ) -> Result<Vec<Vec<FaultStat>>, StoreError> {
        if let Backend::Server(_) = &self.backend {
            let in_span = |span: &std::ops::Range<i64>| {
                let mut query = query.clone();
                query.filter.since_us = Some(span.start);
                query.filter.until_us = Some(span.end);
                self.stats(&query)
            };
            return spans.iter().map(in_span).collect();
        }
        let resolved = query.filter.resolve(self)?;
        let observed = Observed::read(self, &resolved, query.now_us)?;
        let names = Names::read(self, query.by)?;
        let within = |span: &std::ops::Range<i64>| {
            let (since_us, until_us) = (Some(span.start), Some(span.end));
            CountedSpan {
                since_us,
                until_us,
                bins: observed.within(since_us, until_us).bins(),
            }
        };
        let spans: Vec<_> = spans.iter().map(within).collect();
        let count = |file: &Backend| in_file::count(file, &resolved, query, &spans);
        let counted = self.ask(DOING, count)?;
        let in_spans = counted.into_iter().zip(&spans);
        let in_spans = in_spans.map(|(counted, span)| {
            let exposure = observed.within(span.since_us, span.until_us);
            names.stats(counted, &exposure, &span.bins)
        });
        Ok(in_spans.collect())
    }

    /// The counts of each key; with `with_total` also the counts of all keys together.
    fn count_and_total(
        &self,
        query: &StatQuery,
        with_total: bool,
    ) -> Result<(Vec<FaultStat>, FaultStat), StoreError> {
        let resolved = query.filter.resolve(self)?;
        let observed = Observed::read(self, &resolved, query.now_us)?;
        let FaultFilter {
            since_us, until_us, ..
        } = query.filter;
        let exposure = observed.within(since_us, until_us);
        let span = CountedSpan {
            since_us,
            until_us,
            bins: exposure.bins(),
        };
        let counted = self.count(&resolved, query, &span)?;
        let mut total = Counts::default();
        if with_total {
            match &self.backend {
                Backend::File(_) => counted.values().for_each(|key| total.add_key(key)),
                // A server tells the number of units of a key, not which they are.
                Backend::Server(_) => {
                    let by = StatKey::All;
                    let all = StatQuery {
                        by,
                        ..query.clone()
                    };
                    let all = self.count(&resolved, &all, &span)?;
                    total = all.into_values().next().unwrap_or_default();
                    if query.by == StatKey::Cause {
                        total.take_cases(&counted);
                    }
                }
            }
        }
        total.course.resize(span.bins.len(), 0);
        let days = exposure.days(StatKey::All, &Key::Text(String::new()));
        let names = Names::read(self, query.by)?;
        let stats = names.stats(counted, &exposure, &span.bins);
        Ok((stats, total.stat(days)))
    }

    fn count(
        &self,
        resolved: &Resolved<'_>,
        query: &StatQuery,
        span: &CountedSpan,
    ) -> Result<CountsByKey, StoreError> {
        self.ask(DOING, |backend| match backend {
            Backend::File(_) => {
                let spans = std::slice::from_ref(span);
                let mut counted = in_file::count(backend, resolved, query, spans)?;
                Ok(counted.pop().unwrap_or_default())
            }
            Backend::Server(_) => on_server::count(backend, resolved, query, &span.bins),
        })
    }

    /// The first and the last time of any run, occurrence or event, µs since 1970. `None` for an empty
    /// history.
    ///
    /// # Errors
    /// The file or server cannot be read.
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

/// Readable names of keys that are numbers.
struct Names {
    by: StatKey,
    of_numbers: std::collections::BTreeMap<i64, String>,
}

impl Names {
    fn read(store: &Store, by: StatKey) -> Result<Self, StoreError> {
        let names = match by {
            StatKey::Code => store.known_codes()?,
            StatKey::Unit => store.select(
                "listing units",
                "SELECT seq, serial FROM unit",
                &values![],
                |row| Ok((row.get(0)?, row.get(1)?)),
            )?,
            StatKey::Lru | StatKey::Cause | StatKey::Line | StatKey::All => Vec::new(),
        };
        Ok(Self {
            by,
            of_numbers: names.into_iter().collect(),
        })
    }

    /// Statistics from counts, the most frequent first.
    fn stats(&self, counted: CountsByKey, exposure: &Exposure<'_>, bins: &Bins) -> Vec<FaultStat> {
        let stats = counted.into_iter().map(|(key, mut counts)| {
            counts.course.resize(bins.len(), 0);
            let days = exposure.days(self.by, &key);
            self.name(key, counts.stat(days))
        });
        let mut stats: Vec<_> = stats.collect();
        let rank = |stat: &FaultStat| match self.by {
            StatKey::Cause => (u64::from(stat.faults), stat.occurrences),
            _ => (stat.occurrences, 0),
        };
        stats.sort_by(|a, b| (rank(b), &a.key).cmp(&(rank(a), &b.key)));
        stats
    }

    fn name(&self, key: Key, mut stat: FaultStat) -> FaultStat {
        let (key, name) = match (self.by, key) {
            (by, Key::Number(number)) => {
                let name = self.of_numbers.get(&number).cloned().unwrap_or_default();
                match by {
                    StatKey::Unit => (name, String::new()),
                    _ => (number.to_string(), name),
                }
            }
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
