//! The digest of runs sealed before schema 5. It covers less than today's; such seals stay as they are.

use sha2::{Digest as _, Sha256};

use super::canonical::{CanonicalHash, columns};
use crate::backend::{Backend, SqlResult, values};

/// What this version covers, as shown to users.
pub(crate) const COVERED: &str = "the run, its scripts, steps and measured values, and of faults their codes, \
    parts, messages, times and freeze frames; not software versions, names of faults, traces and recordings";

/// The fields, table by table, in the order of version 1.
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

/// SHA-256 over these fields.
pub(crate) fn digest(backend: &Backend, run: i64) -> SqlResult<[u8; 32]> {
    let mut hash = CanonicalHash::new();
    for (table, sql) in SAYS.iter().enumerate() {
        let columns = columns(sql);
        backend.each(sql, &values![run], |row| {
            hash.plain(&[table as u8]);
            (0..columns).try_for_each(|column| {
                hash.raw(row.field(column)?);
                Ok(())
            })
        })?;
    }
    Ok(hash.finish())
}

/// The hash of an entry, from the hash of the entry before and its digest.
pub(crate) fn chained(before: Option<&[u8]>, digest: &[u8]) -> [u8; 32] {
    let hash = Sha256::new().chain_update(before.unwrap_or_default());
    hash.chain_update(digest).finalize().into()
}
