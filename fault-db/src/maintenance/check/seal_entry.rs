//! Reads the entries of the chains in order, and checks each one's position and hash.

use crate::backend::{Backend, Row, SqlResult, from_row, values};
use crate::error::{Damage, SealPlace, time};
use crate::id::Id;
use crate::seal::chained;

/// Seals read at a time, which bounds the memory used.
pub(super) const SEALS_PER_BATCH: usize = 1_000;

/// A seal as stored, with the row number of what it covers, if that exists.
pub(super) struct Seal {
    pub origin: Id,
    pub ordinal: i64,
    pub what: String,
    pub id: Id,
    pub payload: String,
    pub digest: Vec<u8>,
    pub hash: Vec<u8>,
    pub row: Option<i64>,
}

/// The error in a seal's number or hash, if any; `before` is the seal before it in the chain.
pub(super) fn position_error(seal: &Seal, before: Option<&Seal>) -> Option<Damage> {
    let expected = before.map_or(1, |before| before.ordinal + 1);
    if seal.ordinal != expected {
        let last = seal.ordinal - 1;
        let missing = if last > expected {
            format!("{expected} to {last}")
        } else {
            expected.to_string()
        };
        return Some(Damage::NoSeals(seal.place(), missing));
    }
    let hash = chained(before.map(|before| &before.hash[..]), &seal.digest);
    (hash != seal.hash[..]).then(|| Damage::Unchained(seal.place(), seal.what.clone(), seal.id))
}

/// Tolerance, µs, of times of one clock against the order of their seals.
const IN_ORDER_US: i64 = 60_000_000;

/// The remark on a clock that went backward between a run or note and the one sealed before it in the chain. Entries
/// sealed as found, and entries of a unit's log, have times of another clock and are left out.
pub(super) fn clock_error(
    backend: &Backend,
    origin: Id,
    ordinal: i64,
) -> SqlResult<Option<String>> {
    let sql = "SELECT s.ordinal, s.what, s.id, coalesce(r.finished_at_us, n.at_us) FROM seal s
        LEFT JOIN run r ON s.what = 'run' AND r.id = s.id AND r.source NOT LIKE 'log of%'
        LEFT JOIN run_note n ON s.what = 'note' AND n.id = s.id
        WHERE s.origin = ?1 AND s.ordinal <= ?2 AND s.what IN ('run', 'note') AND s.says NOT LIKE '%\"found\":\"%'
        ORDER BY s.ordinal DESC LIMIT 2";
    let last = backend.select(sql, &values![origin, ordinal], |row| {
        let named = format!("{} {}", row.get::<String>(1)?, row.get::<Id>(2)?);
        Ok((row.get::<i64>(0)?, named, row.get::<Option<i64>>(3)?))
    })?;
    let [(this, name, Some(at)), (_, earlier, Some(before))] = &last[..] else {
        return Ok(None);
    };
    let is_back = *this == ordinal && at.saturating_add(IN_ORDER_US) < *before;
    Ok(is_back.then(|| {
        format!(
            "the clock went backward: {name} is dated {}, and was sealed after {earlier}, dated {}",
            time(*at),
            time(*before)
        )
    }))
}

impl Seal {
    pub fn place(&self) -> SealPlace {
        SealPlace {
            file: self.origin,
            entry: self.ordinal,
        }
    }
}

pub(super) fn seals_after(backend: &Backend, last: Option<&Seal>) -> SqlResult<Vec<Seal>> {
    let (origin, ordinal) = last.map_or((&[][..], 0), |last| {
        (&last.origin.as_bytes()[..], last.ordinal)
    });
    let sql = format!(
        "{SEALS} WHERE (s.origin, s.ordinal) > (?1, ?2) ORDER BY s.origin, s.ordinal LIMIT {SEALS_PER_BATCH}"
    );
    backend.select(&sql, &values![origin, ordinal], seal)
}

/// The seals of this kind and id, in all chains.
pub(super) fn seals_of(backend: &Backend, what: &str, id: Id) -> SqlResult<Vec<Seal>> {
    let sql = format!("{SEALS} WHERE s.id = ?1 AND s.what = ?2 ORDER BY s.origin, s.ordinal");
    backend.select(&sql, &values![id, what], seal)
}

const SEALS: &str = "SELECT s.origin, s.ordinal, s.what, s.id, s.says, s.digest, s.hash,
        CASE s.what WHEN 'run' THEN (SELECT r.seq FROM run r WHERE r.id = s.id)
            WHEN 'event' THEN (SELECT e.seq FROM fault_event e WHERE e.id = s.id)
            WHEN 'note' THEN (SELECT n.seq FROM run_note n WHERE n.id = s.id) END
     FROM seal s";

fn seal(row: Row<'_>) -> SqlResult<Seal> {
    Ok(from_row!(row => Seal: origin, ordinal, what, id, payload, digest, hash, row))
}
