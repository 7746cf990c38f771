//! Decides which runs of a file are merged: a run must match its seals, refer to existing rows, and equal the run of
//! this id here.

use std::collections::BTreeSet;

use crate::backend::{Backend, SqlError, SqlResult, values};
use crate::exchange::domain::Refusals;
use crate::exchange::tables::{TABLES, TableId};
use crate::id::Id;
use crate::seal::covered::Covered;
use crate::seal::run::{self, RunPayload};
use crate::seal::{hex, trace};

/// A run, event, note or trace of the other file, and the row number there of its unit, fault or run.
pub(super) struct Entry {
    pub seq: i64,
    pub parent: i64,
    pub id: Vec<u8>,
}

/// Refuses rows of the other file whose parent does not exist; returns the row numbers of the runs with such rows.
pub(super) fn runs_of_nothing(
    theirs: &Backend,
    refused: &mut Refusals,
) -> SqlResult<BTreeSet<i64>> {
    for table in TABLES.iter().filter(|table| table.is_inserted) {
        for column in table.columns {
            let Some((parent, _)) = column.kind.parent() else {
                continue;
            };
            let (table, column) = (table.name, column.name);
            let sql = format!(
                "SELECT count(*) FROM {table} WHERE {column} NOT IN (SELECT seq FROM {parent})"
            );
            let count = theirs.first(&sql, &[], |row| row.get::<i64>(0))?;
            let count = count.unwrap_or(0);
            if count > 0 {
                let what = format!("{count} rows of {}", table.replace('_', " "));
                let reason = format!("the {} they are of is not there", parent.replace('_', " "));
                refused.add(what, reason);
            }
        }
    }
    // A sealed run is refused as a whole.
    let runs = theirs.select(
        "SELECT DISTINCT run FROM measurement m WHERE NOT EXISTS
            (SELECT 1 FROM step s WHERE s.run = m.run AND s.step_index = m.step_index)
         UNION SELECT run FROM fault_occurrence WHERE fault NOT IN (SELECT seq FROM fault)",
        &[],
        |row| row.get::<i64>(0),
    )?;
    Ok(runs.into_iter().collect())
}

/// Whether a run is only the rest that a busy file could not take: ended without a seal, and not passed. The file where
/// such a run began seals it as found.
pub(super) fn is_unwritten_remainder(theirs: &Backend, run: &Entry) -> SqlResult<bool> {
    let rest = "SELECT 1 FROM run WHERE seq = ?1 AND verdict IN ('error', 'failed', 'aborted')";
    Ok(theirs.has(rest, &values![run.seq])? && seals(theirs, "run", &run.id)?.is_empty())
}

/// The difference between a run and its seals; `None` if it matches them.
pub(super) fn seal_mismatch(theirs: &Backend, run: &Entry) -> SqlResult<Option<String>> {
    let sealed = seals(theirs, "run", &run.id)?;
    let reason = match (theirs.has(IS_OVER, &values![run.seq])?, sealed.is_empty()) {
        (false, true) => return Ok(None),
        (false, false) => "it has a seal and no verdict: the verdict was taken away",
        (true, true) => "it has a verdict and no seal: the seal was taken away",
        (true, false) => return Ok(changed(fits_all(theirs, Covered::Run, run.seq, &sealed)?)),
    };
    Ok(Some(reason.to_owned()))
}

const IS_OVER: &str = "SELECT 1 FROM run WHERE seq = ?1 AND verdict IS NOT NULL";

/// Reason for refusing a row that does not fit its seal.
const CHANGED: &str = "it was changed after it was sealed";

fn changed(fits: bool) -> Option<String> {
    (!fits).then(|| CHANGED.to_owned())
}

/// Why an event, note or trace of the other file, or the recordings of a run, which come together, are refused: they do
/// not match a seal there. `None` if they match.
pub(super) fn mismatch(theirs: &Backend, of: TableId, entry: &Entry) -> SqlResult<Option<String>> {
    let kind = match of {
        TableId::Event => Covered::Event,
        TableId::Note => Covered::Note,
        TableId::Trace => return Ok(changed(trace_fits(theirs, entry)?)),
        _ => return recordings_mismatch(theirs, entry),
    };
    let sealed = seals(theirs, kind.word(), &entry.id)?;
    Ok(changed(fits_all(theirs, kind, entry.seq, &sealed)?))
}

/// Whether a trace has the digest that the seals of its run list.
fn trace_fits(theirs: &Backend, entry: &Entry) -> SqlResult<bool> {
    let read = "SELECT t.id, t.recording, r.id FROM trace t JOIN run r ON r.seq = t.run
        WHERE t.seq = ?1";
    let read = theirs.first(read, &values![entry.seq], |row| {
        let (id, run): (Id, Vec<u8>) = (row.get(0)?, row.get(2)?);
        Ok((id, row.get::<Option<i64>>(1)?, run))
    })?;
    let Some((id, recording, run)) = read else {
        return Ok(true);
    };
    let mut fits = true;
    for payload in payloads(theirs, &run)? {
        let said = payload.traces.into_iter().find(|t| t.id == id.to_string());
        fits &= match said {
            Some(said) => {
                said.recording == recording
                    && hex(&trace::digest(theirs, entry.seq)?) == said.sha256
            }
            None => false,
        };
    }
    Ok(fits)
}

/// The recording of a run that differs from its seal, if there is one.
fn recordings_mismatch(theirs: &Backend, run: &Entry) -> SqlResult<Option<String>> {
    let sealed = payloads(theirs, &run.id)?;
    for ordinal in trace::recordings(theirs, run.seq)? {
        for payload in &sealed {
            let said = payload.recordings.iter().find(|r| r.ordinal == ordinal);
            let sha256 = hex(&trace::recording_digest(theirs, run.seq, ordinal)?);
            if said.is_none_or(|said| said.sha256 != sha256) {
                return Ok(Some(format!("recording {ordinal}: {CHANGED}")));
            }
        }
    }
    Ok(None)
}

/// The payloads of the seals of a run, which list its traces and recordings.
fn payloads(theirs: &Backend, run: &[u8]) -> SqlResult<Vec<RunPayload>> {
    let sealed = seals(theirs, "run", run)?;
    let payloads = sealed
        .iter()
        .filter_map(|seal| RunPayload::of(&seal.payload));
    Ok(payloads.collect())
}

/// A seal of a row. A run that came unsealed has one seal of each file that sealed it as found.
#[derive(PartialEq, Eq)]
struct Seal {
    payload: String,
    digest: Vec<u8>,
}

fn seals(backend: &Backend, what: &str, id: &[u8]) -> SqlResult<Vec<Seal>> {
    let sealed = "SELECT says, digest FROM seal WHERE what = ?1 AND id = ?2";
    backend.select(sealed, &values![what, id], |row| {
        let (payload, digest) = (row.get(0)?, row.get(1)?);
        Ok(Seal { payload, digest })
    })
}

fn fits_all(backend: &Backend, kind: Covered, row: i64, seals: &[Seal]) -> SqlResult<bool> {
    for Seal { payload, digest } in seals {
        if !kind.fits(backend, row, payload, digest)? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Whether a run that is finished here (row `here`) is the same in the other file. A copy made while the run was under
/// way may hold less.
pub(super) fn is_same(ours: &Backend, here: i64, theirs: &Backend, run: &Entry) -> SqlResult<bool> {
    let mut sealed = seals(theirs, "run", &run.id)?;
    if sealed.is_empty() && !theirs.has(IS_OVER, &values![run.seq])? {
        return Ok(true);
    }
    // An entry of an imported log may be stored with different runs here and there; each side is compared with its
    // seal.
    let of_log = |seal: &Seal| seal.payload.contains("\"entries\"");
    if sealed.iter().any(of_log) {
        if !fits_all(theirs, Covered::Run, run.seq, &sealed)? {
            return Ok(false);
        }
    } else {
        match run::digest(theirs, run.seq, "") {
            Ok(theirs) if theirs == run::digest(ours, here, "")? => {}
            // The value is no text, or of another type.
            Ok(_) | Err(SqlError::Value { .. }) => return Ok(false),
            Err(error) => return Err(error),
        }
    }
    // A row changed by hand still has its old seal; a row sealed again by hand has another digest.
    let known = seals(ours, "run", &run.id)?;
    sealed.retain(|seal| !known.contains(seal));
    fits_all(ours, Covered::Run, here, &sealed)
}
