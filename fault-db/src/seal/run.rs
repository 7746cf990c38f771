//! What a run is sealed as: all it says, and what its traces and recordings are.
//!
//! While it is recorded the digest is made of what is recorded, not of what lies in the file: a trigger
//! that changes a row on its way does not get its change sealed.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::canon::{Canon, columns, take_rows};
use super::{hex, trace};
use crate::base::{Base, SqlResult, Value, values};
use crate::id::Id;
use crate::record::{MeasurementRecord, RunEnd, RunRecord, StepRecord};

/// What a run's seal says in words: its traces and recordings, which come and go without it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunSays {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub traces: Vec<TraceSays>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub recordings: Vec<RecordingSays>,
    /// How the run came, if it came without a seal: what it is sealed as is how it was found then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub found: Option<String>,
}

/// A trace of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TraceSays {
    pub id: String,
    /// Of all it says, samples included.
    pub sha256: String,
    /// The recording it was cut from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<i64>,
}

/// A recording of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RecordingSays {
    pub ordinal: i64,
    pub sha256: String,
}

impl RunSays {
    pub fn of(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }

    pub fn text(&self) -> String {
        // Strings and numbers only: cannot fail.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// The digest of a run while it is recorded.
pub(crate) struct RunSeal {
    run: Canon,
    scripts: [u8; 32],
    steps: Canon,
    measurements: Canon,
    occurrences: BTreeMap<Id, [u8; 32]>,
    says: RunSays,
}

impl RunSeal {
    /// Of a run at its beginning.
    pub fn begin(id: Id, record: &RunRecord, sw_versions: &str) -> Self {
        let RunRecord { unit, .. } = record;
        let mut run = Canon::of("run");
        run.values(&values![
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
            record.started_at_us,
            &record.app_version,
            &record.scripts_sha256,
            &record.unit_config_sha256,
            record.injected.as_ref(),
            &record.owner,
        ]);
        // A path that comes twice is stored once, as it came last.
        let scripts = record.scripts.iter();
        let scripts: BTreeMap<_, _> = scripts.map(|s| (&s.path, &s.sha256)).collect();
        let mut hash = Canon::new();
        for (path, sha256) in scripts {
            hash.text(path);
            hash.text(sha256);
        }
        Self {
            run,
            scripts: hash.finish(),
            steps: Canon::new(),
            measurements: Canon::new(),
            occurrences: BTreeMap::new(),
            says: RunSays::default(),
        }
    }

    /// A step; they come with rising indexes.
    pub fn step(&mut self, step: &StepRecord) {
        self.steps.values(&values![
            step.index,
            &step.procedure,
            &step.name,
            step.verdict.as_str(),
            step.started_bench_us,
            step.bench_time_us,
            &step.message,
            step.script_line,
        ]);
        for (ordinal, measurement) in (0u32..).zip(&step.measurements) {
            self.measurement(step.index, ordinal, measurement);
        }
    }

    fn measurement(&mut self, step: u32, ordinal: u32, measurement: &MeasurementRecord) {
        self.measurements.values(&values![
            step,
            ordinal,
            &measurement.name,
            measurement.value,
            &measurement.unit,
            measurement.low,
            measurement.high,
            measurement.verdict.as_str(),
        ]);
    }

    /// An occurrence of a fault.
    pub fn occurrence(&mut self, id: Id, digest: [u8; 32]) {
        self.occurrences.insert(id, digest);
    }

    /// A trace.
    pub fn trace(&mut self, id: Id, digest: [u8; 32]) {
        self.says.traces.push(TraceSays {
            id: id.to_string(),
            sha256: hex(&digest),
            recording: None,
        });
    }

    /// A recording, and the traces that were cut from it.
    pub fn recording(&mut self, ordinal: u32, digest: [u8; 32], traces: &[Id]) {
        let ordinal = i64::from(ordinal);
        let traces: Vec<_> = traces.iter().map(Id::to_string).collect();
        for trace in &mut self.says.traces {
            if traces.contains(&trace.id) {
                trace.recording = Some(ordinal);
            }
        }
        let sha256 = hex(&digest);
        (self.says.recordings).push(RecordingSays { ordinal, sha256 });
    }

    /// What the run says at its end, and its digest.
    pub fn end(&self, end: &RunEnd) -> (String, [u8; 32]) {
        let mut run = self.run.clone();
        run.values(&values![
            end.verdict.as_str(),
            end.finished_at_us,
            end.bench_time_us,
            end.wall_time_us,
        ]);
        let says = self.says.text();
        let parts = [
            self.scripts,
            self.steps.clone().finish(),
            self.measurements.clone().finish(),
            joined(self.occurrences.values()),
        ];
        let digest = whole(run, parts, &says);
        (says, digest)
    }
}

/// The digest of an occurrence about to be stored, its fields in the order of [`OCCURRENCES`].
pub(crate) fn occurrence(fields: &[Value<'_>]) -> [u8; 32] {
    let mut hash = Canon::new();
    hash.values(fields);
    hash.finish()
}

/// Occurrences in the order of their ids.
fn joined<'a>(occurrences: impl Iterator<Item = &'a [u8; 32]>) -> [u8; 32] {
    let mut hash = Canon::new();
    occurrences.for_each(|digest| hash.plain(digest));
    hash.finish()
}

fn whole(mut run: Canon, parts: [[u8; 32]; 4], says: &str) -> [u8; 32] {
    parts.iter().for_each(|part| run.bytes(part));
    run.text(says);
    run.finish()
}

const RUN: &str =
    "SELECT r.id, u.serial, r.unit_kind, r.unit_config_name, r.sw_versions, r.line, r.train,
        r.seed, r.operator, r.source, r.started_at_us, r.app_version, r.scripts_sha256,
        r.unit_config_sha256, r.injected, r.owner, r.verdict, r.finished_at_us, r.bench_time_us,
        r.wall_time_us
     FROM run r JOIN unit u ON u.seq = r.unit WHERE r.seq = ?1";

const PARTS: [&str; 3] = [
    "SELECT path, sha256 FROM run_script WHERE run = ?1 ORDER BY path",
    "SELECT step_index, procedure, name, verdict, started_bench_us, bench_time_us, message,
        script_line FROM step WHERE run = ?1 ORDER BY step_index",
    "SELECT step_index, ordinal, name, value, unit, low, high, verdict FROM measurement
     WHERE run = ?1 ORDER BY step_index, ordinal",
];

const OCCURRENCES: &str =
    "SELECT id, step_index, at_us, bench_us, message, freeze_json, code, lru, line, code_name, severity
     FROM fault_occurrence WHERE run = ?1 ORDER BY id";

/// The digest of a run as it lies there, with what its seal says of traces and recordings.
pub(crate) fn digest(base: &Base, run: i64, says: &str) -> SqlResult<[u8; 32]> {
    let of_run = values![run];
    let mut parts = [[0; 32]; 4];
    for (part, sql) in parts.iter_mut().zip(PARTS) {
        let mut hash = Canon::new();
        take_rows(&mut hash, base, sql, &of_run)?;
        *part = hash.finish();
    }
    let width = columns(OCCURRENCES);
    let mut all = Canon::new();
    base.each(OCCURRENCES, &of_run, |row| {
        let mut hash = Canon::new();
        for column in 0..width {
            hash.take(row.field(column)?);
        }
        all.plain(&hash.finish());
        Ok(())
    })?;
    parts[3] = all.finish();
    let mut whole_run = Canon::of("run");
    take_rows(&mut whole_run, base, RUN, &of_run)?;
    Ok(whole(whole_run, parts, says))
}

/// What is there of a run's traces and recordings, for one that is sealed as it is found.
pub(crate) fn says(base: &Base, run: i64, found: &str) -> SqlResult<RunSays> {
    let mut says = RunSays {
        found: Some(found.to_owned()),
        ..RunSays::default()
    };
    for (seq, id, recording) in base.select(
        "SELECT seq, id, recording FROM trace WHERE run = ?1 ORDER BY id",
        &values![run],
        |row| Ok((row.get::<i64>(0)?, row.get::<Id>(1)?, row.get(2)?)),
    )? {
        says.traces.push(TraceSays {
            id: id.to_string(),
            sha256: hex(&trace::digest(base, seq)?),
            recording,
        });
    }
    for ordinal in trace::recordings(base, run)? {
        let sha256 = hex(&trace::recording_digest(base, run, ordinal)?);
        says.recordings.push(RecordingSays { ordinal, sha256 });
    }
    Ok(says)
}
