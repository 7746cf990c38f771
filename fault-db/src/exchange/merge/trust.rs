//! Acceptance of runs from a file to be merged: a run must match its seals, refer to existing rows, and equal the
//! run here.

use super::{Entry, Merge};
use crate::backend::{Backend, SqlError, SqlResult, values};
use crate::exchange::tables::TABLES;
use crate::id::Id;
use crate::seal::events_and_notes::{EventPayload, event_digest, is_of_its_fault, note_digest};
use crate::seal::run::{self, RunPayload};
use crate::seal::{hex, trace};

impl Merge<'_> {
    /// Names rows whose parent does not exist, and marks the runs that they are part of.
    pub(super) fn find_orphans(&mut self) -> SqlResult<()> {
        for table in TABLES.iter().filter(|table| table.is_inserted) {
            for column in table.columns {
                let Some((parent, _)) = column.kind.parent() else {
                    continue;
                };
                let (table, column) = (table.name, column.name);
                let sql = format!(
                    "SELECT count(*) FROM {table} WHERE {column} NOT IN (SELECT seq FROM {parent})"
                );
                let count = self.theirs.first(&sql, &[], |row| row.get::<i64>(0))?;
                let count = count.unwrap_or(0);
                if count > 0 {
                    let what = format!("{count} rows of {}", table.replace('_', " "));
                    let reason =
                        format!("the {} they are of is not there", parent.replace('_', " "));
                    self.counts.refused.add(what, reason);
                }
            }
        }
        // A sealed run is refused as a whole.
        let of_nothing = self.theirs.select(
            "SELECT DISTINCT run FROM measurement m WHERE NOT EXISTS
                (SELECT 1 FROM step s WHERE s.run = m.run AND s.step_index = m.step_index)
             UNION SELECT run FROM fault_occurrence WHERE fault NOT IN (SELECT seq FROM fault)",
            &[],
            |row| row.get::<i64>(0),
        )?;
        self.of_nothing.extend(of_nothing);
        Ok(())
    }
}

/// Whether a run is only the remainder that a busy file could not take: ended without a seal, and not passed.
/// Such a run is sealed as found in the file where it began.
pub(super) fn is_unwritten_remainder(theirs: &Backend, run: i64) -> SqlResult<bool> {
    let rest =
        "SELECT 1 FROM run r WHERE r.seq = ?1 AND r.verdict IN ('error', 'failed', 'aborted')
         AND NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = r.id AND s.what = 'run')";
    Ok(theirs.first(rest, &values![run], |_| Ok(()))?.is_some())
}

/// Difference between a run and its seals, if there is one.
pub(super) fn seal_mismatch(theirs: &Backend, run: i64) -> SqlResult<Option<String>> {
    let is_over = "SELECT 1 FROM run WHERE seq = ?1 AND verdict IS NOT NULL";
    let is_over = theirs.first(is_over, &values![run], |_| Ok(()))?.is_some();
    let sealed = seals(theirs, run)?;
    let reason = match (is_over, sealed.is_empty()) {
        (false, true) => return Ok(None),
        (false, false) => "it has a seal and no verdict: the verdict was taken away",
        (true, true) => "it has a verdict and no seal: the seal was taken away",
        (true, false) => {
            let mut fits = true;
            for seal in sealed {
                fits &= run::digest(theirs, run, &seal.payload)? == seal.digest[..];
            }
            if fits {
                return Ok(None);
            }
            CHANGED
        }
    };
    Ok(Some(reason.to_owned()))
}

/// Reason for refusing a row that does not fit its seal.
const CHANGED: &str = "it was changed after it was sealed";

/// Why an event of theirs is not taken, if it does not fit a seal that it has there.
pub(super) fn event_mismatch(theirs: &Backend, entry: &Entry) -> SqlResult<Option<String>> {
    for (payload, digest) in seals_of(theirs, "event", &entry.id)? {
        let fits = event_digest(theirs, entry.seq, &payload)? == digest[..];
        if !fits || !is_of_its_fault(theirs, entry.seq, EventPayload::of(&payload).as_ref())? {
            return Ok(Some(CHANGED.to_owned()));
        }
    }
    Ok(None)
}

/// Why a note of the other file is not taken, if the note does not fit a seal there.
pub(super) fn note_mismatch(theirs: &Backend, entry: &Entry) -> SqlResult<Option<String>> {
    for (payload, digest) in seals_of(theirs, "note", &entry.id)? {
        if note_digest(theirs, entry.seq, &payload)? != digest[..] {
            return Ok(Some(CHANGED.to_owned()));
        }
    }
    Ok(None)
}

/// Why a trace of the other file is not taken, if its digest differs from the one in the seal of
/// its run.
pub(super) fn trace_mismatch(theirs: &Backend, entry: &Entry) -> SqlResult<Option<String>> {
    let (seq, run) = (entry.seq, entry.parent);
    let read = "SELECT id, recording FROM trace WHERE seq = ?1";
    let read = theirs.first(read, &values![seq], |row| {
        Ok((row.get::<Id>(0)?, row.get::<Option<i64>>(1)?))
    })?;
    let (Some((id, recording)), sealed) = (read, payloads(theirs, run)?) else {
        return Ok(None);
    };
    for payload in sealed {
        let said = payload.traces.into_iter().find(|t| t.id == id.to_string());
        let fits = match said {
            Some(said) => {
                said.recording == recording && hex(&trace::digest(theirs, seq)?) == said.sha256
            }
            None => false,
        };
        if !fits {
            return Ok(Some(CHANGED.to_owned()));
        }
    }
    Ok(None)
}

/// Why the recordings of a run, which come together, are not taken, if one differs from its seal.
pub(super) fn recordings_mismatch(theirs: &Backend, run: i64) -> SqlResult<Option<String>> {
    let sealed = payloads(theirs, run)?;
    for ordinal in trace::recordings(theirs, run)? {
        for payload in &sealed {
            let said = payload.recordings.iter().find(|r| r.ordinal == ordinal);
            let sha256 = hex(&trace::recording_digest(theirs, run, ordinal)?);
            if said.is_none_or(|said| said.sha256 != sha256) {
                return Ok(Some(format!("recording {ordinal}: {CHANGED}")));
            }
        }
    }
    Ok(None)
}

/// Traces and recordings that the seals of a run list.
fn payloads(theirs: &Backend, run: i64) -> SqlResult<Vec<RunPayload>> {
    let sealed = seals(theirs, run)?;
    let payloads = sealed
        .iter()
        .filter_map(|seal| RunPayload::of(&seal.payload));
    Ok(payloads.collect())
}

fn seals_of(theirs: &Backend, what: &str, id: &[u8]) -> SqlResult<Vec<(String, Vec<u8>)>> {
    theirs.select(
        "SELECT says, digest FROM seal WHERE what = ?1 AND id = ?2",
        &values![what, id],
        |row| Ok((row.get(0)?, row.get(1)?)),
    )
}

/// A seal of a run. A run that came without one has one of each file that sealed it as found.
#[derive(PartialEq, Eq)]
struct Seal {
    payload: String,
    digest: Vec<u8>,
}

fn seals(backend: &Backend, run: i64) -> SqlResult<Vec<Seal>> {
    backend.select(
        "SELECT s.says, s.digest FROM run r JOIN seal s ON s.id = r.id AND s.what = 'run'
         WHERE r.seq = ?1",
        &values![run],
        |row| {
            Ok(Seal {
                payload: row.get(0)?,
                digest: row.get(1)?,
            })
        },
    )
}

/// Whether a run that is finished here is the same in the other file. One copied while it was running may
/// well hold less.
pub(super) fn is_same(ours: &Backend, here: i64, theirs: &Backend, there: i64) -> SqlResult<bool> {
    let is_over = "SELECT 1 FROM run WHERE seq = ?1 AND (verdict IS NOT NULL
        OR EXISTS (SELECT 1 FROM seal s WHERE s.id = run.id AND s.what = 'run'))";
    if theirs
        .first(is_over, &values![there], |_| Ok(()))?
        .is_none()
    {
        return Ok(true);
    }
    let sealed = seals(theirs, there)?;
    // Entries of an imported log may stand under different runs here and there; each side is held to its seal.
    let of_log = |seal: &Seal| seal.payload.contains("\"entries\"");
    if sealed.iter().any(of_log) {
        for seal in &sealed {
            if run::digest(theirs, there, &seal.payload)? != seal.digest[..] {
                return Ok(false);
            }
        }
    } else {
        match run::digest(theirs, there, "") {
            Ok(theirs) if theirs == run::digest(ours, here, "")? => {}
            // No text, or of another type.
            Ok(_) | Err(SqlError::Value { .. }) => return Ok(false),
            Err(error) => return Err(error),
        }
    }
    // A row changed by hand still has its old seal; a row sealed again by hand has another digest.
    let known = seals(ours, here)?;
    for seal in sealed {
        if !known.contains(&seal) && run::digest(ours, here, &seal.payload)? != seal.digest[..] {
            return Ok(false);
        }
    }
    Ok(true)
}
