//! One file's history into another's, as often as one likes: what is known by its id is not
//! added again.

use std::collections::BTreeMap;
use std::path::Path;

use rusqlite::types::Value;
use rusqlite::{Connection, OptionalExtension, params, params_from_iter};
use serde::Serialize;

use crate::error::StoreError;
use crate::store::{OpenOptions, Store};

/// What a merge added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MergeCounts {
    /// Units not known before.
    pub units: usize,
    /// Runs not known before.
    pub runs: usize,
    /// Steps not known before.
    pub steps: usize,
    /// Measurements not known before.
    pub measurements: usize,
    /// Faults not known before.
    pub faults: usize,
    /// Occurrences not known before.
    pub occurrences: usize,
    /// Events not known before.
    pub events: usize,
    /// Traces not known before.
    pub traces: usize,
    /// Recordings not known before.
    pub recordings: usize,
    /// Notes on runs not known before.
    pub notes: usize,
}

/// From a row's number in the other file to its number in this one.
type Numbers = BTreeMap<i64, i64>;

impl Store {
    /// Adds all that the other file has and this one has not, in one transaction.
    pub fn import(&self, from: &Path) -> Result<MergeCounts, StoreError> {
        let same = |path: &Path| std::fs::canonicalize(path).ok();
        if same(from).is_some() && same(from) == same(self.path()) {
            return Err(StoreError::SameFile {
                path: from.to_path_buf(),
            });
        }
        // Opening checks that its schema is the same as ours.
        let other = Store::open_read_only(from)?;
        self.merge_from(&other)
    }

    /// Adds all that this file has to another one, which is created if need be.
    pub fn export(&self, to: &Path, options: OpenOptions) -> Result<MergeCounts, StoreError> {
        let target = Store::open(to, options)?;
        let counts = target.merge_from(self)?;
        target.close()?;
        Ok(counts)
    }

    /// Adds all that the other store has and this one has not, in one transaction.
    pub fn merge_from(&self, other: &Store) -> Result<MergeCounts, StoreError> {
        const DOING: &str = "merging";
        let begin = other.conn.execute_batch("BEGIN");
        // One reading transaction, so that all tables are seen at the same moment.
        begin.map_err(|error| other.failed(DOING, error))?;
        let merged = self.write(DOING, |ours| {
            Merge {
                theirs: &other.conn,
                ours,
                counts: MergeCounts::default(),
            }
            .all()
            .map_err(|error| self.failed(DOING, error))
        });
        let _ = other.conn.execute_batch("COMMIT");
        merged
    }
}

struct Merge<'a> {
    theirs: &'a Connection,
    ours: &'a Connection,
    counts: MergeCounts,
}

impl Merge<'_> {
    /// Parents before children, because children need their parents' new numbers.
    fn all(mut self) -> rusqlite::Result<MergeCounts> {
        let units = self.units()?;
        let runs = self.runs(&units)?;
        self.counts.steps = self.children(&runs, &STEPS)?;
        self.counts.measurements = self.children(&runs, &MEASUREMENTS)?;
        self.children(&runs, &SCRIPTS)?;
        self.counts.recordings = self.children(&runs, &RECORDINGS)?;
        self.notes(&runs)?;
        let channel_sets = self.channel_sets()?;
        let traces = self.traces(&runs, &channel_sets)?;
        let faults = self.faults(&units)?;
        self.occurrences(&faults, &runs, &traces)?;
        self.events(&faults)?;
        for fault in faults.values() {
            self.ours.prepare_cached(RECOUNT)?.execute([fault])?;
        }
        Ok(self.counts)
    }

    fn units(&mut self) -> rusqlite::Result<Numbers> {
        let mut numbers = Numbers::new();
        let mut select = self
            .theirs
            .prepare("SELECT seq, serial, kind, config_name, sw_versions FROM unit")?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let known = "SELECT seq FROM unit WHERE serial = ?1";
            let insert = "INSERT INTO unit(serial, kind, config_name, sw_versions)
                VALUES (?1, ?2, ?3, ?4)";
            let (seq, is_new) = self.find_or_insert(known, insert, &values(row, 1..5)?)?;
            self.counts.units += usize::from(is_new);
            numbers.insert(row.get(0)?, seq);
        }
        Ok(numbers)
    }

    fn runs(&mut self, units: &Numbers) -> rusqlite::Result<Numbers> {
        let mut numbers = Numbers::new();
        let mut select = self.theirs.prepare(
            "SELECT seq, id, unit, line, seed, operator, source, started_at_us, finished_at_us,
                verdict, bench_time_us, wall_time_us, app_version, scripts_sha256,
                unit_config_sha256, injected, owner FROM run",
        )?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let mut run = values(row, 1..17)?;
            run[1] = renumber(units, row.get(2)?);
            let known = "SELECT seq FROM run WHERE id = ?1";
            let insert = "INSERT INTO run(id, unit, line, seed, operator, source, started_at_us,
                    finished_at_us, verdict, bench_time_us, wall_time_us, app_version,
                    scripts_sha256, unit_config_sha256, injected, owner)
                VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16)";
            let (seq, is_new) = self.find_or_insert(known, insert, &run)?;
            self.counts.runs += usize::from(is_new);
            // It may have been copied earlier while it was still running.
            self.ours
                .prepare_cached(
                    "UPDATE run SET finished_at_us = ?2, verdict = ?3, bench_time_us = ?4,
                        wall_time_us = ?5 WHERE seq = ?1 AND verdict IS NULL",
                )?
                .execute(params![seq, run[7], run[8], run[9], run[10]])?;
            numbers.insert(row.get(0)?, seq);
        }
        Ok(numbers)
    }

    /// Copies a table whose rows are named by their run and their place in it.
    fn children(&self, runs: &Numbers, child: &Child) -> rusqlite::Result<usize> {
        let Child { table, columns } = child;
        let width = columns.split(',').count() + 1;
        let places = (1..=width)
            .map(|n| format!("?{n}"))
            .collect::<Vec<_>>()
            .join(", ");
        let insert = format!("INSERT OR IGNORE INTO {table}(run, {columns}) VALUES ({places})");
        let mut insert = self.ours.prepare(&insert)?;
        let mut select = self
            .theirs
            .prepare(&format!("SELECT run, {columns} FROM {table}"))?;
        let mut rows = select.query([])?;
        let mut added = 0;
        while let Some(row) = rows.next()? {
            let mut child = values(row, 0..width)?;
            child[0] = renumber(runs, row.get(0)?);
            added += insert.execute(params_from_iter(child))?;
        }
        Ok(added)
    }

    fn notes(&mut self, runs: &Numbers) -> rusqlite::Result<()> {
        let mut select = self
            .theirs
            .prepare("SELECT id, run, at_us, who, text FROM run_note")?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let mut note = values(row, 0..5)?;
            note[1] = renumber(runs, row.get(1)?);
            let known = "SELECT seq FROM run_note WHERE id = ?1";
            let insert =
                "INSERT INTO run_note(id, run, at_us, who, text) VALUES (?1, ?2, ?3, ?4, ?5)";
            let (_, is_new) = self.find_or_insert(known, insert, &note)?;
            self.counts.notes += usize::from(is_new);
        }
        Ok(())
    }

    fn channel_sets(&self) -> rusqlite::Result<Numbers> {
        let mut numbers = Numbers::new();
        let mut select = self
            .theirs
            .prepare("SELECT seq, sha256, json FROM channel_set")?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let known = "SELECT seq FROM channel_set WHERE sha256 = ?1";
            let insert = "INSERT INTO channel_set(sha256, json) VALUES (?1, ?2)";
            let (seq, _) = self.find_or_insert(known, insert, &values(row, 1..3)?)?;
            numbers.insert(row.get(0)?, seq);
        }
        Ok(numbers)
    }

    fn traces(&mut self, runs: &Numbers, channel_sets: &Numbers) -> rusqlite::Result<Numbers> {
        let mut numbers = Numbers::new();
        let mut select = self.theirs.prepare(
            "SELECT seq, id, run, t0_bench_us, t0_us, period_us, row_count, trigger_row, flags,
                channel_set, encoding, sha256, data, recording FROM trace",
        )?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let mut trace = values(row, 1..14)?;
            trace[1] = renumber(runs, row.get(2)?);
            trace[8] = renumber(channel_sets, row.get(9)?);
            let known = "SELECT seq FROM trace WHERE id = ?1";
            let insert = "INSERT INTO trace(id, run, t0_bench_us, t0_us, period_us, row_count,
                    trigger_row, flags, channel_set, encoding, sha256, data, recording)
                VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13)";
            let (seq, is_new) = self.find_or_insert(known, insert, &trace)?;
            self.counts.traces += usize::from(is_new);
            // It may have been copied earlier while its procedure was still under way.
            self.ours
                .prepare_cached(
                    "UPDATE trace SET recording = ?2 WHERE seq = ?1 AND recording IS NULL",
                )?
                .execute(params![seq, trace[12]])?;
            numbers.insert(row.get(0)?, seq);
        }
        Ok(numbers)
    }

    /// A fault of theirs is ours if it has the same id, or if both files have the same unit, code
    /// and part not closed: two laptops then saw one fault.
    fn faults(&mut self, units: &Numbers) -> rusqlite::Result<Numbers> {
        let mut numbers = Numbers::new();
        let mut select = self.theirs.prepare(
            "SELECT seq, id, unit, code, lru, code_name, severity, state, first_at_us, last_at_us,
                occurrences FROM fault",
        )?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let mut fault = values(row, 1..11)?;
            fault[1] = renumber(units, row.get(2)?);
            let known = "SELECT seq FROM fault WHERE id = ?1 OR (?7 <> 'closed' AND unit = ?2
                    AND code = ?3 AND lru = ?4 AND state <> 'closed')
                ORDER BY id = ?1 DESC, seq LIMIT 1";
            let insert = "INSERT INTO fault(id, unit, code, lru, code_name, severity, state,
                    first_at_us, last_at_us, occurrences)
                VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)";
            let (seq, is_new) = self.find_or_insert(known, insert, &fault)?;
            self.counts.faults += usize::from(is_new);
            numbers.insert(row.get(0)?, seq);
        }
        Ok(numbers)
    }

    fn occurrences(
        &mut self,
        faults: &Numbers,
        runs: &Numbers,
        traces: &Numbers,
    ) -> rusqlite::Result<()> {
        let mut select = self.theirs.prepare(
            "SELECT id, fault, run, step_index, at_us, bench_us, message, freeze_json, trace
             FROM fault_occurrence",
        )?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let mut occurrence = values(row, 0..9)?;
            occurrence[1] = renumber(faults, row.get(1)?);
            occurrence[2] = renumber(runs, row.get(2)?);
            if let Some(trace) = row.get(8)? {
                occurrence[8] = renumber(traces, trace);
            }
            let known = "SELECT seq FROM fault_occurrence WHERE id = ?1";
            let insert = "INSERT INTO fault_occurrence(id, fault, run, step_index, at_us,
                    bench_us, message, freeze_json, trace)
                VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)";
            let (seq, is_new) = self.find_or_insert(known, insert, &occurrence)?;
            self.counts.occurrences += usize::from(is_new);
            // Its trace may have come after an earlier copy.
            self.ours
                .prepare_cached(
                    "UPDATE fault_occurrence SET trace = ?2 WHERE seq = ?1 AND trace IS NULL",
                )?
                .execute(params![seq, occurrence[8]])?;
        }
        Ok(())
    }

    fn events(&mut self, faults: &Numbers) -> rusqlite::Result<()> {
        let mut select = self
            .theirs
            .prepare("SELECT id, fault, kind, at_us, who, body, state FROM fault_event")?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let mut event = values(row, 0..7)?;
            event[1] = renumber(faults, row.get(1)?);
            let known = "SELECT seq FROM fault_event WHERE id = ?1";
            let insert = "INSERT INTO fault_event(id, fault, kind, at_us, who, body, state)
                VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)";
            let (_, is_new) = self.find_or_insert(known, insert, &event)?;
            self.counts.events += usize::from(is_new);
        }
        Ok(())
    }

    /// The number of our row, and whether it had to be added.
    fn find_or_insert(
        &self,
        known: &str,
        insert: &str,
        row: &[Value],
    ) -> rusqlite::Result<(i64, bool)> {
        let mut find = self.ours.prepare_cached(known)?;
        let needed = find.parameter_count();
        let found = find
            .query_row(params_from_iter(&row[..needed]), |row| row.get(0))
            .optional()?;
        match found {
            Some(seq) => Ok((seq, false)),
            None => {
                let seq = self
                    .ours
                    .prepare_cached(insert)?
                    .insert(params_from_iter(row))?;
                Ok((seq, true))
            }
        }
    }
}

/// A table whose rows belong to a run and have no id of their own.
struct Child {
    table: &'static str,
    columns: &'static str,
}

const STEPS: Child = Child {
    table: "step",
    columns: "step_index, procedure, name, verdict, started_bench_us, bench_time_us, message,
        script_line",
};
const MEASUREMENTS: Child = Child {
    table: "measurement",
    columns: "step_index, ordinal, name, value, unit, low, high, verdict",
};
const SCRIPTS: Child = Child {
    table: "run_script",
    columns: "path, sha256",
};

const RECORDINGS: Child = Child {
    table: "recording",
    columns: "ordinal, procedure, t0_bench_us, bench_json, stimuli",
};

/// Counts and times follow from the occurrences, the state from the latest event that set one.
const RECOUNT: &str = "
    UPDATE fault SET
        (occurrences, first_at_us, last_at_us) =
            (SELECT count(*), ifnull(min(o.at_us), first_at_us), ifnull(max(o.at_us), last_at_us)
             FROM fault_occurrence o WHERE o.fault = ?1),
        state = ifnull((SELECT e.state FROM fault_event e
            WHERE e.fault = ?1 AND e.state IS NOT NULL
            ORDER BY e.at_us DESC, e.id DESC LIMIT 1), state)
    WHERE seq = ?1";

fn values(
    row: &rusqlite::Row<'_>,
    columns: std::ops::Range<usize>,
) -> rusqlite::Result<Vec<Value>> {
    columns.map(|column| row.get(column)).collect()
}

/// A row whose parent is missing keeps no number; the foreign key then refuses it by name.
fn renumber(numbers: &Numbers, theirs: i64) -> Value {
    numbers
        .get(&theirs)
        .map_or(Value::Null, |ours| Value::Integer(*ours))
}
