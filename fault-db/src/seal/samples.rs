//! Compares the traces and recordings of a run with the payload of the run's seal.

use std::collections::BTreeSet;

use sha2::{Digest as _, Sha256};

use super::run::RunPayload;
use super::{PRUNED, PrunedPayload, hex, trace};
use crate::backend::{Backend, SqlResult, values};
use crate::error::{Damage, Samples};
use crate::id::Id;

/// Differences between the traces and recordings of a run and those that its seal names.
pub(crate) struct SamplesHeld {
    /// Traces and recordings that were changed or added.
    pub changed: Vec<Damage>,
    /// Traces and recordings that are missing: a trace by its id, a recording by its run and number.
    pub missing: BTreeSet<(Id, Option<i64>)>,
}

/// Compares the traces and recordings of a run with the payload of a seal.
pub(crate) fn hold(
    backend: &Backend,
    (id, run): (Id, i64),
    payload: &RunPayload,
) -> SqlResult<SamplesHeld> {
    let (mut changed, mut missing) = (Vec::new(), BTreeSet::new());
    let traces = backend.select(
        "SELECT seq, id, recording FROM trace WHERE run = ?1",
        &values![run],
        |row| {
            let (seq, recording): (i64, Option<i64>) = (row.get(0)?, row.get(2)?);
            Ok((seq, row.get::<Id>(1)?, recording))
        },
    )?;
    for said in &payload.traces {
        let Ok(of) = said.id.parse::<Id>() else {
            continue;
        };
        match traces.iter().find(|(_, trace, _)| *trace == of) {
            None => {
                // If two laptops read the same record of a unit, the seal of the other laptop's run covers the trace.
                let elsewhere = "SELECT 1 FROM trace WHERE id = ?1";
                if !backend.has(elsewhere, &values![of])? {
                    missing.insert((of, None));
                }
            }
            Some((seq, _, recording)) => {
                if hex(&trace::digest(backend, *seq)?) != said.sha256
                    || *recording != said.recording
                {
                    changed.push(Damage::TraceChanged(of));
                }
            }
        }
    }
    for (_, of, _) in &traces {
        if !payload.traces.iter().any(|said| said.id == of.to_string()) {
            changed.push(Damage::TraceAdded(*of, id));
        }
    }
    let recordings = trace::recordings(backend, run)?;
    for said in &payload.recordings {
        let ordinal = said.ordinal;
        if !recordings.contains(&ordinal) {
            missing.insert((id, Some(ordinal)));
        } else if hex(&trace::recording_digest(backend, run, ordinal)?) != said.sha256 {
            changed.push(Damage::RecordingChanged(ordinal, id));
        }
    }
    for ordinal in recordings {
        let mut said = payload.recordings.iter();
        if !said.any(|said| said.ordinal == ordinal) {
            changed.push(Damage::RecordingAdded(ordinal, id));
        }
    }
    Ok(SamplesHeld { changed, missing })
}

/// Whether a seal says that a missing trace or recording was pruned. Always true on a server, which has only the traces
/// that were sent.
pub(crate) fn is_pruned(backend: &Backend, (id, recording): (Id, Option<i64>)) -> SqlResult<bool> {
    if let Backend::Server(_) = backend {
        return Ok(true);
    }
    let deletions = "SELECT says FROM seal WHERE what = ?1 AND id = ?2";
    let deletions = backend.select(deletions, &values![PRUNED, id], |row| {
        Ok(serde_json::from_str::<PrunedPayload>(row.get(0)?).ok())
    })?;
    let mut deletions = deletions.into_iter().flatten();
    Ok(deletions.any(|pruned| pruned.recording == recording))
}

/// Samples and channel lists of a run's traces that do not match the checksums in the traces' digests, as sentences.
pub(crate) fn changed_samples(backend: &Backend, run: i64) -> SqlResult<Vec<String>> {
    let mut changed = Vec::new();
    backend.each(
        "SELECT t.id, t.data, t.sha256, c.json, c.sha256 FROM trace t JOIN channel_set c ON c.seq = t.channel_set
         WHERE t.run = ?1 ORDER BY t.id",
        &values![run],
        |row| {
            let trace = Samples::Trace(row.get(0)?);
            if Sha256::digest(row.get::<&[u8]>(1)?)[..] != *row.get::<&[u8]>(2)? {
                changed.push(format!("the samples of {trace} were changed"));
            }
            if Sha256::digest(row.get::<&str>(3)?.as_bytes())[..] != *row.get::<&[u8]>(4)? {
                changed.push(format!("the list of channels of {trace} was changed"));
            }
            Ok(())
        },
    )?;
    Ok(changed)
}

/// Whether the traces and recordings of a run are those that its seal names, apart from pruned ones.
pub(crate) fn has_its_traces(backend: &Backend, run: (Id, i64), payload: &str) -> SqlResult<bool> {
    let payload = RunPayload::of(payload).unwrap_or_default();
    let held = hold(backend, run, &payload)?;
    let mut is_whole = held.changed.is_empty() && changed_samples(backend, run.1)?.is_empty();
    for missing in held.missing {
        is_whole &= is_pruned(backend, missing)?;
    }
    Ok(is_whole)
}
