//! Sends traces, after all other rows; the file checks each trace before it is sent, the server when it
//! arrives.

use std::collections::BTreeMap;

use sha2::{Digest as _, Sha256};

use super::batch::{ENOUGH_BYTES, MOST_ENTRIES};
use super::outcome::{Different, SyncOutcome};
use super::rows::Rows;
use super::tables;
use crate::backend::{Backend, Server, SqlError, SqlResult, values};
use crate::id::Id;

/// An outbox entry of a trace, which may have been pruned since.
pub(super) struct Entry {
    pub seq: i64,
    trace: i64,
    id: Option<Id>,
    /// The trace's id is invalid.
    is_unnamed: bool,
    sha256: Vec<u8>,
}

/// The next traces of the outbox, up to an entry.
pub(super) fn entries(file: &Backend, after: i64, until: i64) -> SqlResult<Vec<Entry>> {
    file.select(
        "SELECT o.seq, o.row, t.id, t.sha256 FROM outbox o LEFT JOIN trace t ON t.seq = o.row
         WHERE o.seq > ?1 AND o.seq <= ?2 AND o.what = 'trace' ORDER BY o.seq LIMIT ?3",
        &values![after, until, MOST_ENTRIES],
        |row| {
            let id: Option<&[u8]> = row.get(2)?;
            let named = id.and_then(|id| id.try_into().ok()).map(Id::from_bytes);
            Ok(Entry {
                seq: row.get(0)?,
                trace: row.get(1)?,
                id: named,
                is_unnamed: id.is_some() && named.is_none(),
                sha256: row.get::<Option<Vec<u8>>>(3)?.unwrap_or_default(),
            })
        },
    )
}

/// Channel lists of a file, and whether each matches its checksum.
type Lists = BTreeMap<i64, bool>;

/// Compared as bytes, since damaged text may not be UTF-8. The server would refuse the whole batch.
fn is_list_whole(file: &Backend, list: i64) -> SqlResult<bool> {
    let sql = "SELECT CAST(json AS BLOB), sha256 FROM channel_set WHERE seq = ?1";
    let whole = file.first(sql, &values![list], |row| {
        let (json, sha256): (&[u8], &[u8]) = (row.get(0)?, row.get(1)?);
        Ok(Sha256::digest(json)[..] == *sha256 && std::str::from_utf8(json).is_ok())
    })?;
    Ok(whole.unwrap_or(false))
}

/// The traces of one batch.
pub(super) struct Batch {
    traces: Rows,
    shown: Rows,
    channel_sets: Rows,
    pub through: i64,
    pub entries: u64,
    outcome: SyncOutcome,
}

impl Batch {
    /// Reads what the server does not have, up to the size of one batch.
    pub fn gather(file: &Backend, server: &Server, entries: &[Entry]) -> SqlResult<Self> {
        let known = known(server, entries)?;
        let mut batch = Self {
            traces: Rows::of(&tables::TRACES),
            shown: Rows::of(&tables::SHOWN),
            channel_sets: Rows::of(&tables::CHANNEL_SETS),
            through: 0,
            entries: 0,
            outcome: SyncOutcome::default(),
        };
        let mut lists = Lists::new();
        for entry in entries {
            batch.through = entry.seq;
            batch.entries += 1;
            let Some(id) = entry.id else {
                if entry.is_unnamed {
                    let what = format!("trace {} of the file", entry.trace);
                    let reason = "id has not 16 bytes".to_owned();
                    batch.outcome.refused.add(what, reason);
                }
                continue;
            };
            match known.get(&id) {
                Some(theirs) if *theirs != entry.sha256 => {
                    batch
                        .outcome
                        .different
                        .push(Different { what: "trace", id });
                    continue;
                }
                Some(_) => batch.outcome.already_there += 1,
                None => batch.read(file, entry, id, &mut lists)?,
            }
            // An occurrence may have been sent after its trace.
            let mark = batch.shown.mark();
            if let Err(SqlError::Value { reason, .. }) = batch.shown.read(file, entry.trace) {
                batch.shown.back_to(mark);
                batch
                    .outcome
                    .refused
                    .add(format!("what trace {id} shows"), reason);
            }
            if batch.traces.bytes >= ENOUGH_BYTES {
                break;
            }
        }
        for (list, is_whole) in lists {
            if is_whole {
                batch.channel_sets.read(file, list)?;
            }
        }
        Ok(batch)
    }

    fn read(&mut self, file: &Backend, entry: &Entry, id: Id, lists: &mut Lists) -> SqlResult<()> {
        let is_whole = "SELECT data, channel_set FROM trace WHERE seq = ?1";
        let list = file.first(is_whole, &values![entry.trace], |row| {
            let data: &[u8] = row.get(0)?;
            let list: i64 = row.get(1)?;
            Ok((Sha256::digest(data)[..] == entry.sha256).then_some(list))
        })?;
        let is_whole = match list.flatten() {
            Some(list) => match lists.get(&list) {
                Some(known) => *known,
                None => {
                    let is_whole = is_list_whole(file, list)?;
                    lists.insert(list, is_whole);
                    is_whole
                }
            },
            None => false,
        };
        if !is_whole {
            self.outcome.damaged_traces.push(id);
            return Ok(());
        }
        let mark = self.traces.mark();
        match self.traces.read(file, entry.trace) {
            Err(SqlError::Value { reason, .. }) => {
                self.traces.back_to(mark);
                self.outcome.refused.add(format!("trace {id}"), reason);
                Ok(())
            }
            read => read,
        }
    }

    /// Inserts everything on the server; runs in the caller's transaction.
    pub fn send(mut self, server: &Server, laptop: i64) -> SqlResult<SyncOutcome> {
        self.channel_sets.send(server, laptop)?;
        self.outcome.traces = self.traces.send(server, laptop)?;
        self.shown.send(server, laptop)?;
        let bytes = self.traces.bytes + self.shown.bytes + self.channel_sets.bytes;
        self.outcome.bytes = bytes as u64;
        Ok(self.outcome)
    }
}

/// Checksums of those traces that the server has.
fn known(server: &Server, entries: &[Entry]) -> SqlResult<BTreeMap<Id, Vec<u8>>> {
    let ids: Vec<&[u8]> = (entries.iter())
        .filter_map(|entry| entry.id.as_ref())
        .map(|id| &id.as_bytes()[..])
        .collect();
    let found = server.select_columns(
        "SELECT t.id, t.sha256 FROM unnest($1::bytea[]) AS x(id) JOIN trace t ON t.id = x.id",
        &[&ids],
    )?;
    let mut known = BTreeMap::new();
    for row in found {
        let (id, sha256): (&[u8], Vec<u8>) = (row.try_get(0)?, row.try_get(1)?);
        if let Ok(id) = id.try_into() {
            known.insert(Id::from_bytes(id), sha256);
        }
    }
    Ok(known)
}
