//! Merges the chains of seals unchanged; [`Store::check`](crate::Store::check) checks whether a seal matches its row
//! and the seal before it.

use rusqlite::params_from_iter;

use super::Merge;
use crate::backend::{SqlError, SqlResult, values};
use crate::exchange::rows::Rows;
use crate::exchange::tables::TableId;
use crate::exchange::to_file::LastEntries;
use crate::id::Id;
use crate::seal::chained;
use crate::seal::covered::Covered;

/// The last entry that was read of a chain of the other file.
struct Last {
    origin: Id,
    hash: Vec<u8>,
    /// Whether the rest of the chain is left out.
    parted: bool,
}

impl Merge<'_> {
    /// Adds the entries of the other file's chains. If a copy of the file forked, the entries here stay, and the other
    /// file's entries after the fork are left out, because they would not fit. So are all entries from one on whose row
    /// was refused, or whose content differs from the row here.
    pub(super) fn seals(&mut self) -> SqlResult<()> {
        let mut insert = self
            .conn
            .prepare(&TableId::Seal.table().insert_into_file())?;
        let mut rows = Rows::of(TableId::Seal.table(), false);
        let empty = rows.mark();
        let mut last: Option<Last> = None;
        let all = TableId::Seal
            .table()
            .read_where("true ORDER BY origin, ordinal");
        self.theirs.each(&all, &[], |row| {
            rows.back_to(empty);
            if let Err(error) = rows.take(row) {
                let SqlError::Refused(refusal) = error else {
                    return Err(error);
                };
                self.counts.refused.add(refusal.row(), refusal.reason);
                let refused = row.get(0).map(|origin| Last {
                    origin,
                    hash: Vec::new(),
                    parted: true,
                });
                last = refused.ok().or(last.take());
                return Ok(());
            }
            let (origin, ordinal): (Id, i64) = (row.get(0)?, row.get(1)?);
            let (digest, hash): (&[u8], Vec<u8>) = (row.get(5)?, row.get(6)?);
            let before = last.take().filter(|last| last.origin == origin);
            let mut parted = before.as_ref().is_some_and(|before| before.parted);
            let known = "SELECT hash FROM seal WHERE origin = ?1 AND ordinal = ?2";
            let known = self.ours.first(known, &values![origin, ordinal], |row| {
                row.get::<Vec<u8>>(0)
            })?;
            match known {
                Some(ours) => {
                    let before = before.as_ref().map(|before| &before.hash[..]);
                    parted = ours != hash && (parted || chained(before, digest) == hash[..]);
                }
                None => {
                    let id = row.get::<Id>(3)?;
                    parted |= self.left_out.contains(&id.as_bytes()[..])
                        || self.is_different(row.get(2)?, id, row.get(4)?, digest)?;
                    if !parted {
                        for row in rows.iter() {
                            insert.execute(params_from_iter(row))?;
                        }
                    }
                }
            }
            last = Some(Last {
                origin,
                hash,
                parted,
            });
            Ok(())
        })
    }

    /// Whether an entry has another digest than the row that was stored here before the merge.
    fn is_different(&self, what: &str, id: Id, payload: &str, digest: &[u8]) -> SqlResult<bool> {
        let LastEntries { event, note } = self.applier.before;
        let (kind, last) = match Covered::of(what) {
            Some(Covered::Run) => return Ok(self.different_runs.contains(&id)),
            Some(kind @ Covered::Event) => (kind, event),
            Some(kind @ Covered::Note) => (kind, note),
            None => return Ok(false),
        };
        let known = format!(
            "SELECT seq FROM {} WHERE id = ?1 AND seq <= ?2",
            kind.table()
        );
        let known = self
            .ours
            .first(&known, &values![id, last], |row| row.get(0))?;
        Ok(match known {
            Some(ours) => kind.digest(self.ours, ours, payload)? != digest,
            None => false,
        })
    }
}
