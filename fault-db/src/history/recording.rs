//! Recordings: the stimuli of a procedure that found a fault, for replaying it. The two JSON texts are
//! stored without being interpreted.

use serde::Serialize;

use crate::backend::{Backend, SqlResult, from_row, values};
use crate::error::StoreError;
use crate::history::compression;
use crate::history::run_writer::RunWriter;
use crate::id::Id;
use crate::seal;
use crate::store::Store;

/// Compression of the stimuli; they are a few kilobytes.
const ZSTD_LEVEL: i32 = 3;
/// Stimuli unpack to at most this many bytes.
const MAX_STIMULI_BYTES: u64 = 64 << 20;

/// A recording to be stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingRecord {
    /// Index of the procedure in the run.
    pub ordinal: u32,
    /// The procedure.
    pub procedure: String,
    /// Bench time of the run at which the bench's clock was 0.
    pub t0_bench_us: i64,
    /// Setup of the bench, as JSON.
    pub bench_json: String,
    /// Stimuli with their times, as JSON.
    pub stimuli_json: String,
}

/// A stored recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Recording {
    /// The run of the recording.
    pub run_id: Id,
    /// The procedure.
    pub procedure: String,
    /// Bench time of the run at which the bench's clock was 0.
    pub t0_bench_us: i64,
    /// Setup of the bench, as JSON.
    pub bench_json: String,
    /// Stimuli with their times, as JSON.
    pub stimuli_json: String,
}

impl RunWriter<'_> {
    /// Commits the recording of a procedure and links traces of this run to it.
    pub fn recording(&mut self, record: &RecordingRecord, traces: &[Id]) -> Result<(), StoreError> {
        const DOING: &str = "storing a recording";
        self.check_unfinished()?;
        let (store, run) = (self.store, self.run);
        let stimuli =
            compression::pack(record.stimuli_json.as_bytes(), ZSTD_LEVEL).map_err(|error| {
                StoreError::Io {
                    path: store.path().to_path_buf(),
                    reason: error.to_string(),
                }
            })?;
        let mut fields = values![
            self.id(),
            record.ordinal,
            &record.procedure,
            record.t0_bench_us,
            &record.bench_json,
            &stimuli[..],
        ];
        let digest = seal::trace::of_recording(&fields);
        fields[0] = run.into();
        store.write(DOING, |_| {
            store.ask(DOING, |file| {
                file.execute(
                    "INSERT INTO recording(run, ordinal, procedure, t0_bench_us, bench_json, stimuli)
                     VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
                    &fields,
                )?;
                let link = "UPDATE trace SET recording = ?1 WHERE id = ?2 AND run = ?3";
                for trace in traces {
                    file.execute(link, &values![record.ordinal, *trace, run])?;
                }
                Ok(())
            })
        })?;
        self.seal.recording(record.ordinal, digest, traces);
        Ok(())
    }
}

impl Store {
    /// The recording from which a trace was cut; `None` for a trace of an earlier version of the program, or one from
    /// outside procedures.
    pub fn recording(&self, trace: Id) -> Result<Option<Recording>, StoreError> {
        const SQL: &str = "SELECT u.id, r.procedure, r.t0_bench_us, r.bench_json, r.stimuli
            FROM trace t JOIN run u ON u.seq = t.run
            JOIN recording r ON r.run = t.run AND r.ordinal = t.recording WHERE t.id = ?1";
        let found = self.first("reading a recording", SQL, &values![trace], |row| {
            let packed: Vec<u8> = row.get(4)?;
            let recording = from_row!(row => Recording:
                run_id, procedure, t0_bench_us, bench_json;
                stimuli_json: String::new()
            );
            Ok((recording, packed))
        })?;
        found
            .map(|(recording, packed)| match unpack(&packed) {
                Ok(stimuli_json) => Ok(Recording {
                    stimuli_json,
                    ..recording
                }),
                Err(detail) => Err(StoreError::Corrupt {
                    path: self.path().to_path_buf(),
                    detail: format!("the recording of trace {trace}: {detail}"),
                }),
            })
            .transpose()
    }
}

/// The number of all recordings, and the reasons why some of them cannot be read back.
pub(crate) fn check_recordings(file: &Backend) -> SqlResult<(u32, Vec<String>)> {
    let (mut count, mut wrong) = (0, Vec::new());
    file.each(
        "SELECT 'recording ' || r.ordinal || ' of run ' || hex(u.id), r.bench_json, r.stimuli
         FROM recording r JOIN run u ON u.seq = r.run ORDER BY r.run, r.ordinal",
        &[],
        |row| {
            count += 1;
            let json = |text: &str| {
                let read = serde_json::from_str::<serde::de::IgnoredAny>(text);
                read.map(drop).map_err(|error| error.to_string())
            };
            let (name, bench): (&str, &str) = (row.get(0)?, row.get(1)?);
            let found = unpack(row.get(2)?)
                .and_then(|stimuli| json(&stimuli))
                .and_then(|()| json(bench));
            wrong.extend(found.err().map(|detail| format!("{name}: {detail}")));
            Ok(())
        },
    )?;
    Ok((count, wrong))
}

fn unpack(packed: &[u8]) -> Result<String, String> {
    let damaged = |error: &dyn std::fmt::Display| format!("the stimuli are damaged: {error}");
    let json = compression::unpack(packed, MAX_STIMULI_BYTES).map_err(|error| damaged(&error))?;
    String::from_utf8(json).map_err(|error| damaged(&error))
}
