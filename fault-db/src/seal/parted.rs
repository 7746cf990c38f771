//! A chain as two places know it: whether one of them has seen more of it, or something else.

use super::head::head_of;
use crate::base::{Base, Row, SqlResult, values};
use crate::id::Id;

/// How a chain here stands to the same chain elsewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Standing {
    /// Nothing is known of it there, or what is known there goes on here, or is the same.
    Continued {
        /// Entries known there.
        known: i64,
    },
    /// What is here goes on there: here is a copy from before, a backup perhaps.
    Behind { here: i64, there: i64 },
    /// Both went on from here by themselves: one is a copy of the other.
    Parted { after: i64 },
    /// After this entry, what was sealed as one thing there is sealed as another here.
    Rewritten { after: i64, what: String, id: Id },
}

/// Compares a chain.
pub(crate) fn standing(here: &Base, there: &Base, origin: Id) -> SqlResult<Standing> {
    let Some((known, last)) = head_of(there, origin)? else {
        return Ok(Standing::Continued { known: 0 });
    };
    let ours = head_of(here, origin)?.map_or(0, |(entries, _)| entries);
    if ours >= known && hash(here, origin, known)?.as_deref() == Some(&last[..]) {
        return Ok(Standing::Continued { known });
    }
    // The hash of an entry stands for all before it: of two chains the same up to somewhere, half of what is
    // left can be left out each time.
    let (mut same, mut end) = (0, ours.min(known));
    while same < end {
        let middle = same + (end - same + 1) / 2;
        let alike = match (hash(here, origin, middle)?, hash(there, origin, middle)?) {
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
        return Ok(Standing::Behind {
            here: ours,
            there: known,
        });
    }
    Ok(match rewritten(here, there, origin, same)? {
        Some((what, id)) => Standing::Rewritten {
            after: same,
            what,
            id,
        },
        None => Standing::Parted { after: same },
    })
}

fn hash(base: &Base, origin: Id, ordinal: i64) -> SqlResult<Option<Vec<u8>>> {
    let sql = "SELECT hash FROM seal WHERE origin = ?1 AND ordinal = ?2";
    base.first(sql, &values![origin, ordinal], |row| row.get(0))
}

/// The first thing sealed there after an entry that this chain seals as something else, if there is one.
fn rewritten(here: &Base, there: &Base, origin: Id, after: i64) -> SqlResult<Option<(String, Id)>> {
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
