//! Where a chain ends, and what a run is sealed as: what to compare with what is known elsewhere.

use serde::Serialize;

use super::{hex, own_name};
use crate::base::{Base, SqlResult, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;

/// The last entry of a chain.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SealHead {
    /// The file whose chain it is.
    pub file: Id,
    /// Entries in it.
    pub entries: i64,
    /// The hash of the last, in hex: it stands for all of them.
    pub seal: String,
}

/// What a run is sealed as.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RunSealed {
    /// The file that sealed it.
    pub file: Id,
    /// Its place in that file's chain.
    pub entry: i64,
    /// The hash of its entry, in hex: it stands for the run and all that was sealed before it.
    pub seal: String,
    /// SHA-256 of all that the run says, in hex.
    pub digest: String,
    /// 1: sealed by an earlier version, which covered less; 2: all.
    pub covers: i64,
    /// How the run came, if it came without a seal and was sealed as it was found.
    pub found: Option<String>,
}

impl RunSealed {
    /// The first digits of the seal, as they stand on a test sheet.
    pub fn short(&self) -> &str {
        self.seal.get(..16).unwrap_or(&self.seal)
    }
}

impl Store {
    /// Where this file's chain ends; none of a server, which has no chain of its own, and of a file that
    /// was never opened for writing.
    pub fn head(&self) -> Result<Option<SealHead>, StoreError> {
        const DOING: &str = "reading the last seal";
        let Base::File(_) = self.base() else {
            return Ok(None);
        };
        let read = || -> SqlResult<_> {
            let Some(file) = own_name(self.base())? else {
                return Ok(None);
            };
            let head = head_of(self.base(), file)?;
            Ok(head.map(|(entries, hash)| SealHead {
                file,
                entries,
                seal: hex(&hash),
            }))
        };
        read().map_err(|error| self.failed(DOING, error))
    }
}

/// Entries of a chain, and the hash of the last.
pub(crate) fn head_of(base: &Base, origin: Id) -> SqlResult<Option<(i64, Vec<u8>)>> {
    base.first(
        "SELECT ordinal, hash FROM seal WHERE origin = ?1 ORDER BY ordinal DESC LIMIT 1",
        &values![origin],
        |row| Ok((row.get(0)?, row.get(1)?)),
    )
}

/// What a run is sealed as; the seal of who recorded it before that of who found it.
pub(crate) fn sealed_as(base: &Base, run: Id) -> SqlResult<Option<RunSealed>> {
    let sealed = base.select(
        "SELECT origin, ordinal, hash, digest, covers, says FROM seal
         WHERE id = ?1 AND what = 'run' ORDER BY origin, ordinal",
        &values![run],
        |row| {
            let says = super::run::RunSays::of(row.get(5)?).unwrap_or_default();
            Ok(RunSealed {
                file: row.get(0)?,
                entry: row.get(1)?,
                seal: hex(row.get(2)?),
                digest: hex(row.get(3)?),
                covers: row.get(4)?,
                found: says.found,
            })
        },
    )?;
    Ok(sealed
        .into_iter()
        .min_by_key(|sealed| sealed.found.is_some()))
}
