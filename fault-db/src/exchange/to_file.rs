//! Applies change sets to a SQLite file.

use std::collections::BTreeSet;

use rusqlite::{Connection, params_from_iter};

use super::change_set::{ChangeSet, Counts};
use super::columns::Kind;
use super::rows::Rows;
use super::tables::{COUNT, TableId};
use crate::backend::{Backend, SqlResult, Value, values};
use crate::history::event_graph::{fault_of, merge_faults};
use crate::id::Id;
use crate::seal::covered::{Covered, seal_as_found};

/// A file to which change sets are applied, in the caller's transaction.
pub(super) struct FileApplier<'a> {
    file: &'a Backend,
    /// The SQLite connection of `file`.
    conn: &'a Connection,
    /// The file may be older than the change sets: rows of faults that it does not have are skipped.
    pub is_older: bool,
    /// The file's last event and note before anything was added.
    pub before: LastEntries,
    /// New rows by table.
    pub counts: Counts,
    /// Ids of faults with new rows, to be settled.
    pub touched: BTreeSet<Id>,
    new_faults: BTreeSet<Id>,
    /// Runs added or completed.
    new_runs: BTreeSet<Id>,
}

/// Row numbers of a file's last event and last note at some time.
#[derive(Clone, Copy)]
pub(super) struct LastEntries {
    pub event: i64,
    pub note: i64,
}

impl<'a> FileApplier<'a> {
    pub fn begin(file: &'a Backend, conn: &'a Connection) -> SqlResult<Self> {
        let last = "SELECT coalesce((SELECT max(seq) FROM fault_event), 0),
            coalesce((SELECT max(seq) FROM run_note), 0)";
        let last = file.first(last, &[], |row| Ok((row.get(0)?, row.get(1)?)))?;
        let (event, note) = last.unwrap_or_default();
        Ok(Self {
            file,
            conn,
            is_older: false,
            before: LastEntries { event, note },
            counts: [0; COUNT],
            touched: BTreeSet::new(),
            new_faults: BTreeSet::new(),
            new_runs: BTreeSet::new(),
        })
    }

    /// Adds the rows that the file does not have.
    pub fn apply(&mut self, set: &ChangeSet) -> SqlResult<()> {
        // Aliases come before the faults: an alias tells that a fault is already here under another id.
        self.join_aliases(set.rows(TableId::Alias))?;
        for rows in set.tables() {
            match rows.table.of {
                TableId::Alias => self.join_aliases(rows)?,
                _ => self.insert(rows)?,
            }
        }
        Ok(())
    }

    fn insert(&mut self, rows: &Rows) -> SqlResult<()> {
        if rows.count() == 0 {
            return Ok(());
        }
        let (table, of) = (rows.table, rows.table.of);
        let mut insert = match table.is_inserted {
            true => Some(self.conn.prepare_cached(&table.insert_into_file())?),
            false => None,
        };
        let mut complete = match table.file_complete {
            "" => None,
            sql => Some(self.conn.prepare_cached(&table.numbered(sql))?),
        };
        let columns = table.columns.len();
        let fault = (table.columns.iter()).position(|column| column.kind == Kind::Fault);
        for row in rows.iter() {
            let fault = fault.and_then(|place| row[place].id());
            if let (true, Some(fault)) = (self.is_older, fault)
                && fault_of(self.file, fault)?.is_none()
            {
                continue;
            }
            let is_new = match &mut insert {
                Some(insert) => insert.execute(params_from_iter(&row[..columns]))? > 0,
                None => false,
            };
            let is_completed = match &mut complete {
                Some(complete) if !is_new => {
                    let values = &row[..complete.parameter_count()];
                    complete.execute(params_from_iter(values))? > 0
                }
                _ => false,
            };
            self.counts[of as usize] += u64::from(is_new);
            match of {
                TableId::Run if is_new || is_completed => self.new_runs.extend(row[0].id()),
                TableId::Fault if is_new => {
                    self.touched.extend(row[0].id());
                    self.new_faults.extend(row[0].id());
                }
                TableId::Occurrence | TableId::Event if is_new => self.touched.extend(fault),
                _ => {}
            }
        }
        Ok(())
    }

    /// Adds the ids that a fault has elsewhere. Two faults of this file that are one fault elsewhere are merged.
    fn join_aliases(&mut self, rows: &Rows) -> SqlResult<()> {
        let insert = "INSERT INTO fault_alias(id, fault) VALUES (?1, ?2)";
        for row in rows.iter() {
            let (Some(fault), Some(alias)) = (row[0].id(), row[1].id()) else {
                continue;
            };
            match (fault_of(self.file, fault)?, fault_of(self.file, alias)?) {
                (Some(known), None) => drop(self.file.execute(insert, &values![alias, known])?),
                (None, Some(known)) => drop(self.file.execute(insert, &values![fault, known])?),
                (Some(one), Some(other)) if one != other => {
                    merge_faults(self.file, one.min(other), one.max(other))?;
                    self.touched.insert(fault);
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Number of faults that were added and not merged into others since.
    pub fn faults_added(&self) -> SqlResult<usize> {
        let mut count = 0;
        for id in &self.new_faults {
            let stays = "SELECT 1 FROM fault WHERE id = ?1";
            count += usize::from(self.file.has(stays, &values![*id])?);
        }
        Ok(count)
    }

    /// Seals, as found, the added runs, events and notes that came without a seal; `found` says how they came.
    pub fn seal_the_rest(&self, found: &str) -> SqlResult<()> {
        let seal_unsealed = |kind: Covered, which: &str, value: Value<'_>| {
            let (table, word) = (kind.table(), kind.word());
            let sql = format!(
                "SELECT seq FROM {table} e WHERE {which} AND NOT EXISTS
                    (SELECT 1 FROM seal s WHERE s.id = e.id AND s.what = '{word}') ORDER BY seq"
            );
            let rows: Vec<i64> = self.file.select(&sql, &[value], |row| row.get(0))?;
            (rows.into_iter()).try_for_each(|row| seal_as_found(self.file, kind, row, found))
        };
        for run in &self.new_runs {
            seal_unsealed(
                Covered::Run,
                "id = ?1 AND verdict IS NOT NULL",
                (*run).into(),
            )?;
        }
        seal_unsealed(Covered::Event, "seq > ?1", self.before.event.into())?;
        seal_unsealed(Covered::Note, "seq > ?1", self.before.note.into())
    }
}
