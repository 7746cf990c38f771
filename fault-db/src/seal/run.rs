//! The digest of a run: its own fields, its steps, measurements and occurrences, and the digests of its
//! traces and recordings.
//!
//! During recording the digest is computed from the recorded values, not from the rows in the file, so a
//! trigger that changes a row does not get its change sealed.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::canonical::{CanonicalHash, columns, take_rows};
use super::{from_hex, hex, trace};
use crate::backend::{Backend, SqlResult, Value, values};
use crate::id::Id;
use crate::values::record::{RunEnd, RunRecord, ScriptRecord, StepRecord};

/// The payload of a run's seal: its traces and recordings, which may be deleted or arrive later, and occurrences
/// that another run may have brought before.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunPayload {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub traces: Vec<TracePayload>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub recordings: Vec<RecordingPayload>,
    /// Entries of an imported log that are faults. If two laptops imported the same entry, a store keeps it in the run
    /// that it knew first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub entries: Vec<EntryPayload>,
    /// How the run came (`import`, `sync`), if it came without a seal and was sealed as found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub found: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TracePayload {
    pub id: String,
    /// Digest over all fields of the trace, including the checksum of its samples.
    pub sha256: String,
    /// The recording it was cut from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<i64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct EntryPayload {
    pub id: String,
    /// Digest of the occurrence.
    pub sha256: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RecordingPayload {
    pub ordinal: i64,
    pub sha256: String,
}

impl RunPayload {
    pub fn of(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }

    pub fn text(&self) -> String {
        // Strings and numbers only: cannot fail.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// The digest of a run under recording.
pub(crate) struct RunDigest {
    run: CanonicalHash,
    scripts: [u8; 32],
    steps: CanonicalHash,
    measurements: CanonicalHash,
    occurrences: BTreeMap<Id, [u8; 32]>,
    payload: RunPayload,
}

/// The fields of a run at its beginning, in the order of [`RUN`]; of the unit only the serial number.
pub(crate) fn run_fields<'a>(
    id: Id,
    record: &'a RunRecord,
    sw_versions: &'a str,
) -> [Value<'a>; 20] {
    let RunRecord { unit, .. } = record;
    values![
        id,
        &unit.serial,
        &unit.kind,
        &unit.config_name,
        sw_versions,
        &record.line,
        &record.train,
        record.seed.cast_signed(),
        &record.operator,
        &record.source,
        record.connection.as_ref(),
        record.symptom.as_ref(),
        record.continues,
        record.started_at_us,
        &record.app_version,
        &record.scripts_sha256,
        &record.unit_config_sha256,
        record.injected.as_ref(),
        record.evidence.as_ref(),
        &record.owner,
    ]
}

/// The fields of a step, in the order of [`PARTS`].
pub(crate) fn step_fields(step: &StepRecord) -> [Value<'_>; 14] {
    values![
        step.index,
        &step.procedure,
        step.kind,
        step.place,
        &step.name,
        step.turn,
        step.turns,
        step.verdict,
        step.started_bench_us,
        step.bench_time_us,
        &step.message,
        step.findings.as_ref(),
        step.script_line,
        step.limit_source.as_ref(),
    ]
}

/// The fields of each measurement of a step, in the order of [`PARTS`].
pub(crate) fn measurement_fields(step: &StepRecord) -> impl Iterator<Item = [Value<'_>; 9]> {
    (0u32..).zip(&step.measurements).map(|(ordinal, measured)| {
        values![
            step.index,
            ordinal,
            &measured.name,
            measured.value,
            &measured.unit,
            measured.low,
            measured.high,
            measured.verdict,
            measured.limit_source.as_ref(),
        ]
    })
}

/// The fields of a run at its end, after those at its beginning.
pub(crate) fn end_fields(end: &RunEnd) -> [Value<'static>; 4] {
    values![
        end.verdict,
        end.finished_at_us,
        end.bench_time_us,
        end.wall_time_us,
    ]
}

impl RunDigest {
    /// Digest of a run at its beginning; `fields` as [`run_fields`] gives them.
    pub fn begin(fields: &[Value<'_>], scripts: &[ScriptRecord]) -> Self {
        let mut run = CanonicalHash::of("run");
        run.values(fields);
        // A path given twice is stored once, with the last digest.
        let scripts: BTreeMap<_, _> = scripts.iter().map(|s| (&s.path, &s.sha256)).collect();
        let mut hash = CanonicalHash::new();
        for (path, sha256) in scripts {
            hash.text(path);
            hash.text(sha256);
        }
        Self {
            run,
            scripts: hash.finish(),
            steps: CanonicalHash::new(),
            measurements: CanonicalHash::new(),
            occurrences: BTreeMap::new(),
            payload: RunPayload::default(),
        }
    }

    /// Adds a step; indexes rise.
    pub fn step(&mut self, step: &StepRecord) {
        self.steps.values(&step_fields(step));
        for measurement in measurement_fields(step) {
            self.measurements.values(&measurement);
        }
    }

    /// Adds an occurrence of a fault.
    pub fn occurrence(&mut self, id: Id, digest: [u8; 32]) {
        self.occurrences.insert(id, digest);
    }

    /// Lists in the payload an occurrence that other runs may bring, too.
    pub fn share_occurrence(&mut self, id: Id) {
        if let Some(digest) = self.occurrences.get(&id) {
            self.payload.entries.push(EntryPayload {
                id: id.to_string(),
                sha256: hex(digest),
            });
        }
    }

    pub fn trace(&mut self, id: Id, digest: [u8; 32]) {
        self.payload.traces.push(TracePayload {
            id: id.to_string(),
            sha256: hex(&digest),
            recording: None,
        });
    }

    /// Adds a recording, and links the traces that were cut from it.
    pub fn recording(&mut self, ordinal: u32, digest: [u8; 32], traces: &[Id]) {
        let ordinal = i64::from(ordinal);
        let traces: Vec<_> = traces.iter().map(Id::to_string).collect();
        for trace in &mut self.payload.traces {
            if traces.contains(&trace.id) {
                trace.recording = Some(ordinal);
            }
        }
        let sha256 = hex(&digest);
        (self.payload.recordings).push(RecordingPayload { ordinal, sha256 });
    }

    /// The payload and the digest of the finished run.
    pub fn end(&self, end: &RunEnd) -> (String, [u8; 32]) {
        let mut run = self.run.clone();
        run.values(&end_fields(end));
        let payload = self.payload.text();
        let parts = [
            self.scripts,
            self.steps.clone().finish(),
            self.measurements.clone().finish(),
            joined(self.occurrences.values()),
        ];
        let digest = whole(run, parts, &payload);
        (payload, digest)
    }
}

/// The digest of an occurrence about to be stored; `fields` in the order of [`OCCURRENCES`].
pub(crate) fn occurrence(fields: &[Value<'_>]) -> [u8; 32] {
    let mut hash = CanonicalHash::new();
    hash.values(fields);
    hash.finish()
}

/// One digest over occurrences in the order of their ids.
fn joined<'a>(occurrences: impl Iterator<Item = &'a [u8; 32]>) -> [u8; 32] {
    let mut hash = CanonicalHash::new();
    occurrences.for_each(|digest| hash.plain(digest));
    hash.finish()
}

fn whole(mut run: CanonicalHash, parts: [[u8; 32]; 4], payload: &str) -> [u8; 32] {
    parts.iter().for_each(|part| run.bytes(part));
    run.text(payload);
    run.finish()
}

pub(crate) const RUN: &str =
    "SELECT r.id, u.serial, r.unit_kind, r.unit_config_name, r.sw_versions, r.line, r.train,
        r.seed, r.operator, r.source, r.connection, r.symptom, r.continues, r.started_at_us, r.app_version, r.scripts_sha256,
        r.unit_config_sha256, r.injected, r.evidence, r.owner, r.verdict, r.finished_at_us, r.bench_time_us,
        r.wall_time_us
     FROM run r JOIN unit u ON u.seq = r.unit WHERE r.seq = ?1";

pub(crate) const PARTS: [&str; 3] = [
    "SELECT path, sha256 FROM run_script WHERE run = ?1 ORDER BY path",
    "SELECT step_index, procedure, kind, place, name, turn, turns, verdict, started_bench_us, bench_time_us, message,
        findings, script_line, limit_source FROM step WHERE run = ?1 ORDER BY step_index",
    "SELECT step_index, ordinal, name, value, unit, low, high, verdict, limit_source FROM measurement
     WHERE run = ?1 ORDER BY step_index, ordinal",
];

pub(crate) const OCCURRENCES: &str =
    "SELECT id, step_index, at_us, bench_us, message, findings, freeze_json, code, lru, line, code_name, severity
     FROM fault_occurrence WHERE run = ?1 ORDER BY id";

/// The digest of a stored run with this payload.
pub(crate) fn digest(backend: &Backend, run: i64, payload: &str) -> SqlResult<[u8; 32]> {
    let of_run = values![run];
    let mut parts = [[0; 32]; 4];
    for (part, sql) in parts.iter_mut().zip(PARTS) {
        let mut hash = CanonicalHash::new();
        take_rows(&mut hash, backend, sql, &of_run)?;
        *part = hash.finish();
    }
    let width = columns(OCCURRENCES);
    let mut occurrences = brought_by_others(backend, run, payload)?;
    backend.each(OCCURRENCES, &of_run, |row| {
        let mut hash = CanonicalHash::new();
        for column in 0..width {
            hash.take(row.field(column)?);
        }
        occurrences.insert(row.get(0)?, hash.finish());
        Ok(())
    })?;
    parts[3] = joined(occurrences.values());
    let mut whole_run = CanonicalHash::of("run");
    take_rows(&mut whole_run, backend, RUN, &of_run)?;
    Ok(whole(whole_run, parts, payload))
}

/// Entries of this run's imported log that are stored with another run, with their digests in this run's seal.
fn brought_by_others(
    backend: &Backend,
    run: i64,
    payload: &str,
) -> SqlResult<BTreeMap<Id, [u8; 32]>> {
    const BY_OTHER: &str = "SELECT 1 FROM fault_occurrence WHERE id = ?1 AND run <> ?2";
    let mut brought = BTreeMap::new();
    // Most runs are no imported logs; their payload need not be parsed.
    let payload = payload
        .contains("\"entries\"")
        .then(|| RunPayload::of(payload));
    for entry in payload.flatten().unwrap_or_default().entries {
        let digest = from_hex(&entry.sha256).and_then(|digest| digest.try_into().ok());
        if let (Ok(id), Some(digest)) = (entry.id.parse::<Id>(), digest)
            && backend.has(BY_OTHER, &values![id, run])?
        {
            brought.insert(id, digest);
        }
    }
    Ok(brought)
}

/// The payload of a stored run that is sealed as found.
pub(crate) fn payload(backend: &Backend, run: i64, found: &str) -> SqlResult<RunPayload> {
    let mut payload = RunPayload {
        found: Some(found.to_owned()),
        ..RunPayload::default()
    };
    for (seq, id, recording) in backend.select(
        "SELECT seq, id, recording FROM trace WHERE run = ?1 ORDER BY id",
        &values![run],
        |row| Ok((row.get::<i64>(0)?, row.get::<Id>(1)?, row.get(2)?)),
    )? {
        payload.traces.push(TracePayload {
            id: id.to_string(),
            sha256: hex(&trace::digest(backend, seq)?),
            recording,
        });
    }
    for ordinal in trace::recordings(backend, run)? {
        let sha256 = hex(&trace::recording_digest(backend, run, ordinal)?);
        payload
            .recordings
            .push(RecordingPayload { ordinal, sha256 });
    }
    Ok(payload)
}
