//! Copies rows between files: each is found by its key or inserted, with its parents renumbered.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::types::Value;
use rusqlite::{OptionalExtension, params_from_iter};

use super::Merge;

/// From row numbers of the other file to row numbers of this one.
pub(super) type Numbers = BTreeMap<i64, i64>;

impl Merge<'_> {
    /// Copies the rows of a table keyed by run and position, except for finished runs.
    pub(super) fn children(&self, runs: &Numbers, child: &Child) -> rusqlite::Result<usize> {
        self.add(runs, child, &self.sealed_runs)
    }

    /// The same, except for the runs given.
    pub(super) fn add(
        &self,
        runs: &Numbers,
        child: &Child,
        but_for: &BTreeSet<i64>,
    ) -> rusqlite::Result<usize> {
        let Child { table, columns } = child;
        let width = columns.split(',').count() + 1;
        let places = (1..=width)
            .map(|n| format!("?{n}"))
            .collect::<Vec<_>>()
            .join(", ");
        let insert =
            format!("INSERT INTO {table}(run, {columns}) VALUES ({places}) ON CONFLICT DO NOTHING");
        let mut insert = self.ours.prepare(&insert)?;
        let mut select = self
            .theirs
            .prepare(&format!("SELECT run, {columns} FROM {table}"))?;
        let mut rows = select.query([])?;
        let mut added = 0;
        while let Some(row) = rows.next()? {
            let run = renumber(runs, row.get(0)?);
            if matches!(run, Value::Integer(run) if but_for.contains(&run)) {
                continue;
            }
            let mut child = values(row, 0..width)?;
            child[0] = run;
            added += insert.execute(params_from_iter(child))?;
        }
        Ok(added)
    }

    /// The number of our row, and whether it was inserted.
    pub(super) fn find_or_insert(
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
pub(super) struct Child {
    table: &'static str,
    columns: &'static str,
}

pub(super) const STEPS: Child = Child {
    table: "step",
    columns: "step_index, procedure, name, verdict, started_bench_us, bench_time_us, message,
        script_line",
};
pub(super) const MEASUREMENTS: Child = Child {
    table: "measurement",
    columns: "step_index, ordinal, name, value, unit, low, high, verdict",
};
pub(super) const SCRIPTS: Child = Child {
    table: "run_script",
    columns: "path, sha256",
};

pub(super) const RECORDINGS: Child = Child {
    table: "recording",
    columns: "ordinal, procedure, t0_bench_us, bench_json, stimuli",
};

pub(super) fn values(
    row: &rusqlite::Row<'_>,
    columns: std::ops::Range<usize>,
) -> rusqlite::Result<Vec<Value>> {
    columns.map(|column| row.get(column)).collect()
}

/// Without a known parent it becomes NULL, which the foreign key then refuses.
pub(super) fn renumber(numbers: &Numbers, theirs: i64) -> Value {
    numbers
        .get(&theirs)
        .map_or(Value::Null, |ours| Value::Integer(*ours))
}
