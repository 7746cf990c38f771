//! One filter on faults, for lists, counts and repairs.

use std::collections::HashSet;

use super::filter::Conditions;
use super::filter_names::{codes, lrus, search};
use super::note_filter::{
    faults_with_note, faults_with_run_note, has_note, has_run_note, repaired_with,
};
use crate::backend::{Backend, SqlResult, Value, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::schema::full_text::Search;
use crate::store::Store;
use crate::values::fault_state::FaultState;

/// Selects faults; `None` does not restrict.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FaultFilter {
    /// Serial number of the unit.
    pub unit: Option<String>,
    /// Serial number of a part that a repair took out or put in.
    pub serial: Option<String>,
    /// Train of the unit.
    pub train: Option<String>,
    /// Number (decimal, or hex after `0x`) or name of the fault, or several of these, separated by commas.
    pub code: Option<String>,
    /// The part that the fault points at.
    pub lru: Option<String>,
    /// The part that the fault comes from: the attributed one, or else the one it points at.
    pub cause: Option<String>,
    /// Severity.
    pub severity: Option<String>,
    /// States, any of which matches; an empty list does not restrict.
    pub states: Vec<FaultState>,
    /// Procedure in which it was seen.
    pub procedure: Option<String>,
    /// Line of the run that saw it.
    pub line: Option<String>,
    /// Run in which it was seen.
    pub run: Option<Id>,
    /// Seen at this time or later, µs since 1970.
    pub since_us: Option<i64>,
    /// Seen before this time, µs since 1970.
    pub until_us: Option<i64>,
    /// Words of a note on the fault, or of a note on a run that saw it.
    pub note: Option<String>,
    /// Greatest number of faults in a list.
    pub limit: Option<u32>,
}

/// The table that a filter is applied to. Each has the columns unit, code, lru and line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FilteredTable {
    Faults,
    Occurrences,
    Repairs,
}

/// A filter with its names replaced by row numbers and stored spellings.
#[derive(Clone)]
pub(crate) struct Resolved<'a> {
    filter: &'a FaultFilter,
    pub unit: Option<i64>,
    pub codes: Option<Vec<i64>>,
    pub lrus: Option<Vec<String>>,
    search: Option<Search>,
    frequent: FrequentWords,
}

/// Whether the search words occur so often that searching the texts of each listed fault is faster than looking up all
/// matches.
#[derive(Clone, Copy, Debug, Default)]
struct FrequentWords {
    of_faults: bool,
    of_runs: bool,
}

/// Words are frequent if they match `FREQUENT` or more of the latest `WITHIN_LATEST` texts.
const FREQUENT: u32 = 3000;
const WITHIN_LATEST: i64 = 300_000;
/// Longest list for which the texts of each fault are searched.
const FEW: u32 = 200;

impl FaultFilter {
    /// Looks up the stored numbers and spellings of the filter's names.
    pub(crate) fn resolve(&self, store: &Store) -> Result<Resolved<'_>, StoreError> {
        let unit = self.unit.as_deref().map(|serial| store.unit_seq(serial));
        let code = self.code.as_deref().map(|code| codes(store, code));
        let lru = self.lru.as_deref().map(|lru| lrus(store, lru));
        let search = self.note.as_deref().map(search);
        Ok(Resolved {
            filter: self,
            unit: unit.transpose()?,
            codes: code.transpose()?,
            lrus: lru.transpose()?,
            search: search.transpose()?,
            frequent: FrequentWords::default(),
        })
    }
}

impl Resolved<'_> {
    /// Finds out whether the search words are frequent, for a short list in a file. A server's planner
    /// knows that by itself.
    pub fn estimate_frequency(&mut self, store: &Store) -> Result<(), StoreError> {
        let is_few = self.filter.limit.is_some_and(|most| most <= FEW);
        let (Backend::File(_), Some(search), true) = (&store.backend, &self.search, is_few) else {
            return Ok(());
        };
        let asked = search.for_file();
        let is_frequent = |words: &str, table: &str| {
            let sql = format!(
                "SELECT count(*), min(rowid), (SELECT max(seq) FROM {table}) FROM
                    (SELECT rowid FROM {words} WHERE {words} MATCH ?1 ORDER BY rowid DESC LIMIT {FREQUENT})"
            );
            let found = store.first("searching notes", &sql, &values![asked.as_str()], |row| {
                let (first, last): (Option<i64>, Option<i64>) = (row.get(1)?, row.get(2)?);
                let among = last.zip(first).map(|(last, first)| last - first);
                Ok(row.get::<u32>(0)? == FREQUENT
                    && among.is_some_and(|among| among <= WITHIN_LATEST))
            })?;
            Ok(found == Some(true))
        };
        self.frequent = FrequentWords {
            of_faults: is_frequent("event_words", "fault_event")?,
            of_runs: is_frequent("note_words", "run_note")?,
        };
        Ok(())
    }

    pub fn filter(&self) -> &FaultFilter {
        self.filter
    }

    /// SQL conditions on rows `x`; `span` is the span of time in which an occurrence must lie.
    fn conditions(&self, backend: &Backend, of: FilteredTable, span: Option<Span>) -> Conditions {
        let filter = self.filter;
        let mut all = Conditions::default();
        all.add("x.unit = ?", self.unit);
        if let Some(codes) = &self.codes {
            all.one_of("x.code", codes.clone());
        }
        if let Some(lrus) = &self.lrus {
            all.one_of("x.lru", lrus.clone());
        }
        all.add("x.line = ?", filter.line.clone());
        let fault = match of {
            FilteredTable::Faults => "x.seq",
            FilteredTable::Occurrences | FilteredTable::Repairs => "x.fault",
        };
        let of_fault = |condition: &str| match of {
            FilteredTable::Faults => condition.replace("f.", "x."),
            _ => format!("x.fault IN (SELECT f.seq FROM fault f WHERE {condition})"),
        };
        all.add(
            &of_fault("lower(f.severity) = lower(?)"),
            filter.severity.clone(),
        );
        all.add(
            &of_fault("lower(coalesce(f.cause, f.lru)) = lower(?)"),
            filter.cause.clone(),
        );
        if !filter.states.is_empty() {
            let states = filter.states.iter().map(|state| all.place(*state));
            let states = states.collect::<Vec<_>>().join(", ");
            all.require(of_fault(&format!("f.state IN ({states})")));
        }
        self.of_occurrence(of, fault, span, &mut all);
        if let Some(search) = &self.search {
            let typed = filter.note.clone().unwrap_or_default();
            let of_fault = if self.frequent.of_faults {
                has_note(fault, typed.clone(), &mut all)
            } else {
                format!(
                    "{fault} IN ({})",
                    faults_with_note(backend, search, &mut all)
                )
            };
            let of_run = if self.frequent.of_runs {
                has_run_note(fault, typed, &mut all)
            } else {
                format!(
                    "{fault} IN ({})",
                    faults_with_run_note(backend, search, &mut all)
                )
            };
            all.require(format!("({of_fault} OR {of_run})"));
        }
        if let Some(serial) = &filter.serial {
            let repaired = repaired_with(backend, serial, &mut all);
            all.require(format!("{fault} IN ({repaired})"));
        }
        all
    }

    /// SQL conditions on occurrences; one occurrence must meet all of them.
    fn of_occurrence(
        &self,
        of: FilteredTable,
        fault: &str,
        span: Option<Span>,
        all: &mut Conditions,
    ) {
        let filter = self.filter;
        let name = if of == FilteredTable::Occurrences {
            "x"
        } else {
            "o"
        };
        let mut asked = Vec::new();
        if let Some(train) = &filter.train {
            let place = all.place(train.clone());
            asked.push(format!(
                "{name}.run IN (SELECT r.seq FROM run r WHERE r.train = {place} AND r.train <> '')"
            ));
        }
        if let Some(run) = filter.run {
            let place = all.place(run);
            asked.push(format!(
                "{name}.run IN (SELECT r.seq FROM run r WHERE r.id = {place})"
            ));
        }
        let by_run = !asked.is_empty();
        if let Some(procedure) = &filter.procedure {
            let place = all.place(procedure.clone());
            asked.push(format!(
                "EXISTS (SELECT 1 FROM step s WHERE s.run = {name}.run
                    AND s.step_index = {name}.step_index AND s.procedure = {place})"
            ));
        }
        if of == FilteredTable::Occurrences {
            asked
                .into_iter()
                .for_each(|condition| all.require(condition));
            return;
        }
        // The fault's own row tells whether the fault was seen since a time; an end of the span, or another condition,
        // needs its occurrences.
        let (since_us, until_us) = span.unwrap_or_default();
        if until_us.is_some() || !asked.is_empty() {
            for (compared, at_us) in [(">=", since_us), ("<", until_us)] {
                if let Some(at_us) = at_us {
                    let place = all.place(at_us);
                    asked.push(format!("o.at_us {compared} {place}"));
                }
            }
        }
        if asked.is_empty() {
            return;
        }
        let asked = asked.join(" AND ");
        // If few runs are asked for, their occurrences are read; otherwise the occurrences of each fault.
        all.require(match by_run {
            true => format!("{fault} IN (SELECT o.fault FROM fault_occurrence o WHERE {asked})"),
            false => format!(
                "EXISTS (SELECT 1 FROM fault_occurrence o WHERE o.fault = {fault} AND {asked})"
            ),
        });
    }

    /// The faults of a file with the words, or the part's serial number, that the filter has; `None` if it has neither.
    pub fn faults_by_text(&self, backend: &Backend) -> SqlResult<Option<HashSet<i64>>> {
        let mut found = None;
        if let Some(search) = &self.search {
            let mut all = Conditions::default();
            let of_faults = faults_with_note(backend, search, &mut all);
            let of_runs = faults_with_run_note(backend, search, &mut all);
            let sql = format!("{of_faults} UNION ALL {of_runs}");
            found = Some(numbers(backend, &sql, all.values())?);
        }
        if let Some(serial) = &self.filter.serial {
            let mut all = Conditions::default();
            let sql = repaired_with(backend, serial, &mut all);
            let mut repaired = numbers(backend, &sql, all.values())?;
            if let Some(found) = &found {
                repaired.retain(|fault| found.contains(fault));
            }
            found = Some(repaired);
        }
        Ok(found)
    }

    /// The runs of the train, or the one run, that the filter has; `None` if it has neither.
    pub fn runs(&self, backend: &Backend) -> SqlResult<Option<HashSet<i64>>> {
        let FaultFilter { train, run, .. } = self.filter;
        if train.is_none() && run.is_none() {
            return Ok(None);
        }
        let mut all = Conditions::default();
        all.add("r.train = ? AND r.train <> ''", train.clone());
        all.add("r.id = ?", *run);
        let sql = format!("SELECT r.seq FROM run r {}", all.sql());
        Ok(Some(numbers(backend, &sql, all.values())?))
    }

    /// The conditions without the span of time.
    pub fn conditions_at_any_time(&self, backend: &Backend, of: FilteredTable) -> Conditions {
        self.conditions(backend, of, None)
    }

    /// The conditions with the span of time, on the time column `at` of `x`.
    pub fn conditions_at(&self, backend: &Backend, of: FilteredTable, at: &str) -> Conditions {
        let mut all = self.conditions(backend, of, None);
        all.add(&format!("x.{at} >= ?"), self.filter.since_us);
        all.add(&format!("x.{at} < ?"), self.filter.until_us);
        all
    }

    /// The conditions on faults that were seen in the span of time.
    pub fn conditions_seen(&self, backend: &Backend) -> Conditions {
        let FaultFilter {
            since_us, until_us, ..
        } = *self.filter;
        let mut all = self.conditions(backend, FilteredTable::Faults, Some((since_us, until_us)));
        all.add("x.last_at_us >= ?", since_us);
        all.add("x.first_at_us < ?", until_us);
        all
    }
}

fn numbers(backend: &Backend, sql: &str, values: &[Value<'_>]) -> SqlResult<HashSet<i64>> {
    let found = backend.select(sql, values, |row| row.get(0))?;
    Ok(found.into_iter().collect())
}

/// Start and end, µs.
type Span = (Option<i64>, Option<i64>);
