//! Compares runs that are finished in both files.

use std::collections::BTreeSet;

use super::Merge;
use super::rows::Numbers;
use crate::backend::{Backend, SqlResult, values};
use crate::id::Id;
use crate::seal::{run_digest, version1};
use crate::sync::Different;

impl Merge<'_> {
    /// Finds runs finished on both sides that differ in their content or in their seals.
    pub(super) fn compare(&mut self, runs: &Numbers) -> SqlResult<()> {
        for (theirs, ours) in runs {
            if !self.sealed_runs.contains(ours) || !is_over(self.their_backend, *theirs)? {
                continue;
            }
            // A row changed by hand still has its old seal; a row sealed again by hand has another digest.
            let (here, there) = (
                seals(self.backend, *ours)?,
                seals(self.their_backend, *theirs)?,
            );
            let same_said = version1::digest(self.their_backend, *theirs)?
                == version1::digest(self.backend, *ours)?;
            let mut fits = same_said;
            for seal in &there {
                fits &=
                    here.contains(seal) || digest(self.backend, *ours, seal)? == seal.digest[..];
            }
            if !fits {
                self.different_runs.insert(*ours);
            }
        }
        for run in &self.different_runs {
            let id =
                self.backend
                    .first("SELECT id FROM run WHERE seq = ?1", &values![*run], |row| {
                        row.get::<Id>(0)
                    })?;
            let different = id.map(|id| Different { what: "run", id });
            self.counts.different.extend(different);
        }
        Ok(())
    }
}

/// Whether a run was finished there; one copied while it was running may well hold less.
fn is_over(backend: &Backend, run: i64) -> SqlResult<bool> {
    let is_over = backend.first(
        "SELECT 1 FROM run WHERE seq = ?1 AND (verdict IS NOT NULL
            OR EXISTS (SELECT 1 FROM seal s WHERE s.id = run.id AND s.what = 'run'))",
        &values![run],
        |_| Ok(()),
    )?;
    Ok(is_over.is_some())
}

/// A seal of a run; files that shared the run before there were seals have each sealed it.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Seal {
    covers: i64,
    payload: String,
    digest: Vec<u8>,
}

fn seals(backend: &Backend, run: i64) -> SqlResult<BTreeSet<Seal>> {
    let sealed = backend.select(
        "SELECT s.covers, s.says, s.digest FROM run r JOIN seal s ON s.id = r.id AND s.what = 'run'
         WHERE r.seq = ?1",
        &values![run],
        |row| {
            Ok(Seal {
                covers: row.get(0)?,
                payload: row.get(1)?,
                digest: row.get(2)?,
            })
        },
    )?;
    Ok(sealed.into_iter().collect())
}

/// The digest of our run under the conditions of their seal.
fn digest(backend: &Backend, run: i64, seal: &Seal) -> SqlResult<[u8; 32]> {
    run_digest(backend, run, seal.covers, &seal.payload)
}
