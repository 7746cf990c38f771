//! Compares two copies of one chain: equal, one ahead of the other, forked, or rewritten.

use super::head::head_of;
use crate::backend::{Backend, Row, SqlResult, values};
use crate::id::Id;

/// How a chain here compares with the same chain elsewhere (`there`).
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ChainComparison {
    /// The chain there is missing, equal, or the beginning of this one.
    Extends {
        /// Number of entries there.
        known: i64,
    },
    /// This chain is the beginning of the one there: an older copy, perhaps a backup.
    Behind { here: i64, there: i64 },
    /// The chains have different entries after entry `after`: one of the files is a copy of the other.
    Forked { after: i64 },
    /// After entry `after`, a run, event or note is sealed with another digest here than there.
    Rewritten { after: i64, what: String, id: Id },
}

/// Compares all chains known here, in the order of their files' ids.
pub(crate) fn compare_all_chains(
    here: &Backend,
    there: &Backend,
) -> SqlResult<Vec<(Id, ChainComparison)>> {
    let all = "SELECT DISTINCT origin FROM seal ORDER BY origin";
    let origins: Vec<Id> = here.select(all, &[], |row| row.get(0))?;
    let compare = |origin| Ok((origin, compare_chains(here, there, origin)?));
    origins.into_iter().map(compare).collect()
}

pub(crate) fn compare_chains(
    here: &Backend,
    there: &Backend,
    origin: Id,
) -> SqlResult<ChainComparison> {
    let Some((known, last)) = head_of(there, origin)? else {
        return Ok(ChainComparison::Extends { known: 0 });
    };
    let ours = head_of(here, origin)?.map_or(0, |(entries, _)| entries);
    if ours >= known && hash_of(here, origin, known)?.as_deref() == Some(&last[..]) {
        return Ok(ChainComparison::Extends { known });
    }
    // The hash of an entry covers all before it, so the last common entry is found by binary search.
    let (mut same, mut end) = (0, ours.min(known));
    while same < end {
        let middle = same + (end - same + 1) / 2;
        let alike = match (
            hash_of(here, origin, middle)?,
            hash_of(there, origin, middle)?,
        ) {
            (Some(ours), Some(theirs)) => ours == theirs,
            _ => false,
        };
        if alike {
            same = middle;
        } else {
            end = middle - 1;
        }
    }
    if same == ours {
        return Ok(ChainComparison::Behind {
            here: ours,
            there: known,
        });
    }
    Ok(match rewritten(here, there, origin, same)? {
        Some((what, id)) => ChainComparison::Rewritten {
            after: same,
            what,
            id,
        },
        None => ChainComparison::Forked { after: same },
    })
}

/// The hash of an entry of a chain.
pub(crate) fn hash_of(backend: &Backend, origin: Id, ordinal: i64) -> SqlResult<Option<Vec<u8>>> {
    let sql = "SELECT hash FROM seal WHERE origin = ?1 AND ordinal = ?2";
    backend.first(sql, &values![origin, ordinal], |row| row.get(0))
}

/// The first run, event or note after an entry that both chains seal with different digests.
fn rewritten(
    here: &Backend,
    there: &Backend,
    origin: Id,
    after: i64,
) -> SqlResult<Option<(String, Id)>> {
    let sealed = "SELECT what, id, digest FROM seal
        WHERE origin = ?1 AND ordinal > ?2 AND what IN ('run', 'event', 'note')
            AND says NOT LIKE '%found%' ORDER BY ordinal";
    let read = |row: Row<'_>| {
        Ok((
            row.get::<String>(0)?,
            row.get::<Id>(1)?,
            row.get::<Vec<u8>>(2)?,
        ))
    };
    let same =
        "SELECT digest FROM seal WHERE origin = ?1 AND ordinal > ?2 AND what = ?3 AND id = ?4
            AND says NOT LIKE '%found%'";
    for (what, id, digest) in there.select(sealed, &values![origin, after], read)? {
        let place = values![origin, after, &what, id];
        let ours: Option<Vec<u8>> = here.first(same, &place, |row| row.get(0))?;
        if ours.is_some_and(|ours| ours != digest) {
            return Ok(Some((what, id)));
        }
    }
    Ok(None)
}
