//! The digests of traces and recordings, which the seal of their run lists.

use super::canonical::{CanonicalHash, take_rows};
use crate::backend::{Backend, SqlResult, Value, values};
use crate::id::Id;

/// SQL: the sealed fields of a trace; the ids of the occurrences that the trace shows follow, concatenated.
const TRACE: &str =
    "SELECT t.id, t.t0_bench_us, t.t0_us, t.period_us, t.row_count, t.trigger_row, t.flags, t.encoding,
        t.sha256, c.sha256
     FROM trace t JOIN channel_set c ON c.seq = t.channel_set WHERE t.seq = ?1";

/// The digest of a trace about to be stored; `fields` in the order of [`TRACE`].
pub(crate) fn of(fields: &[Value<'_>], shows: &[Id]) -> [u8; 32] {
    let mut hash = CanonicalHash::of("trace");
    hash.values(fields);
    ended(hash, shows.to_vec())
}

/// The digest of a stored trace; the samples are compared with their own checksum elsewhere.
pub(crate) fn digest(backend: &Backend, trace: i64) -> SqlResult<[u8; 32]> {
    let mut hash = CanonicalHash::of("trace");
    take_rows(&mut hash, backend, TRACE, &values![trace])?;
    let shows = backend.select(
        "SELECT id FROM fault_occurrence WHERE trace = ?1",
        &values![trace],
        |row| row.get(0),
    )?;
    Ok(ended(hash, shows))
}

fn ended(mut hash: CanonicalHash, mut shows: Vec<Id>) -> [u8; 32] {
    shows.sort();
    shows.dedup();
    let shows: Vec<u8> = shows.iter().flat_map(Id::as_bytes).copied().collect();
    hash.bytes(&shows);
    hash.finish()
}

const RECORDING: &str =
    "SELECT u.id, c.ordinal, c.procedure, c.t0_bench_us, c.bench_json, c.stimuli
     FROM recording c JOIN run u ON u.seq = c.run WHERE c.run = ?1 AND c.ordinal = ?2";

/// The digest of a recording about to be stored; `fields` in the order of [`RECORDING`].
pub(crate) fn of_recording(fields: &[Value<'_>]) -> [u8; 32] {
    let mut hash = CanonicalHash::of("recording");
    hash.values(fields);
    hash.finish()
}

/// The digest of a stored recording.
pub(crate) fn recording_digest(backend: &Backend, run: i64, ordinal: i64) -> SqlResult<[u8; 32]> {
    let mut hash = CanonicalHash::of("recording");
    take_rows(&mut hash, backend, RECORDING, &values![run, ordinal])?;
    Ok(hash.finish())
}

/// Numbers of the recordings of a run.
pub(crate) fn recordings(backend: &Backend, run: i64) -> SqlResult<Vec<i64>> {
    let sql = "SELECT ordinal FROM recording WHERE run = ?1 ORDER BY ordinal";
    backend.select(sql, &values![run], |row| row.get(0))
}
