//! The last entry of a chain, and the seal of a run, for comparison with values known elsewhere.

use serde::Serialize;

use super::hex;
use crate::backend::{Backend, SqlResult, values};
use crate::id::Id;

/// The last entry of a chain.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SealHead {
    /// The file of the chain.
    pub file: Id,
    /// Number of entries.
    pub entries: i64,
    /// The hash of the last entry, in hex; it covers all entries.
    pub seal: String,
}

/// The seal of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RunSealed {
    /// The file that sealed it.
    pub file: Id,
    /// Position of the seal in that file's chain.
    pub entry: i64,
    /// The hash of the entry, in hex; it covers the run and all entries before it.
    pub seal: String,
    /// SHA-256 of the run's content, in hex.
    pub digest: String,
    /// How the run came (`import`, `sync`), if it came without a seal and was sealed as found.
    pub found: Option<String>,
}

impl RunSealed {
    /// The first digits of the seal, as on a test sheet.
    pub fn short(&self) -> &str {
        self.seal.get(..16).unwrap_or(&self.seal)
    }
}

/// Number of entries of a chain, and the hash of the last.
pub(crate) fn head_of(backend: &Backend, origin: Id) -> SqlResult<Option<(i64, Vec<u8>)>> {
    backend.first(
        "SELECT ordinal, hash FROM seal WHERE origin = ?1 ORDER BY ordinal DESC LIMIT 1",
        &values![origin],
        |row| Ok((row.get(0)?, row.get(1)?)),
    )
}

/// The seal of a run: by the file that recorded it, or else by a file that sealed it as found.
pub(crate) fn sealed_as(backend: &Backend, run: Id) -> SqlResult<Option<RunSealed>> {
    let sealed = backend.select(
        "SELECT origin, ordinal, hash, digest, says FROM seal
         WHERE id = ?1 AND what = 'run' ORDER BY origin, ordinal",
        &values![run],
        |row| {
            let payload = super::run::RunPayload::of(row.get(4)?).unwrap_or_default();
            Ok(RunSealed {
                file: row.get(0)?,
                entry: row.get(1)?,
                seal: hex(row.get(2)?),
                digest: hex(row.get(3)?),
                found: payload.found,
            })
        },
    )?;
    Ok(sealed
        .into_iter()
        .min_by_key(|sealed| sealed.found.is_some()))
}
