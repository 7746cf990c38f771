//! Runs that are over both here and there: whether they say the same.

use std::collections::BTreeSet;

use super::Merge;
use super::rows::Numbers;
use crate::base::{Base, SqlResult, values};
use crate::id::Id;
use crate::seal::digest;
use crate::sync::Different;

impl Merge<'_> {
    /// Finds runs that are over here and there and are told otherwise, be it by what they say or by their seals.
    pub(super) fn compare(&mut self, runs: &Numbers) -> SqlResult<()> {
        for (theirs, ours) in runs {
            if !self.sealed_runs.contains(ours) || !is_over(self.their_base, *theirs)? {
                continue;
            }
            // A file changed by hand has its old seals; one sealed anew may say what it likes.
            let said = digest(self.base, *ours)?;
            let mut here = sealed(self.base, *ours)?;
            here.insert(said.to_vec());
            let there = sealed(self.their_base, *theirs)?;
            if digest(self.their_base, *theirs)? != said || !there.is_subset(&here) {
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
            OR EXISTS (SELECT 1 FROM seal WHERE seal.run = run.seq))",
        &values![run],
        |_| Ok(()),
    )?;
    Ok(is_over.is_some())
}

/// What a run is sealed as; files that shared it before there were seals have each sealed it.
fn sealed(base: &Base, run: i64) -> SqlResult<BTreeSet<Vec<u8>>> {
    let sealed = base.select(
        "SELECT digest FROM seal WHERE run = ?1",
        &values![run],
        |row| row.get(0),
    )?;
    Ok(sealed.into_iter().collect())
}
