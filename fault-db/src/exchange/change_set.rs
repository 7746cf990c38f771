//! A change set: rows of the replicated tables that one store has and another may not have.

use std::collections::BTreeMap;

use super::rows::{Mark, Rows};
use super::tables::{COUNT, TABLES, TableId};
use crate::backend::Refusal;
use crate::backend::{Backend, SqlError, SqlResult, values};

/// A change set is applied when it has this size, bytes on the wire.
pub(super) const ENOUGH_BYTES: usize = 4 << 20;

/// Greatest number of runs, events, notes or traces in a change set.
pub(super) const MOST_ENTRIES: i64 = 500;

/// New rows by table.
pub(super) type Counts = [u64; COUNT];

pub(super) struct ChangeSet {
    rows: Vec<Rows>,
    /// Units, faults and channel lists in the set: table and row number in the file, with the index of the row in the
    /// set.
    included: BTreeMap<(usize, i64), usize>,
    /// Rows that were refused alone.
    pub refused: Vec<Refusal>,
}

impl ChangeSet {
    /// An empty change set; `for_server`: with the columns that the sender computes for a server.
    pub fn new(for_server: bool) -> Self {
        Self {
            rows: (TABLES.iter())
                .map(|table| Rows::of(table, for_server))
                .collect(),
            included: BTreeMap::new(),
            refused: Vec::new(),
        }
    }

    /// The rows by table, parents before children.
    pub fn tables(&self) -> impl Iterator<Item = &Rows> {
        self.rows.iter()
    }

    pub fn rows(&self, of: TableId) -> &Rows {
        &self.rows[of as usize]
    }

    /// The rows of a table, for adding rows that do not come from a file.
    pub fn rows_mut(&mut self, of: TableId) -> &mut Rows {
        &mut self.rows[of as usize]
    }

    pub fn bytes(&self) -> usize {
        self.rows.iter().map(|rows| rows.bytes).sum()
    }

    pub fn mark(&self) -> Vec<Mark> {
        self.rows.iter().map(Rows::mark).collect()
    }

    /// Removes the rows that were added since the marks.
    pub fn back_to(&mut self, marks: &[Mark]) {
        for (rows, mark) in self.rows.iter_mut().zip(marks) {
            rows.back_to(*mark);
        }
        let rows = &self.rows;
        (self.included).retain(|(of, _), place| *place < rows[*of].count());
    }

    /// Reads rows that belong together: keeps all of them, or none and returns why they are refused.
    pub fn whole(
        &mut self,
        read: impl FnOnce(&mut Self) -> SqlResult<()>,
    ) -> SqlResult<Option<Refusal>> {
        let marks = self.mark();
        match read(self) {
            Ok(()) => Ok(None),
            Err(SqlError::Refused(refusal)) => {
                self.back_to(&marks);
                Ok(Some(*refusal))
            }
            Err(other) => Err(other),
        }
    }

    /// Reads a run with its unit, scripts, steps, measurements, occurrences and their faults.
    pub fn run(&mut self, file: &Backend, run: i64) -> SqlResult<()> {
        self.read(file, TableId::Run, run)?;
        // Parents are read first, so that a refusal names the parent.
        let parents = |sql| file.select(sql, &values![run], |row| row.get::<i64>(0));
        for unit in parents("SELECT unit FROM run WHERE seq = ?1")? {
            self.include(file, TableId::Unit, unit)?;
        }
        for fault in parents("SELECT DISTINCT fault FROM fault_occurrence WHERE run = ?1")? {
            self.fault(file, fault)?;
        }
        for of in [
            TableId::Script,
            TableId::Step,
            TableId::Measurement,
            TableId::Occurrence,
        ] {
            self.read(file, of, run)?;
        }
        Ok(())
    }

    /// Reads an event with its fault.
    pub fn event(&mut self, file: &Backend, event: i64) -> SqlResult<()> {
        let before = self.rows(TableId::Event).count();
        self.read(file, TableId::Event, event)?;
        let fault = "SELECT fault FROM fault_event WHERE seq = ?1";
        match file.first(fault, &values![event], |row| row.get(0))? {
            Some(fault) if self.rows(TableId::Event).count() > before => self.fault(file, fault),
            _ => Ok(()),
        }
    }

    /// Reads a trace with its channel list, and the occurrences that it shows.
    pub fn trace(&mut self, file: &Backend, trace: i64) -> SqlResult<()> {
        let before = self.rows(TableId::Trace).count();
        self.read(file, TableId::Trace, trace)?;
        if self.rows(TableId::Trace).count() > before {
            let list = "SELECT channel_set FROM trace WHERE seq = ?1";
            if let Some(list) = file.first(list, &values![trace], |row| row.get(0))? {
                self.include(file, TableId::ChannelSet, list)?;
            }
        }
        self.read(file, TableId::Shown, trace)
    }

    /// Reads the rows of a table that belong to the run, fault or trace with row number `seq`, or the row itself.
    pub fn read(&mut self, file: &Backend, of: TableId, seq: i64) -> SqlResult<()> {
        let (rows, refused) = (&mut self.rows[of as usize], &mut self.refused);
        let sql = rows.sql.clone();
        file.each(&sql, &values![seq], |row| match rows.take(row) {
            Err(SqlError::Refused(refusal)) if rows.table.is_refused_alone => {
                refused.push(*refusal);
                Ok(())
            }
            taken => taken,
        })
    }

    /// Reads a fault with its aliases and its unit.
    pub fn fault(&mut self, file: &Backend, fault: i64) -> SqlResult<()> {
        if !self.include(file, TableId::Fault, fault)? {
            return Ok(());
        }
        self.read(file, TableId::Alias, fault)?;
        let unit = "SELECT unit FROM fault WHERE seq = ?1";
        match file.first(unit, &values![fault], |row| row.get(0))? {
            Some(unit) => self.include(file, TableId::Unit, unit).map(drop),
            None => Ok(()),
        }
    }

    /// Reads a row that others refer to, unless it is included already; whether it was read.
    fn include(&mut self, file: &Backend, of: TableId, seq: i64) -> SqlResult<bool> {
        let (key, place) = ((of as usize, seq), self.rows(of).count());
        if self.included.contains_key(&key) {
            return Ok(false);
        }
        self.read(file, of, seq)?;
        if self.rows(of).count() == place {
            let reason = "it is not there, or what it is of is not".to_owned();
            return Err(Refusal::of(of.table().name, seq.to_string(), reason));
        }
        self.included.insert(key, place);
        Ok(true)
    }
}
