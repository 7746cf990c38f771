//! One batch of outbox entries with all rows that belong to them, read from the file and inserted into the
//! server in one transaction.

use std::collections::{BTreeMap, BTreeSet};

use super::cursors::Laptop;
use super::outcome::{Different, SyncOutcome};
use super::rows::Rows;
use super::tables;
use crate::backend::{Backend, Field, Server, SqlError, SqlResult, values};
use crate::domain::{Refusals, shown_id};
use crate::event_graph::{merge_duplicates_on_server, recompute_faults};
use crate::id::Id;
use crate::recurrence::{HighWaterMark, reopen_recurred_on_server};
use crate::server::derived_columns;

/// Entries of a batch at most.
pub(super) const MOST_ENTRIES: i64 = 500;

/// A batch is closed at this size, bytes on the wire.
pub(super) const ENOUGH_BYTES: usize = 4 << 20;

/// An outbox entry; for a run its id and the digests of its seals.
pub(super) struct Entry {
    pub seq: i64,
    pub what: What,
    pub row: i64,
    run: Option<(Id, BTreeSet<Vec<u8>>)>,
    /// The run's id is invalid.
    is_unnamed: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum What {
    Run,
    Event,
    Note,
}

/// The next outbox entries, except traces.
pub(super) fn entries(file: &Backend, after: i64) -> SqlResult<Vec<Entry>> {
    let mut entries = file.select(
        "SELECT o.seq, o.what, o.row, r.id FROM outbox o
            LEFT JOIN run r ON o.what = 'run' AND r.seq = o.row
         WHERE o.seq > ?1 AND o.what <> 'trace' ORDER BY o.seq LIMIT ?2",
        &values![after, MOST_ENTRIES],
        |row| {
            let what = match row.get::<&str>(1)? {
                "run" => What::Run,
                "event" => What::Event,
                _ => What::Note,
            };
            let id: Option<&[u8]> = row.get(3)?;
            let named = id.and_then(|id| id.try_into().ok()).map(Id::from_bytes);
            let is_unnamed = id.is_some() && named.is_none();
            Ok(Entry {
                seq: row.get(0)?,
                what,
                row: row.get(2)?,
                run: named.map(|id| (id, BTreeSet::new())),
                is_unnamed,
            })
        },
    )?;
    for (id, digests) in entries.iter_mut().filter_map(|entry| entry.run.as_mut()) {
        let sealed = "SELECT digest FROM seal WHERE id = ?1 AND what = 'run'";
        digests.extend(file.select(sealed, &values![*id], |row| row.get::<Vec<u8>>(0))?);
    }
    Ok(entries)
}

/// The last outbox entry.
pub(super) fn last(file: &Backend) -> SqlResult<i64> {
    let last = "SELECT coalesce(max(seq), 0) FROM outbox";
    Ok(file.first(last, &[], |row| row.get(0))?.unwrap_or_default())
}

/// What the server has of a run.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Known {
    /// The same run, complete.
    Whole,
    /// Part of it, or unknown.
    Perhaps,
    /// A different run with the same id.
    Different,
}

/// Rows of one batch.
pub(super) struct Batch<'a> {
    file: &'a Backend,
    runs: Rows,
    of_runs: [Rows; 5],
    events: Rows,
    notes: Rows,
    unit_numbers: BTreeSet<i64>,
    fault_numbers: BTreeSet<i64>,
    /// The last entry included.
    pub through: i64,
    pub entries: u64,
    already_there: u64,
    different: Vec<Different>,
    refused: Refusals,
}

impl<'a> Batch<'a> {
    /// Reads the rows of these entries, up to the size of one batch.
    pub fn gather(file: &'a Backend, server: &Server, entries: &[Entry]) -> SqlResult<Self> {
        let known = known_runs(server, entries)?;
        let mut batch = Self {
            file,
            runs: Rows::of(&tables::RUNS),
            of_runs: [
                Rows::of(&tables::SCRIPTS),
                Rows::of(&tables::STEPS),
                Rows::of(&tables::MEASUREMENTS),
                Rows::of(&tables::RECORDINGS),
                Rows::of(&tables::OCCURRENCES),
            ],
            events: Rows::of(&tables::EVENTS),
            notes: Rows::of(&tables::NOTES),
            unit_numbers: BTreeSet::new(),
            fault_numbers: BTreeSet::new(),
            through: 0,
            entries: 0,
            already_there: 0,
            different: Vec::new(),
            refused: Refusals::default(),
        };
        for entry in entries {
            batch.gather_or_reject(entry, &known)?;
            batch.through = entry.seq;
            batch.entries += 1;
            if batch.bytes() >= ENOUGH_BYTES {
                break;
            }
        }
        Ok(batch)
    }

    /// Adds an entry with all rows that belong to it, or, if one is outside its domain, none of them.
    fn gather_or_reject(&mut self, entry: &Entry, known: &BTreeMap<Id, Known>) -> SqlResult<()> {
        let marks: Vec<_> = self.rows().map(|rows| rows.mark()).collect();
        let identities = (self.unit_numbers.clone(), self.fault_numbers.clone());
        let taken = self
            .take(entry, known)
            .and_then(|()| self.check_identities(&identities));
        let Err(SqlError::Value { reason, .. }) = taken else {
            return taken;
        };
        for (rows, mark) in self.rows().zip(marks) {
            rows.back_to(mark);
        }
        (self.unit_numbers, self.fault_numbers) = identities;
        self.refuse(entry.what, entry.row, reason)
    }

    /// Records a refused row of the file.
    fn refuse(&mut self, what: What, row: i64, reason: String) -> SqlResult<()> {
        let (word, table) = match what {
            What::Run => ("run", "run"),
            What::Event => ("event", "fault_event"),
            What::Note => ("note", "run_note"),
        };
        let id = format!("SELECT id FROM {table} WHERE seq = ?1");
        let id = (self.file).first(&id, &values![row], |row| row.get::<Vec<u8>>(0))?;
        let shown = shown_id(&id.unwrap_or_default());
        self.refused.add(format!("{word} {shown}"), reason);
        Ok(())
    }

    /// The row sets that are filled entry by entry.
    fn rows(&mut self) -> impl Iterator<Item = &mut Rows> {
        let rest = [&mut self.runs, &mut self.events, &mut self.notes];
        rest.into_iter().chain(&mut self.of_runs)
    }

    /// Checks the units and faults that an entry refers to.
    fn check_identities(&self, (units, faults): &(BTreeSet<i64>, BTreeSet<i64>)) -> SqlResult<()> {
        for unit in self.unit_numbers.difference(units) {
            Rows::of(&tables::UNITS).read(self.file, *unit)?;
        }
        for fault in self.fault_numbers.difference(faults) {
            Rows::of(&tables::FAULTS).read(self.file, *fault)?;
            Rows::of(&tables::OTHER_IDS).read(self.file, *fault)?;
            let of = "SELECT unit FROM fault WHERE seq = ?1";
            let units = (self.file).select(of, &values![*fault], |row| row.get::<i64>(0))?;
            for unit in units {
                Rows::of(&tables::UNITS).read(self.file, unit)?;
            }
        }
        Ok(())
    }

    fn take(&mut self, entry: &Entry, known: &BTreeMap<Id, Known>) -> SqlResult<()> {
        match (entry.what, &entry.run) {
            (What::Run, None) if entry.is_unnamed => Err(SqlError::Value {
                column: 0,
                reason: "id has not 16 bytes".to_owned(),
            }),
            (What::Run, None) => Ok(()),
            (What::Run, Some((id, _))) => match known.get(id) {
                Some(Known::Whole) => {
                    self.already_there += 1;
                    Ok(())
                }
                Some(Known::Different) => {
                    self.different.push(Different {
                        what: "run",
                        id: *id,
                    });
                    Ok(())
                }
                Some(Known::Perhaps) | None => self.run(entry.row),
            },
            (What::Event, _) => self.event(entry.row),
            (What::Note, _) => self.note(entry.row),
        }
    }

    fn run(&mut self, run: i64) -> SqlResult<()> {
        self.runs.read(self.file, run)?;
        for rows in &mut self.of_runs {
            rows.read(self.file, run)?;
        }
        let of_run = |sql| {
            self.file
                .select(sql, &values![run], |row| row.get::<i64>(0))
        };
        let units = of_run("SELECT unit FROM run WHERE seq = ?1")?;
        let faults = of_run("SELECT DISTINCT fault FROM fault_occurrence WHERE run = ?1")?;
        let notes = of_run("SELECT seq FROM run_note WHERE run = ?1 ORDER BY seq")?;
        self.unit_numbers.extend(units);
        self.fault_numbers.extend(faults);
        notes.into_iter().try_for_each(|note| {
            // Notes are not covered by the run's seal, so one can be refused alone.
            let mark = self.notes.mark();
            match self.note(note) {
                Err(SqlError::Value { reason, .. }) => {
                    self.notes.back_to(mark);
                    self.refuse(What::Note, note, reason)
                }
                taken => taken,
            }
        })
    }

    fn event(&mut self, event: i64) -> SqlResult<()> {
        let events = &mut self.events;
        self.file
            .each(tables::EVENTS.read, &values![event], |row| {
                let (kind, body) = (row.get(2)?, row.get(5)?);
                let part = derived_columns::part(kind, body);
                let words = derived_columns::event_words(kind, body);
                events.take(row, &[derived_field(&part), derived_field(&words)])
            })?;
        let of = "SELECT fault FROM fault_event WHERE seq = ?1";
        let fault = self
            .file
            .select(of, &values![event], |row| row.get::<i64>(0))?;
        self.fault_numbers.extend(fault);
        Ok(())
    }

    fn note(&mut self, note: i64) -> SqlResult<()> {
        let notes = &mut self.notes;
        self.file.each(tables::NOTES.read, &values![note], |row| {
            let words = derived_columns::note_words(row.get(4)?);
            notes.take(row, &[Field::Text(&words)])
        })
    }

    fn bytes(&self) -> usize {
        let of_runs: usize = self.of_runs.iter().map(|rows| rows.bytes).sum();
        let rest = [&self.runs, &self.events, &self.notes];
        of_runs + rest.iter().map(|rows| rows.bytes).sum::<usize>()
    }

    /// Inserts all rows on the server, parents before children; runs in the caller's transaction.
    pub fn send(
        mut self,
        backend: &Backend,
        server: &Server,
        known: &Laptop,
    ) -> SqlResult<SyncOutcome> {
        let laptop = known.seq;
        let mark = HighWaterMark::of(backend)?;
        let (units, faults, other_ids) = self.identities()?;
        units.send(server, laptop)?;
        let runs = self.runs.send(server, laptop)?;
        other_ids.send(server, laptop)?;
        faults.send(server, laptop)?;
        other_ids.send_by(server, laptop, tables::OTHER_IDS_TOO)?;
        let mut occurrences = 0;
        for rows in &self.of_runs {
            // Occurrences are the last.
            occurrences = rows.send(server, laptop)?;
        }
        let events = self.events.send(server, laptop)?;
        let notes = self.notes.send(server, laptop)?;
        let settled = server_faults(&faults, server, laptop)?;
        recompute_faults(server, &settled)?;
        merge_duplicates_on_server(server, &settled)?;
        // A reopened fault may now be merged with another one, which brings more occurrences or resolutions.
        loop {
            let server_faults = server_faults(&faults, server, laptop)?;
            let again = reopen_recurred_on_server(backend, server, &server_faults, mark)?;
            if again.is_empty() {
                break;
            }
            recompute_faults(server, &again)?;
            merge_duplicates_on_server(server, &again)?;
        }
        let there = |rows: &Rows, new: u64| rows.count as u64 - new.min(rows.count as u64);
        Ok(SyncOutcome {
            runs,
            occurrences,
            events,
            notes,
            already_there: self.already_there
                + there(&self.runs, runs)
                + there(&self.events, events),
            bytes: (self.bytes() + units.bytes + faults.bytes) as u64,
            different: self.different,
            refused: self.refused,
            ..SyncOutcome::default()
        })
    }

    /// The units and faults that the rows refer to.
    fn identities(&mut self) -> SqlResult<(Rows, Rows, Rows)> {
        let mut faults = Rows::of(&tables::FAULTS);
        let mut other_ids = Rows::of(&tables::OTHER_IDS);
        for fault in &self.fault_numbers {
            faults.read(self.file, *fault)?;
            other_ids.read(self.file, *fault)?;
            let of = "SELECT unit FROM fault WHERE seq = ?1";
            let unit = self
                .file
                .select(of, &values![*fault], |row| row.get::<i64>(0))?;
            self.unit_numbers.extend(unit);
        }
        let mut units = Rows::of(&tables::UNITS);
        for unit in &self.unit_numbers {
            units.read(self.file, *unit)?;
        }
        Ok((units, faults, other_ids))
    }
}

fn derived_field(text: &Option<String>) -> Field<'_> {
    text.as_deref().map_or(Field::Null, Field::Text)
}

/// The server's current row numbers of the faults sent, as two may have been merged.
fn server_faults(faults: &Rows, server: &Server, laptop: i64) -> SqlResult<Vec<i64>> {
    let found = faults.ask(server, laptop, SERVER_FAULTS)?;
    let numbers: Result<_, _> = found.iter().map(|row| row.try_get(0)).collect();
    Ok(numbers?)
}

const SERVER_FAULTS: &str = "SELECT DISTINCT k.fault FROM {rows}
    JOIN laptop_fault k ON k.laptop = {laptop} AND k.id = x.id ORDER BY k.fault";

/// What the server has of the entries' runs. A sealed run was sent complete.
fn known_runs(server: &Server, entries: &[Entry]) -> SqlResult<BTreeMap<Id, Known>> {
    let ours: BTreeMap<Id, &BTreeSet<Vec<u8>>> = (entries.iter())
        .filter_map(|entry| entry.run.as_ref())
        .map(|(id, digests)| (*id, digests))
        .collect();
    if ours.is_empty() {
        return Ok(BTreeMap::new());
    }
    let ids: Vec<&[u8]> = ours.keys().map(|id| &id.as_bytes()[..]).collect();
    let found = server.select_columns(
        "SELECT r.id, s.digest FROM unnest($1::bytea[]) AS x(id)
         JOIN run r ON r.id = x.id LEFT JOIN seal s ON s.id = r.id AND s.what = 'run'",
        &[&ids],
    )?;
    let mut known = BTreeMap::new();
    for row in found {
        let (id, theirs): (&[u8], Option<Vec<u8>>) = (row.try_get(0)?, row.try_get(1)?);
        let Ok(id) = id.try_into().map(Id::from_bytes) else {
            continue;
        };
        let state = match (ours.get(&id), theirs) {
            (Some(ours), Some(theirs)) if ours.contains(&theirs) => Known::Whole,
            (Some(ours), Some(_)) if !ours.is_empty() => Known::Different,
            _ => Known::Perhaps,
        };
        // Files that shared a run before there were seals have each sealed it.
        let best = known.entry(id).or_insert(state);
        if state == Known::Whole {
            *best = state;
        }
    }
    Ok(known)
}
