//! Checks each seal against the row it covers and against the seal before it.

use std::collections::{BTreeMap, BTreeSet};

use super::seal_entry::{SEALS_PER_BATCH, Seal, clock_error, position_error, seals_after};
use super::signatures::{KeyUse, KeyUses};
use super::{Damage, Findings, Remarks};
use crate::backend::{Backend, SqlResult, values};
use crate::id::Id;
use crate::seal::covered::Covered;
use crate::seal::events_and_notes::EventPayload;
use crate::seal::run::RunPayload;
use crate::seal::{
    BEGUN, PRUNED, PrunedPayload, RECOUNTED, RecountedPayload, known_heads, own_file_id, samples,
    statement_digest,
};
use crate::signature::{SIGNATURE, read_signature};

/// Data collected while the chains are read.
#[derive(Default)]
struct ChainSummary {
    /// Number of seals of runs.
    runs: u32,
    /// Number of runs, events and notes that were sealed as found, because they came without a seal.
    found: u32,
    /// Missing traces and recordings that the seal of a run names, and whether another file made that seal.
    missing: BTreeMap<(Id, Option<i64>), bool>,
    /// Traces and recordings that were pruned, as a seal says.
    pruned: BTreeSet<(Id, Option<i64>)>,
    /// Whether the file's own chain has its first entry.
    is_begun: bool,
    /// Keys that signed entries.
    keys: KeyUses,
}

/// Checks all chains; returns the number of runs checked, and the keys that signed.
pub(super) fn check(
    backend: &Backend,
    mut found: Findings<'_>,
    remarks: &mut Remarks,
) -> SqlResult<(u32, Vec<KeyUse>)> {
    let own = match backend {
        Backend::File(_) => own_file_id(backend)?,
        Backend::Server(_) => None,
    };
    let mut summary = ChainSummary::default();
    let mut last: Option<Seal> = None;
    loop {
        let seals = seals_after(backend, last.as_ref())?;
        let is_end = seals.len() < SEALS_PER_BATCH;
        for seal in seals {
            let before = last.as_ref().filter(|last| last.origin == seal.origin);
            if let Some(wrong) = position_error(&seal, before) {
                found.add(wrong);
            }
            check_entry(backend, &seal, own, &mut summary, &mut found, remarks)?;
            last = Some(seal);
        }
        if is_end {
            break;
        }
    }
    if let Backend::File(_) = backend {
        for (missing, came) in &summary.missing {
            if summary.pruned.contains(missing) {
                continue;
            }
            let samples = (*missing).into();
            found.add(match came {
                false => Damage::NoSamples(samples),
                true => Damage::SamplesLeft(samples),
            });
        }
        check_begun(backend, own, summary.is_begun, &mut found)?;
        let known = known_heads::of_file(backend)?;
        for (_, broken) in known_heads::broken(backend, &known, own)? {
            found.add(broken);
        }
    }
    check_unsealed_runs(backend, &mut found)?;
    let as_found = summary.found;
    if as_found > 0 {
        remarks.push(format!(
            "{as_found} runs, events and notes came without a seal and were sealed as they were found then"
        ));
    }
    Ok((summary.runs, summary.keys.into_list()))
}

/// Checks one entry against the row it covers.
fn check_entry(
    backend: &Backend,
    seal: &Seal,
    own: Option<Id>,
    summary: &mut ChainSummary,
    found: &mut Findings<'_>,
    remarks: &mut Remarks,
) -> SqlResult<()> {
    let id = seal.id;
    if matches!(&seal.what[..], "run" | "note") {
        remarks.extend(clock_error(backend, seal.origin, seal.ordinal)?);
    }
    let Some(kind) = Covered::of(&seal.what) else {
        return check_statement(backend, seal, own, summary, found, remarks);
    };
    let Some(row) = seal.row else {
        found.add(Damage::Unsealed(seal.place(), seal.what.clone()));
        return Ok(());
    };
    if !kind.fits(backend, row, &seal.payload, &seal.digest)? {
        found.add(Damage::Changed(kind.word(), id));
    }
    let is_found = match kind {
        Covered::Run => {
            summary.runs += 1;
            let payload = RunPayload::of(&seal.payload).unwrap_or_default();
            let held = samples::hold(backend, (id, row), &payload)?;
            found.add_all(held.changed);
            let came = own != Some(seal.origin);
            let missing = held.missing.into_iter().map(|missing| (missing, came));
            summary.missing.extend(missing);
            payload.found.is_some()
        }
        Covered::Event => {
            let payload = EventPayload::of(&seal.payload);
            payload.is_some_and(|payload| payload.found.is_some())
        }
        Covered::Note => !seal.payload.is_empty(),
    };
    summary.found += u32::from(is_found);
    Ok(())
}

/// Checks an entry whose payload is its whole content.
fn check_statement(
    backend: &Backend,
    seal: &Seal,
    own: Option<Id>,
    summary: &mut ChainSummary,
    found: &mut Findings<'_>,
    remarks: &mut Remarks,
) -> SqlResult<()> {
    if statement_digest(&seal.what, seal.id, &seal.payload) != seal.digest[..] {
        found.add(Damage::SealChanged(seal.place()));
    }
    match &seal.what[..] {
        PRUNED => {
            if let Ok(payload) = serde_json::from_str::<PrunedPayload>(&seal.payload) {
                summary.pruned.insert((seal.id, payload.recording));
            }
        }
        BEGUN if own == Some(seal.origin) => summary.is_begun = true,
        SIGNATURE => match read_signature(backend, seal.id, &seal.payload)? {
            Ok(statement) => summary.keys.add(&statement),
            Err(wrong) => found.add(Damage::Signature(seal.place(), wrong)),
        },
        RECOUNTED => {
            if let Ok(payload) = serde_json::from_str::<RecountedPayload>(&seal.payload) {
                let recounted = Damage::Recounted(payload.at_us, payload.differed);
                // A recount of another file is a finding when that file is checked.
                match own == Some(seal.origin) {
                    true => found.add(recounted),
                    false => remarks.push(recounted.to_string()),
                }
            }
        }
        _ => {}
    }
    Ok(())
}

/// Checks that the file's own chain has its beginning, and that each event and note has a seal.
fn check_begun(
    backend: &Backend,
    own: Option<Id>,
    is_begun: bool,
    found: &mut Findings<'_>,
) -> SqlResult<()> {
    let copied = "SELECT 1 FROM seal WHERE origin = ?1 AND what = 'copied' AND ordinal = 1";
    let is_copy = match own {
        Some(own) => backend.has(copied, &values![own])?,
        None => false,
    };
    if !is_begun && !is_copy {
        found.add(Damage::NoBeginning);
    }
    for (name, unsealed) in [("events", UNSEALED_EVENTS), ("notes", UNSEALED_NOTES)] {
        backend.each(unsealed, &[], |row| {
            found.add(Damage::NoSeal(name, row.get(0)?));
            Ok(())
        })?;
    }
    Ok(())
}

const UNSEALED_EVENTS: &str = "SELECT e.id FROM fault_event e
    WHERE NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = e.id AND s.what = 'event') ORDER BY e.seq";
const UNSEALED_NOTES: &str = "SELECT n.id FROM run_note n
    WHERE NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = n.id AND s.what = 'note') ORDER BY n.seq";

/// Finds runs without a seal, and sealed runs without a verdict.
fn check_unsealed_runs(backend: &Backend, found: &mut Findings<'_>) -> SqlResult<()> {
    type OfRun = fn(Id) -> Damage;
    let checks: [(OfRun, _); 2] = [
        (
            Damage::NoSealOfRun,
            "SELECT id FROM run WHERE verdict IS NOT NULL
                AND NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = run.id AND s.what = 'run') ORDER BY seq",
        ),
        (
            Damage::NoVerdict,
            "SELECT id FROM run WHERE verdict IS NULL
                AND EXISTS (SELECT 1 FROM seal s WHERE s.id = run.id AND s.what = 'run') ORDER BY seq",
        ),
    ];
    for (what, sql) in checks {
        backend.each(sql, &[], |row| {
            found.add(what(row.get(0)?));
            Ok(())
        })?;
    }
    let Backend::File(_) = backend else {
        return Ok(());
    };
    // If the end of the chain was cut off together with the last runs, the outbox still names them.
    let told = "SELECT count(*) FROM outbox o WHERE o.what = 'run'
        AND NOT EXISTS (SELECT 1 FROM run WHERE run.seq = o.row)";
    let gone = backend
        .first(told, &[], |row| row.get::<i64>(0))?
        .unwrap_or(0);
    if gone > 0 {
        found.add(Damage::NoRuns(gone));
    }
    Ok(())
}
