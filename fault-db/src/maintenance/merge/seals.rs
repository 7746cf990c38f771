//! Merges the chains of seals unchanged; whether a seal fits its row and its predecessor is checked by
//! [`Store::check`](crate::Store::check).

use rusqlite::{OptionalExtension, params};

use super::Merge;
use crate::backend::SqlResult;
use crate::id::Id;
use crate::seal::events_and_notes::{
    event_digest, note_digest, seal_event_as_found, seal_note_as_found,
};
use crate::seal::{BY_IMPORT, chained, seal_run_as_found};

/// An entry of their chains.
struct Theirs {
    origin: Id,
    ordinal: i64,
    what: String,
    id: Id,
    covers: i64,
    payload: String,
    digest: Vec<u8>,
    hash: Vec<u8>,
}

/// The last event and note here before the merge.
#[derive(Clone, Copy)]
pub(super) struct Before {
    event: i64,
    note: i64,
}

impl Merge<'_> {
    pub(super) fn before(&self) -> rusqlite::Result<Before> {
        let last = "SELECT coalesce((SELECT max(seq) FROM fault_event), 0),
            coalesce((SELECT max(seq) FROM run_note), 0)";
        self.ours.query_row(last, [], |row| {
            Ok(Before {
                event: row.get(0)?,
                note: row.get(1)?,
            })
        })
    }

    /// Adds their entries. Where a copy of the file forked, ours stay and theirs are left out from there on,
    /// because they would not fit. The same holds from an entry on whose content differs from what is stored
    /// here.
    pub(super) fn seals(&self, before_merge: Before) -> SqlResult<()> {
        let mut select = self.theirs.prepare(
            "SELECT origin, ordinal, what, id, covers, says, digest, hash FROM seal ORDER BY origin, ordinal",
        )?;
        let mut known = self
            .ours
            .prepare("SELECT hash FROM seal WHERE origin = ?1 AND ordinal = ?2")?;
        let mut insert = self.ours.prepare(
            "INSERT INTO seal(origin, ordinal, what, id, covers, says, digest, hash)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
        )?;
        let mut rows = select.query([])?;
        let mut last: Option<(Id, Vec<u8>)> = None;
        let mut parted = false;
        while let Some(row) = rows.next()? {
            let theirs = Theirs {
                origin: row.get(0)?,
                ordinal: row.get(1)?,
                what: row.get(2)?,
                id: row.get(3)?,
                covers: row.get(4)?,
                payload: row.get(5)?,
                digest: row.get(6)?,
                hash: row.get(7)?,
            };
            let before = last.filter(|(origin, _)| *origin == theirs.origin);
            parted &= before.is_some();
            let place = params![theirs.origin, theirs.ordinal];
            let ours: Option<Vec<u8>> = known.query_row(place, |row| row.get(0)).optional()?;
            match ours {
                Some(ours) => {
                    let before = before.as_ref().map(|(_, hash)| &hash[..]);
                    let fits = chained(before, &theirs.digest) == theirs.hash[..];
                    parted = ours != theirs.hash && (fits || parted);
                }
                None if parted || self.says_otherwise(&theirs, before_merge)? => parted = true,
                None => {
                    let Theirs {
                        origin,
                        ordinal,
                        what,
                        id,
                        covers,
                        payload,
                        digest,
                        hash,
                    } = &theirs;
                    insert.execute(params![
                        origin, ordinal, what, id, covers, payload, digest, hash
                    ])?;
                }
            }
            last = Some((theirs.origin, theirs.hash));
        }
        Ok(())
    }

    /// Whether an entry covers something else than what was stored here before the merge.
    fn says_otherwise(&self, theirs: &Theirs, before: Before) -> SqlResult<bool> {
        let seq = |sql: &str, last: i64| -> rusqlite::Result<Option<i64>> {
            let mut find = self.ours.prepare_cached(sql)?;
            find.query_row(params![theirs.id, last], |row| row.get(0))
                .optional()
        };
        let digest = match &theirs.what[..] {
            "run" => {
                let run = seq("SELECT seq FROM run WHERE id = ?1 AND ?2 = 0", 0)?;
                return Ok(run.is_some_and(|run| self.different_runs.contains(&run)));
            }
            "event" => seq(
                "SELECT seq FROM fault_event WHERE id = ?1 AND seq <= ?2",
                before.event,
            )?
            .map(|event| event_digest(self.backend, event, &theirs.payload)),
            "note" => seq(
                "SELECT seq FROM run_note WHERE id = ?1 AND seq <= ?2",
                before.note,
            )?
            .map(|note| note_digest(self.backend, note, &theirs.payload)),
            _ => None,
        };
        Ok(match digest {
            Some(ours) => ours? != theirs.digest[..],
            None => false,
        })
    }

    /// Seals, as found, the runs, events and notes that came without a fitting seal.
    pub(super) fn seal_the_rest(&self, before: Before) -> SqlResult<()> {
        let unsealed = "SELECT 1 FROM run WHERE seq = ?1 AND verdict IS NOT NULL
            AND NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = run.id AND s.what = 'run')";
        for run in &self.fresh_runs {
            if self.ours.prepare_cached(unsealed)?.exists([run])? {
                seal_run_as_found(self.backend, *run, BY_IMPORT)?;
            }
        }
        for event in self.unsealed(
            "SELECT seq FROM fault_event e WHERE seq > ?1
                AND NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = e.id AND s.what = 'event') ORDER BY seq",
            before.event,
        )? {
            seal_event_as_found(self.backend, event, BY_IMPORT)?;
        }
        for note in self.unsealed(
            "SELECT seq FROM run_note n WHERE seq > ?1
                AND NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = n.id AND s.what = 'note') ORDER BY seq",
            before.note,
        )? {
            seal_note_as_found(self.backend, note, BY_IMPORT)?;
        }
        Ok(())
    }

    fn unsealed(&self, sql: &str, after: i64) -> rusqlite::Result<Vec<i64>> {
        let mut select = self.ours.prepare(sql)?;
        select.query_map([after], |row| row.get(0))?.collect()
    }
}
