//! Checks each seal against the row it covers and against the seal before it.

use std::collections::{BTreeMap, BTreeSet};

use super::seal_entry::{SEALS_PER_BATCH, Seal, clock_error, position_error, seals_after};
use super::signatures::{KeyUse, KeyUses};
use super::{Damage, Findings, Remarks};
use crate::backend::{Backend, SqlResult, values};
use crate::id::Id;
use crate::seal::events_and_notes::{EventPayload, event_digest, is_of_its_fault, note_digest};
use crate::seal::{
    BEGUN, PRUNED, PrunedPayload, RECOUNTED, RecountedPayload, hex, known_heads, own_file_id, run,
    statement_digest, trace,
};
use crate::signature::{SIGNATURE, read_signature};

/// Data collected while the chains are read.
#[derive(Default)]
pub(super) struct ChainSummary {
    /// Seals of runs.
    runs: u32,
    /// Runs, events and notes sealed as found, since they came without a seal.
    found: u32,
    /// Traces and recordings named in a run's seal that do not exist, and whether another file made the seal.
    missing: BTreeMap<(Id, Option<i64>), bool>,
    /// Traces and recordings deleted by a prune, with their digests.
    pruned: BTreeSet<(Id, Option<i64>, String)>,
    /// Whether the file's own chain has its first entry.
    is_begun: bool,
    /// Keys that signed entries.
    keys: KeyUses,
}

impl ChainSummary {
    /// Traces and recordings that a seal names and that are not there.
    pub fn missing(&self) -> impl Iterator<Item = (Id, Option<i64>)> {
        self.missing.keys().copied()
    }
}

/// Checks all chains; the number of runs checked, and who signed.
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
        let told: BTreeSet<_> = summary.pruned.iter().map(|(id, n, _)| (*id, *n)).collect();
        for (missing, came) in &summary.missing {
            if told.contains(missing) {
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
    match (&seal.what[..], seal.row) {
        (what @ ("run" | "event" | "note"), None) => {
            found.add(Damage::Unsealed(seal.place(), what.to_owned()));
        }
        ("run", Some(run)) => {
            summary.runs += 1;
            if run::digest(backend, run, &seal.payload)? != seal.digest[..] {
                found.add(Damage::Changed("run", id));
            }
            let payload = run::RunPayload::of(&seal.payload).unwrap_or_default();
            summary.found += u32::from(payload.found.is_some());
            let came = own != Some(seal.origin);
            check_traces_and_recordings(backend, (id, run, came), &payload, summary, found)?;
        }
        ("event", Some(event)) => {
            let payload = EventPayload::of(&seal.payload);
            let fits = event_digest(backend, event, &seal.payload)? == seal.digest[..];
            if !fits || !is_of_its_fault(backend, event, payload.as_ref())? {
                found.add(Damage::Changed("event", id));
            }
            summary.found += u32::from(payload.is_some_and(|payload| payload.found.is_some()));
        }
        ("note", Some(note)) => {
            if note_digest(backend, note, &seal.payload)? != seal.digest[..] {
                found.add(Damage::Changed("note", id));
            }
            summary.found += u32::from(!seal.payload.is_empty());
        }
        (what, _) => {
            if statement_digest(what, id, &seal.payload) != seal.digest[..] {
                found.add(Damage::SealChanged(seal.place()));
            }
            match what {
                PRUNED => {
                    if let Ok(payload) = serde_json::from_str::<PrunedPayload>(&seal.payload) {
                        summary
                            .pruned
                            .insert((id, payload.recording, payload.sha256));
                    }
                }
                BEGUN if own == Some(seal.origin) => summary.is_begun = true,
                SIGNATURE => match read_signature(backend, id, &seal.payload)? {
                    Ok(statement) => summary.keys.add(&statement),
                    Err(wrong) => found.add(Damage::Signature(seal.place(), wrong)),
                },
                RECOUNTED => {
                    if let Ok(payload) = serde_json::from_str::<RecountedPayload>(&seal.payload) {
                        // What another file has counted again is a finding there.
                        match own == Some(seal.origin) {
                            true => found.add(Damage::Recounted(payload.at_us, payload.differed)),
                            false => remarks.push(payload.text()),
                        }
                    }
                }
                _ => {}
            }
        }
    }
    Ok(())
}

/// Checks the traces and recordings of a run against its seal.
pub(super) fn check_traces_and_recordings(
    backend: &Backend,
    (id, run, came): (Id, i64, bool),
    payload: &run::RunPayload,
    summary: &mut ChainSummary,
    found: &mut Findings<'_>,
) -> SqlResult<()> {
    let traces = backend.select(
        "SELECT seq, id, recording FROM trace WHERE run = ?1",
        &values![run],
        |row| {
            Ok((
                row.get::<i64>(0)?,
                row.get::<Id>(1)?,
                row.get::<Option<i64>>(2)?,
            ))
        },
    )?;
    for said in &payload.traces {
        let Ok(of) = said.id.parse::<Id>() else {
            continue;
        };
        match traces.iter().find(|(_, trace, _)| *trace == of) {
            None => {
                // Two laptops that read the same record of a unit: the seal of the other's run covers it.
                let elsewhere = "SELECT 1 FROM trace WHERE id = ?1";
                if !backend.has(elsewhere, &values![of])? {
                    summary.missing.insert((of, None), came);
                }
            }
            Some((seq, _, recording)) => {
                if hex(&trace::digest(backend, *seq)?) != said.sha256
                    || *recording != said.recording
                {
                    found.add(Damage::TraceChanged(of));
                }
            }
        }
    }
    for (_, of, _) in &traces {
        if !payload.traces.iter().any(|said| said.id == of.to_string()) {
            found.add(Damage::TraceAdded(*of, id));
        }
    }
    let recordings = trace::recordings(backend, run)?;
    for said in &payload.recordings {
        let ordinal = said.ordinal;
        if !recordings.contains(&ordinal) {
            summary.missing.insert((id, Some(ordinal)), came);
        } else if hex(&trace::recording_digest(backend, run, ordinal)?) != said.sha256 {
            found.add(Damage::RecordingChanged(ordinal, id));
        }
    }
    for ordinal in recordings {
        if !payload
            .recordings
            .iter()
            .any(|said| said.ordinal == ordinal)
        {
            found.add(Damage::RecordingAdded(ordinal, id));
        }
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
