//! The chain of runs: each finished run is sealed with a hash over all it says and over the seal before
//! it. A verdict that was changed later no longer fits its seal; a run that was taken out leaves a gap.
//! Who rewrites the whole chain is found by a seal that is known elsewhere: on a test sheet, or on a
//! server.

use sha2::{Digest, Sha256};

use crate::base::{Base, Field, SqlResult, values};
use crate::id::Id;

/// What a run says, table by table, in an order of its own. Not what may change later: who was writing,
/// what the unit is called by now, which traces are still there.
const SAYS: [&str; 5] = [
    "SELECT r.id, u.serial, r.line, r.train, r.seed, r.operator, r.source, r.started_at_us,
        r.finished_at_us, r.verdict, r.bench_time_us, r.wall_time_us, r.app_version,
        r.scripts_sha256, r.unit_config_sha256, r.injected
     FROM run r JOIN unit u ON u.seq = r.unit WHERE r.seq = ?1",
    "SELECT path, sha256 FROM run_script WHERE run = ?1 ORDER BY path",
    "SELECT step_index, procedure, name, verdict, started_bench_us, bench_time_us, message,
        script_line FROM step WHERE run = ?1 ORDER BY step_index",
    "SELECT step_index, ordinal, name, value, unit, low, high, verdict FROM measurement
     WHERE run = ?1 ORDER BY step_index, ordinal",
    "SELECT id, step_index, at_us, bench_us, message, freeze_json, code, lru
     FROM fault_occurrence WHERE run = ?1 ORDER BY id",
];

/// SHA-256 over all that a run says.
pub(crate) fn digest(base: &Base, run: i64) -> SqlResult<[u8; 32]> {
    let mut hash = Sha256::new();
    for (table, sql) in SAYS.iter().enumerate() {
        let columns = columns(sql);
        base.each(sql, &values![run], |row| {
            hash.update([table as u8]);
            (0..columns).try_for_each(|column| {
                take(&mut hash, row.field(column)?);
                Ok(())
            })
        })?;
    }
    Ok(hash.finalize().into())
}

/// Columns between `SELECT` and `FROM`.
fn columns(sql: &str) -> usize {
    let list = sql.split("FROM").next().unwrap_or_default();
    list.matches(',').count() + 1
}

/// A field with its kind and length, so that no two rows look alike.
fn take(hash: &mut Sha256, field: Field<'_>) {
    let (kind, bytes): (u8, &[u8]) = match &field {
        Field::Null => (0, &[]),
        Field::Integer(value) => (1, &value.to_be_bytes()),
        Field::Real(value) => (2, &value.to_bits().to_be_bytes()),
        Field::Text(text) => (3, text.as_bytes()),
        Field::Bytes(bytes) => (4, bytes),
    };
    hash.update([kind]);
    hash.update((bytes.len() as u64).to_be_bytes());
    hash.update(bytes);
}

/// The hash of a seal; the first has none before it.
pub(crate) fn chained(before: Option<&[u8]>, digest: &[u8]) -> [u8; 32] {
    let mut hash = Sha256::new();
    hash.update(before.unwrap_or_default());
    hash.update(digest);
    hash.finalize().into()
}

/// Seals a run that has just got its verdict.
pub(crate) fn seal(base: &Base, origin: Id, run: i64) -> SqlResult<()> {
    let digest = digest(base, run)?;
    let last = base.first(
        "SELECT ordinal, hash FROM seal WHERE origin = ?1 ORDER BY ordinal DESC LIMIT 1",
        &values![origin],
        |row| Ok((row.get::<i64>(0)?, row.get::<Vec<u8>>(1)?)),
    )?;
    let before = last.as_ref().map(|(_, hash)| &hash[..]);
    let ordinal = last.as_ref().map_or(1, |(ordinal, _)| ordinal + 1);
    base.execute(
        "INSERT INTO seal(origin, ordinal, run, digest, hash) VALUES (?1, ?2, ?3, ?4, ?5)",
        &values![
            origin,
            ordinal,
            run,
            &digest[..],
            &chained(before, &digest)[..]
        ],
    )?;
    Ok(())
}

/// Seals all finished runs of a file of an earlier schema, as they are found.
pub(crate) fn seal_all(base: &Base, origin: Id) -> SqlResult<()> {
    let runs: Vec<i64> = base.select(
        "SELECT seq FROM run WHERE verdict IS NOT NULL
            AND NOT EXISTS (SELECT 1 FROM seal WHERE seal.run = run.seq)
         ORDER BY finished_at_us, seq",
        &[],
        |row| row.get(0),
    )?;
    runs.into_iter().try_for_each(|run| seal(base, origin, run))
}
