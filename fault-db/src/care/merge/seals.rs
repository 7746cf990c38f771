//! The chain of runs, carried over as it is: that a run fits its seal, and a seal the one before, is for a
//! check to find.

use rusqlite::{OptionalExtension, params};

use super::Merge;
use super::rows::Numbers;
use crate::base::SqlResult;
use crate::id::Id;
use crate::seal::{chained, seal};

/// A seal of theirs.
struct Theirs {
    origin: Id,
    ordinal: i64,
    run: i64,
    digest: Vec<u8>,
    hash: Vec<u8>,
}

impl Merge<'_> {
    /// Adds their seals. Where a copy of a file went on by itself, two runs have one place in the chain: ours
    /// stays, and from there on theirs would fit nothing here. The same holds from a run on that is sealed there
    /// as something else than it is here.
    pub(super) fn seals(&self, runs: &Numbers) -> rusqlite::Result<()> {
        let mut select = self.theirs.prepare(
            "SELECT origin, ordinal, run, digest, hash FROM seal ORDER BY origin, ordinal",
        )?;
        let mut known = self
            .ours
            .prepare("SELECT hash FROM seal WHERE origin = ?1 AND ordinal = ?2")?;
        let mut insert = self.ours.prepare(
            "INSERT INTO seal(origin, ordinal, run, digest, hash) VALUES (?1, ?2, ?3, ?4, ?5)",
        )?;
        let mut rows = select.query([])?;
        let mut last: Option<Theirs> = None;
        let mut parted = false;
        while let Some(row) = rows.next()? {
            let theirs = Theirs {
                origin: row.get(0)?,
                ordinal: row.get(1)?,
                run: row.get(2)?,
                digest: row.get(3)?,
                hash: row.get(4)?,
            };
            let before = last.filter(|last| last.origin == theirs.origin);
            parted &= before.is_some();
            let place = params![theirs.origin, theirs.ordinal];
            let run = runs.get(&theirs.run);
            let is_different = run.is_some_and(|run| self.different_runs.contains(run));
            let ours: Option<Vec<u8>> = known.query_row(place, |row| row.get(0)).optional()?;
            match ours {
                Some(ours) => {
                    let before = before.as_ref().map(|before| &before.hash[..]);
                    let fits = chained(before, &theirs.digest) == theirs.hash[..];
                    parted = ours != theirs.hash && (fits || parted);
                }
                None if parted || is_different => parted = true,
                None => {
                    let Theirs { digest, hash, .. } = &theirs;
                    insert.execute(params![theirs.origin, theirs.ordinal, run, digest, hash])?;
                }
            }
            last = Some(theirs);
        }
        Ok(())
    }

    /// Runs that came without a seal that fits here are sealed as they are found.
    pub(super) fn seal_the_rest(&self, file_id: Id) -> SqlResult<()> {
        let unsealed = "SELECT 1 FROM run WHERE seq = ?1 AND verdict IS NOT NULL
            AND NOT EXISTS (SELECT 1 FROM seal WHERE seal.run = run.seq)";
        for run in &self.fresh_runs {
            if self.ours.prepare_cached(unsealed)?.exists([run])? {
                seal(self.base, file_id, *run)?;
            }
        }
        Ok(())
    }
}
