//! What the server has seen of a file's chains of seals, held against what the file says now; and the seals
//! on their way there, after all rows that they seal.

use std::path::Path;

use super::outcome::Different;
use super::rows::Rows;
use super::tables;
use crate::base::{Base, Server, SqlResult, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::seal::parted::{Standing, standing};
use crate::seal::{CopiedSays, copied_from, head_of, name_anew};

/// Seals of a batch at most.
const MOST_SEALS: i64 = 2_000;

/// A chain of which the server gets entries.
pub(super) struct Chain {
    origin: Id,
    /// Entries that are there.
    sent: i64,
    /// Entries that were here when the sync began: all that they seal is sent before they are.
    until: i64,
}

/// What is known of the file's chains before anything is sent.
#[derive(Default)]
pub(super) struct Chains {
    pub chains: Vec<Chain>,
    /// Chains of other files that went on otherwise elsewhere.
    pub different: Vec<Different>,
}

/// Looks at all chains of a file.
///
/// # Errors
/// The file's own chain does not go on from what the server has seen of it.
pub(super) fn look(file: &Base, server: &Base, own: Id, path: &Path) -> Result<Chains, HeadsError> {
    let mut found = Chains::default();
    let origins: Vec<Id> = file.select(
        "SELECT DISTINCT origin FROM seal ORDER BY origin",
        &[],
        |row| row.get(0),
    )?;
    for origin in origins {
        let until = head_of(file, origin)?.map_or(0, |(entries, _)| entries);
        let stands = standing(file, server, origin)?;
        match stands {
            Standing::Continued { known } => found.chains.push(Chain {
                origin,
                sent: known,
                until,
            }),
            stands if origin == own => return Err(HeadsError::Refused(refusal(path, &stands))),
            Standing::Behind { .. } => {}
            Standing::Parted { .. } | Standing::Rewritten { .. } => {
                // A copy that was given a name of its own said so, and sealed anew what it went on with.
                if copied_from(file, origin)?.is_none() {
                    found.different.push(Different {
                        what: "chain",
                        id: origin,
                    });
                }
            }
        }
    }
    Ok(found)
}

/// What goes wrong while chains are looked at.
pub(super) enum HeadsError {
    Sql(crate::base::SqlError),
    Refused(StoreError),
}

impl From<crate::base::SqlError> for HeadsError {
    fn from(error: crate::base::SqlError) -> Self {
        Self::Sql(error)
    }
}

/// A file whose chain does not go on from what is known of it, in words.
pub(crate) fn refusal(path: &Path, stands: &Standing) -> StoreError {
    let path = path.to_path_buf();
    match stands {
        Standing::Behind { here, there } => StoreError::EarlierCopy {
            path,
            here: *here,
            there: *there,
        },
        Standing::Rewritten { after, what, id } => StoreError::Rewritten {
            path,
            after: *after,
            what: what.clone(),
            id: *id,
        },
        Standing::Parted { after } | Standing::Continued { known: after } => {
            StoreError::PartedCopy {
                path,
                after: *after,
            }
        }
    }
}

/// Gives a copy a name of its own, if its chain does not go on from what the server has seen: what it went on
/// with is sealed under the new name as it was under the old. A rewritten chain stays refused.
pub(super) fn part(
    file: &Base,
    server: &Base,
    own: Id,
    minted: Id,
    at_us: i64,
) -> SqlResult<Option<Id>> {
    let after = match standing(file, server, own)? {
        Standing::Behind { here, .. } => here,
        Standing::Parted { after } => after,
        Standing::Continued { .. } | Standing::Rewritten { .. } => return Ok(None),
    };
    let says = CopiedSays::of(file, own, after, at_us)?;
    name_anew(file, minted, &says)?;
    Ok(Some(minted))
}

/// The next seals of a chain, added to the server in the caller's transaction; how many bytes.
pub(super) fn send(file: &Base, server: &Server, chain: &mut Chain) -> SqlResult<Option<u64>> {
    let mut rows = Rows::of(&tables::SEALS);
    let sql = "SELECT origin, ordinal, what, id, covers, says, digest, hash FROM seal
        WHERE origin = ?1 AND ordinal > ?2 AND ordinal <= ?3 ORDER BY ordinal LIMIT ?4";
    file.each(
        sql,
        &values![chain.origin, chain.sent, chain.until, MOST_SEALS],
        |row| rows.take(row, &[]),
    )?;
    if rows.count == 0 {
        return Ok(None);
    }
    rows.send(server, 0)?;
    chain.sent += rows.count as i64;
    Ok(Some(rows.bytes as u64))
}
