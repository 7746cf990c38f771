//! Compares the file's chains of seals with those on the server, and sends new seals after the rows they
//! cover.

use std::path::Path;

use super::outcome::Difference;
use crate::backend::{Backend, SqlResult, values};
use crate::error::StoreError;
use crate::exchange::rows::Rows;
use crate::exchange::tables::TableId;
use crate::exchange::to_server::ServerApplier;
use crate::id::Id;
use crate::seal::divergence::{ChainComparison, compare_all_chains, compare_chains};
use crate::seal::{CopiedPayload, copied_from, head_of, start_chain_of_copy};

/// Greatest number of seals in a batch.
const MOST_SEALS: i64 = 2_000;

/// A chain with entries to be sent.
pub(super) struct Chain {
    origin: Id,
    /// Number of entries on the server.
    sent: i64,
    /// Number of entries in the file when the sync began: the rows that they cover are sent before them.
    until: i64,
}

/// The comparison of all chains before anything is sent.
#[derive(Default)]
pub(super) struct Chains {
    pub chains: Vec<Chain>,
    /// The file's own chain, if it does not continue the one on the server.
    pub refused: Option<ChainComparison>,
    /// Chains of other files that have forked or were rewritten.
    pub different: Vec<Difference>,
}

/// Compares all chains of a file.
pub(super) fn look(file: &Backend, server: &Backend, own: Id) -> SqlResult<Chains> {
    let mut found = Chains::default();
    for (origin, stands) in compare_all_chains(file, server)? {
        match stands {
            ChainComparison::Extends { known } => found.chains.push(Chain {
                origin,
                sent: known,
                until: head_of(file, origin)?.map_or(0, |(entries, _)| entries),
            }),
            stands if origin == own => found.refused = Some(stands),
            ChainComparison::Behind { .. } => {}
            ChainComparison::Forked { .. } | ChainComparison::Rewritten { .. } => {
                // A copy that was given its own id recorded that, and sealed its entries again.
                if copied_from(file, origin)?.is_none() {
                    let (what, id) = ("chain", origin);
                    found.different.push(Difference { what, id });
                }
            }
        }
    }
    Ok(found)
}

/// The error for a file whose chain does not continue the one known elsewhere.
pub(crate) fn chain_error(path: &Path, stands: &ChainComparison) -> StoreError {
    let path = path.to_path_buf();
    match stands {
        ChainComparison::Behind { here, there } => StoreError::EarlierCopy {
            path,
            here: *here,
            there: *there,
        },
        ChainComparison::Rewritten { after, what, id } => StoreError::Rewritten {
            path,
            after: *after,
            what: what.clone(),
            id: *id,
        },
        ChainComparison::Forked { after } | ChainComparison::Extends { known: after } => {
            StoreError::ForkedCopy {
                path,
                after: *after,
            }
        }
    }
}

/// Gives a copy its own id if its chain does not continue the one on the server: its own entries are repeated
/// under the new id. A rewritten chain stays refused.
pub(super) fn rename_copy(
    file: &Backend,
    server: &Backend,
    own: Id,
    minted: Id,
    at_us: i64,
) -> SqlResult<Option<Id>> {
    let after = match compare_chains(file, server, own)? {
        ChainComparison::Behind { here, .. } => here,
        ChainComparison::Forked { after } => after,
        ChainComparison::Extends { .. } | ChainComparison::Rewritten { .. } => return Ok(None),
    };
    let payload = CopiedPayload::of(file, own, after, at_us)?;
    start_chain_of_copy(file, minted, &payload)?;
    Ok(Some(minted))
}

/// Sends the next seals of a chain, in the caller's transaction; returns the number of bytes, or `None` at the end.
pub(super) fn send(
    file: &Backend,
    server: &ServerApplier<'_>,
    chain: &mut Chain,
) -> SqlResult<Option<u64>> {
    let mut rows = Rows::of(TableId::Seal.table(), true);
    let next = "origin = ?1 AND ordinal > ?2 AND ordinal <= ?3 ORDER BY ordinal LIMIT ?4";
    file.each(
        &TableId::Seal.table().read_where(next),
        &values![chain.origin, chain.sent, chain.until, MOST_SEALS],
        |row| rows.take(row),
    )?;
    if rows.count() == 0 {
        return Ok(None);
    }
    server.insert(&rows)?;
    chain.sent += rows.count() as i64;
    Ok(Some(rows.bytes as u64))
}
