//! Runs that are over both here and there: whether they say the same.

use std::collections::BTreeSet;

use super::Merge;
use super::rows::Numbers;
use crate::base::{Base, SqlResult, values};
use crate::id::Id;
use crate::seal::{first, run_digest};
use crate::sync::Different;

impl Merge<'_> {
    /// Finds runs that are over here and there and are told otherwise, be it by what they say or by their seals.
    pub(super) fn compare(&mut self, runs: &Numbers) -> SqlResult<()> {
        for (theirs, ours) in runs {
            if !self.sealed_runs.contains(ours) || !is_over(self.their_base, *theirs)? {
                continue;
            }
            // A file changed by hand has its old seals; one sealed anew may say what it likes.
            let (here, there) = (seals(self.base, *ours)?, seals(self.their_base, *theirs)?);
            let same_said =
                first::digest(self.their_base, *theirs)? == first::digest(self.base, *ours)?;
            let mut fits = same_said;
            for seal in &there {
                fits &= here.contains(seal) || digest(self.base, *ours, seal)? == seal.digest[..];
            }
            if !fits {
                self.different_runs.insert(*ours);
            }
        }
        for run in &self.different_runs {
            let id =
                self.base
                    .first("SELECT id FROM run WHERE seq = ?1", &values![*run], |row| {
                        row.get::<Id>(0)
                    })?;
            let different = id.map(|id| Different { what: "run", id });
            self.counts.different.extend(different);
        }
        Ok(())
    }
}

/// Whether a run came to its end there: one that was copied while it was under way may well say less.
fn is_over(base: &Base, run: i64) -> SqlResult<bool> {
    let is_over = base.first(
        "SELECT 1 FROM run WHERE seq = ?1 AND (verdict IS NOT NULL
            OR EXISTS (SELECT 1 FROM seal s WHERE s.id = run.id AND s.what = 'run'))",
        &values![run],
        |_| Ok(()),
    )?;
    Ok(is_over.is_some())
}

/// One of the seals of a run; files that shared it before there were seals have each sealed it.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Seal {
    covers: i64,
    says: String,
    digest: Vec<u8>,
}

fn seals(base: &Base, run: i64) -> SqlResult<BTreeSet<Seal>> {
    let sealed = base.select(
        "SELECT s.covers, s.says, s.digest FROM run r JOIN seal s ON s.id = r.id AND s.what = 'run'
         WHERE r.seq = ?1",
        &values![run],
        |row| {
            Ok(Seal {
                covers: row.get(0)?,
                says: row.get(1)?,
                digest: row.get(2)?,
            })
        },
    )?;
    Ok(sealed.into_iter().collect())
}

/// What our run would be sealed as there.
fn digest(base: &Base, run: i64, seal: &Seal) -> SqlResult<[u8; 32]> {
    run_digest(base, run, seal.covers, &seal.says)
}
