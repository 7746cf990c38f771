//! Merges faults with their occurrences and events.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::params;
use rusqlite::types::Value;

use super::Merge;
use super::rows::{Numbers, renumber, values};
use crate::backend::SqlResult;
use crate::event_graph::{fault_of, merge_faults, open_duplicates, recompute_fault};
use crate::id::Id;
use crate::recurrence::reopen_if_recurred;

impl Merge<'_> {
    /// A fault of theirs is one of ours if they have an id or alias in common. Whether two faults of the same
    /// unit, code and part are to be merged is decided after all events are merged, as one side may have
    /// closed its fault.
    pub(super) fn faults(
        &mut self,
        units: &Numbers,
        runs: &Numbers,
        traces: &Numbers,
    ) -> SqlResult<()> {
        let mut known = FaultMap::default();
        self.fault_rows(units, runs, &mut known)?;
        self.occurrences(runs, traces, &mut known)?;
        self.events(&mut known)?;
        for fault in &known.touched {
            recompute_fault(self.backend, *fault)?;
        }
        self.merge_duplicates(known.touched.clone(), &mut known)?;
        // A reopened fault may now be merged with another one, which brings more occurrences or resolutions.
        let mut changed = known.touched.clone();
        while !changed.is_empty() {
            let mut again = BTreeSet::new();
            for fault in changed {
                if reopen_if_recurred(self.backend, fault)? {
                    recompute_fault(self.backend, fault)?;
                    again.insert(fault);
                }
            }
            changed = self.merge_duplicates(again, &mut known)?;
        }
        self.counts.faults = known.added.len();
        Ok(())
    }

    fn fault_rows(&self, units: &Numbers, runs: &Numbers, known: &mut FaultMap) -> SqlResult<()> {
        let aliases = self.their_aliases()?;
        let mut select = self.theirs.prepare(
            "SELECT seq, id, unit, code, lru, code_name, severity, state, first_at_us, last_at_us, line
             FROM fault",
        )?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let (theirs, id): (i64, Id) = (row.get(0)?, row.get(1)?);
            let ids: Vec<Id> = std::iter::once(id)
                .chain(aliases.get(&theirs).into_iter().flatten().copied())
                .collect();
            let mut ours = BTreeSet::new();
            for id in &ids {
                ours.extend(fault_of(self.backend, *id)?);
            }
            let mut ours = ours.into_iter();
            let fault = match ours.next() {
                Some(fault) => fault,
                None if self.is_of_sealed_runs(theirs, runs)? => {
                    known.left_out.insert(theirs);
                    continue;
                }
                None => {
                    let mut fault = values(row, 1..11)?;
                    fault[1] = renumber(units, row.get(2)?);
                    let fault = self.add_fault(fault)?;
                    known.added.insert(fault);
                    known.touched.insert(fault);
                    fault
                }
            };
            // Two faults of ours are one in the other file.
            for duplicate in ours {
                known.merge(self, fault, duplicate)?;
            }
            for id in ids {
                self.note_alias(id, fault)?;
            }
            known.numbers.insert(theirs, fault);
        }
        Ok(())
    }

    /// Whether a fault unknown here was seen only by runs that are finished here: these saw no such fault, so
    /// the other file contradicts them.
    fn is_of_sealed_runs(&self, theirs: i64, runs: &Numbers) -> rusqlite::Result<bool> {
        let mut seen = self
            .theirs
            .prepare_cached("SELECT DISTINCT run FROM fault_occurrence WHERE fault = ?1")?;
        let mut rows = seen.query([theirs])?;
        let mut is_seen = false;
        while let Some(row) = rows.next()? {
            is_seen = true;
            let ours = runs.get(&row.get(0)?);
            if !ours.is_some_and(|run| self.sealed_runs.contains(run)) {
                return Ok(false);
            }
        }
        Ok(is_seen)
    }

    /// Their aliases, by row number of the fault.
    fn their_aliases(&self) -> rusqlite::Result<BTreeMap<i64, Vec<Id>>> {
        let mut aliases = BTreeMap::<i64, Vec<Id>>::new();
        let mut select = self.theirs.prepare("SELECT fault, id FROM fault_alias")?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            aliases.entry(row.get(0)?).or_default().push(row.get(1)?);
        }
        Ok(aliases)
    }

    /// Derived columns are computed when occurrences and events are complete.
    fn add_fault(&self, fault: Vec<Value>) -> rusqlite::Result<i64> {
        let mut insert = self.ours.prepare_cached(
            "INSERT INTO fault(id, unit, code, lru, code_name, severity, state, first_at_us, last_at_us,
                line, occurrences)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, 0)",
        )?;
        insert.insert(rusqlite::params_from_iter(fault))
    }

    fn note_alias(&self, id: Id, fault: i64) -> rusqlite::Result<()> {
        let mut insert = self.ours.prepare_cached(
            "INSERT INTO fault_alias(id, fault) SELECT ?1, ?2
             WHERE NOT EXISTS (SELECT 1 FROM fault WHERE id = ?1) ON CONFLICT DO NOTHING",
        )?;
        insert.execute(params![id, fault])?;
        Ok(())
    }

    fn occurrences(
        &mut self,
        runs: &Numbers,
        traces: &Numbers,
        known: &mut FaultMap,
    ) -> rusqlite::Result<()> {
        let mut select = self.theirs.prepare(
            "SELECT id, fault, run, step_index, at_us, bench_us, message, freeze_json, trace, code, lru, line,
                code_name, severity
             FROM fault_occurrence",
        )?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            if known.left_out.contains(&row.get(1)?) {
                continue;
            }
            let mut occurrence = values(row, 0..14)?;
            let fault = known.number(row.get(1)?);
            occurrence[1] = fault.map_or(Value::Null, Value::Integer);
            occurrence[2] = renumber(runs, row.get(2)?);
            if let Some(trace) = row.get(8)? {
                occurrence[8] = renumber(traces, trace);
            }
            let find = "SELECT seq FROM fault_occurrence WHERE id = ?1";
            let is_sealed = runs
                .get(&row.get(2)?)
                .is_some_and(|run| self.sealed_runs.contains(run));
            if is_sealed && !self.ours.prepare_cached(find)?.exists([&occurrence[0]])? {
                continue;
            }
            let insert = "INSERT INTO fault_occurrence(id, fault, run, step_index, at_us, bench_us,
                    message, freeze_json, trace, code, lru, line, code_name, severity, unit)
                VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14,
                    (SELECT unit FROM fault WHERE seq = ?2))";
            let (seq, is_new) = self.find_or_insert(find, insert, &occurrence)?;
            if is_new {
                self.counts.occurrences += 1;
                known.touched.extend(fault);
            } else if !matches!(occurrence[8], Value::Null) {
                // Its trace may have been added after an earlier copy.
                self.ours
                    .prepare_cached(
                        "UPDATE fault_occurrence SET trace = ?2 WHERE seq = ?1 AND trace IS NULL",
                    )?
                    .execute(params![seq, occurrence[8]])?;
            }
        }
        Ok(())
    }

    fn events(&mut self, known: &mut FaultMap) -> rusqlite::Result<()> {
        let mut select = self.theirs.prepare(
            "SELECT id, fault, kind, at_us, who, body, state, turn, follows, seen FROM fault_event ORDER BY seq",
        )?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            if known.left_out.contains(&row.get(1)?) {
                continue;
            }
            let mut event = values(row, 0..10)?;
            let fault = known.number(row.get(1)?);
            event[1] = fault.map_or(Value::Null, Value::Integer);
            let find = "SELECT seq FROM fault_event WHERE id = ?1";
            let insert = "INSERT INTO fault_event(id, fault, kind, at_us, who, body, state, turn, follows, seen)
                VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)";
            let (_, is_new) = self.find_or_insert(find, insert, &event)?;
            if is_new {
                self.counts.events += 1;
                known.touched.extend(fault);
            }
        }
        Ok(())
    }

    /// Merges faults that are not closed with others of the same unit, code and part; those that others were
    /// merged into.
    fn merge_duplicates(
        &self,
        of: BTreeSet<i64>,
        known: &mut FaultMap,
    ) -> SqlResult<BTreeSet<i64>> {
        let mut kept = BTreeSet::new();
        for fault in of {
            let mut duplicates = open_duplicates(self.backend, fault)?.into_iter();
            if let Some(oldest) = duplicates.next() {
                for duplicate in duplicates {
                    known.merge(self, oldest, duplicate)?;
                    kept.insert(oldest);
                }
            }
        }
        Ok(kept)
    }
}

/// The mapping of their faults to ours.
#[derive(Default)]
struct FaultMap {
    numbers: Numbers,
    /// Faults of ours with new rows.
    touched: BTreeSet<i64>,
    /// Faults of theirs that are left out.
    left_out: BTreeSet<i64>,
    /// Faults of ours that came from the other file.
    added: BTreeSet<i64>,
}

impl FaultMap {
    /// Our row number of a fault of theirs.
    fn number(&self, theirs: i64) -> Option<i64> {
        self.numbers.get(&theirs).copied()
    }

    fn merge(&mut self, merge: &Merge<'_>, kept: i64, merged: i64) -> SqlResult<()> {
        merge_faults(merge.backend, kept, merged)?;
        for number in self
            .numbers
            .values_mut()
            .filter(|number| **number == merged)
        {
            *number = kept;
        }
        self.added.remove(&merged);
        self.touched.remove(&merged);
        self.touched.insert(kept);
        Ok(())
    }
}
