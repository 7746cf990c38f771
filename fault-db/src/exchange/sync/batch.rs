//! One batch of outbox entries: read from the file, compared with what the server has, and applied.

use std::collections::{BTreeMap, BTreeSet};

use super::outcome::{Difference, SyncOutcome};
use crate::backend::Refusal;
use crate::backend::{Backend, Server, SqlResult, from_row, values};
use crate::exchange::change_set::{ChangeSet, Counts, ENOUGH_BYTES, MOST_ENTRIES};
use crate::exchange::checksum::DAMAGED;
use crate::exchange::domain::shown_id;
use crate::exchange::tables::TableId;
use crate::id::Id;

/// An outbox entry: a run, event, note or trace.
pub(super) struct Entry {
    pub seq: i64,
    of: TableId,
    row: i64,
    /// Id of the row; `None` if the row was pruned since.
    id: Option<Vec<u8>>,
    /// Digests of the seals of a run; checksum of a trace.
    digests: BTreeSet<Vec<u8>>,
}

/// The next outbox entries after `after` and up to `until`: traces, or all others.
pub(super) fn entries(
    file: &Backend,
    traces: bool,
    after: i64,
    until: i64,
) -> SqlResult<Vec<Entry>> {
    let mut entries = file.select(
        "SELECT o.seq, o.what, o.row, CASE o.what WHEN 'run' THEN (SELECT id FROM run WHERE seq = o.row)
                WHEN 'event' THEN (SELECT id FROM fault_event WHERE seq = o.row)
                WHEN 'note' THEN (SELECT id FROM run_note WHERE seq = o.row)
                ELSE (SELECT id FROM trace WHERE seq = o.row) END,
            CASE o.what WHEN 'trace' THEN (SELECT sha256 FROM trace WHERE seq = o.row) END
         FROM outbox o
         WHERE o.seq > ?1 AND o.seq <= ?2 AND (o.what = 'trace') = ?3 ORDER BY o.seq LIMIT ?4",
        &values![after, until, traces, MOST_ENTRIES],
        |row| {
            Ok(from_row!(row => Entry:
                seq, _, row, id;
                of: match row.get::<&str>(1)? {
                    "run" => TableId::Run,
                    "event" => TableId::Event,
                    "note" => TableId::Note,
                    _ => TableId::Trace,
                },
                digests: row.get::<Option<Vec<u8>>>(4)?.into_iter().collect()
            ))
        },
    )?;
    for entry in entries.iter_mut().filter(|entry| entry.of == TableId::Run) {
        let sealed = "SELECT digest FROM seal WHERE id = ?1 AND what = 'run'";
        let id = entry.id.as_deref().unwrap_or_default();
        (entry.digests).extend(file.select(sealed, &values![id], |row| row.get::<Vec<u8>>(0))?);
    }
    Ok(entries)
}

pub(super) fn last(file: &Backend) -> SqlResult<i64> {
    let last = "SELECT coalesce(max(seq), 0) FROM outbox";
    Ok(file.first(last, &[], |row| row.get(0))?.unwrap_or_default())
}

/// How a run or trace on the server compares with the file's.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ServerCopy {
    /// The server has the whole of it.
    Whole,
    /// The server may have a part of it.
    Perhaps,
    /// The server has another one with the same id.
    Difference,
}

pub(super) struct Batch {
    pub set: ChangeSet,
    /// The last entry included.
    pub through: i64,
    pub entries: u64,
    outcome: SyncOutcome,
}

impl Batch {
    /// Reads the rows of these entries that the server does not have, up to the size of one batch.
    pub fn gather(file: &Backend, server: &Server, entries: &[Entry]) -> SqlResult<Self> {
        let known = known(server, entries)?;
        let mut batch = Self {
            set: ChangeSet::new(true),
            through: 0,
            entries: 0,
            outcome: SyncOutcome::default(),
        };
        for entry in entries {
            batch.through = entry.seq;
            batch.entries += 1;
            if let Some(id) = &entry.id {
                let known = known.get(id).copied().unwrap_or(ServerCopy::Perhaps);
                batch.take(file, entry, id, known)?;
            }
            if batch.set.bytes() >= ENOUGH_BYTES {
                break;
            }
        }
        Ok(batch)
    }

    fn take(
        &mut self,
        file: &Backend,
        entry: &Entry,
        id: &[u8],
        known: ServerCopy,
    ) -> SqlResult<()> {
        let (set, row) = (&mut self.set, entry.row);
        let refused = match (known, entry.of) {
            (ServerCopy::Difference, of) => {
                if let Ok(id) = id.try_into().map(Id::from_bytes) {
                    let what = of.table().name;
                    self.outcome.different.push(Difference { what, id });
                }
                None
            }
            (ServerCopy::Whole, of) => {
                self.outcome.already_there += 1;
                // An occurrence may have been sent after its trace.
                match of {
                    TableId::Trace => set.whole(|set| set.read(file, TableId::Shown, row))?,
                    _ => None,
                }
            }
            (ServerCopy::Perhaps, TableId::Run) => set.whole(|set| {
                set.run(file, row)?;
                set.read(file, TableId::Recording, row)?;
                let notes = "SELECT seq FROM run_note WHERE run = ?1 ORDER BY seq";
                let notes = file.select(notes, &values![row], |row| row.get(0))?;
                (notes.into_iter()).try_for_each(|note| set.read(file, TableId::Note, note))
            })?,
            (ServerCopy::Perhaps, TableId::Event) => set.whole(|set| set.event(file, row))?,
            (ServerCopy::Perhaps, TableId::Trace) => set.whole(|set| set.trace(file, row))?,
            (ServerCopy::Perhaps, of) => set.whole(|set| set.read(file, of, row))?,
        };
        let alone = std::mem::take(&mut self.set.refused);
        for refusal in alone.into_iter().chain(refused) {
            self.refuse(entry, id, refusal);
        }
        Ok(())
    }

    fn refuse(&mut self, entry: &Entry, id: &[u8], refusal: Refusal) {
        let Refusal { table, reason, .. } = &refusal;
        let is_damaged = *table == "channel_set" || reason == DAMAGED;
        if let (true, Ok(id)) = (is_damaged, id.try_into()) {
            self.outcome.damaged_traces.push(Id::from_bytes(id));
            return;
        }
        let own = entry.of.table().name;
        let word = own.trim_start_matches("fault_").trim_start_matches("run_");
        let what = format!("{word} {}", shown_id(id));
        let (what, reason) = match *table {
            table if table == own => (what, refusal.reason),
            "run_note" => (format!("note {}", refusal.shown), refusal.reason),
            "recording" | "fault_alias" => (refusal.row(), refusal.reason),
            _ => (what, format!("{}: {reason}", refusal.row())),
        };
        self.outcome.refused.add(what, reason);
    }

    /// The outcome of the batch; `new` has the numbers of rows that were new to the server.
    pub fn outcome(mut self, new: &Counts) -> SyncOutcome {
        let new = |of: TableId| new[of as usize];
        for of in [TableId::Run, TableId::Event] {
            let sent = self.set.rows(of).count() as u64;
            self.outcome.already_there += sent.saturating_sub(new(of));
        }
        SyncOutcome {
            runs: new(TableId::Run),
            occurrences: new(TableId::Occurrence),
            events: new(TableId::Event),
            notes: new(TableId::Note),
            traces: new(TableId::Trace),
            bytes: self.set.bytes() as u64,
            ..self.outcome
        }
    }
}

/// How the server has the runs and traces of these entries. A sealed run was sent complete.
fn known(server: &Server, entries: &[Entry]) -> SqlResult<BTreeMap<Vec<u8>, ServerCopy>> {
    let ours: BTreeMap<&[u8], &BTreeSet<Vec<u8>>> = (entries.iter())
        .filter(|entry| matches!(entry.of, TableId::Run | TableId::Trace))
        .filter_map(|entry| Some((entry.id.as_deref()?, &entry.digests)))
        .collect();
    let mut known = BTreeMap::new();
    if ours.is_empty() {
        return Ok(known);
    }
    let ids: Vec<&[u8]> = ours.keys().copied().collect();
    let found = server.select_columns(
        "SELECT r.id, s.digest FROM unnest($1::bytea[]) AS x(id)
            JOIN run r ON r.id = x.id LEFT JOIN seal s ON s.id = r.id AND s.what = 'run'
         UNION ALL SELECT t.id, t.sha256 FROM unnest($1::bytea[]) AS x(id) JOIN trace t ON t.id = x.id",
        &[&ids],
    )?;
    for row in found {
        let (id, theirs): (Vec<u8>, Option<Vec<u8>>) = (row.try_get(0)?, row.try_get(1)?);
        let state = match (ours.get(&id[..]), theirs) {
            (Some(ours), Some(theirs)) if ours.contains(&theirs) => ServerCopy::Whole,
            (Some(ours), Some(_)) if !ours.is_empty() => ServerCopy::Difference,
            _ => ServerCopy::Perhaps,
        };
        // Files that shared a run before there were seals have each sealed it.
        let best = known.entry(id).or_insert(state);
        if state == ServerCopy::Whole {
            *best = state;
        }
    }
    Ok(known)
}
