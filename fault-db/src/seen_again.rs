//! Faults that somebody saw again without knowing that they had been repaired or closed.
//!
//! In one file a repaired fault that is seen again opens at once. Two laptops find out only when they
//! meet: then it is said for both, so that neither the repair nor what was seen is forgotten. What came
//! first is told by the clocks; a server sets each right by how far it was off its own.

use sha2::{Digest as _, Sha256};

use crate::base::{Base, Server, SqlResult, values};
use crate::fault_log::{NewEvent, insert_event};
use crate::fault_state::{FaultAction, FaultState};
use crate::id::Id;
use crate::settle::last_words;

/// A fault of a file that counts as done: when it was last seen after that, if it was seen more often than
/// was known then.
const IN_FILE: &str = concat!(
    "SELECT o.at_us, o.message, done.id
     FROM fault f, fault_occurrence o, (SELECT e.id, e.at_us, e.seen FROM ",
    last_words!("?1"),
    " AND e.kind <> 'opened' ORDER BY e.at_us DESC, e.id LIMIT 1) AS done
     WHERE f.seq = ?1 AND f.state IN ('repaired', 'verified', 'closed') AND f.occurrences > done.seen
        AND o.fault = f.seq AND o.at_us > done.at_us
     ORDER BY o.at_us DESC, o.id LIMIT 1"
);

/// Of these faults of a server those that count as done, and when another laptop than the one where that
/// was said last saw them after it.
const ON_SERVER: &str = concat!(
    "SELECT f.seq, seen.at_us, seen.message, done.id FROM fault f
        CROSS JOIN LATERAL (
            SELECT e.id, e.laptop, e.at_us - coalesce(
                (SELECT l.clock_offset_us FROM laptop l WHERE l.seq = e.laptop), 0) AS at_us
            FROM ",
    last_words!("f.seq"),
    " AND e.kind <> 'opened' ORDER BY 3 DESC, e.id LIMIT 1
        ) AS done
        CROSS JOIN LATERAL (
            SELECT o.at_us, o.message FROM fault_occurrence o
                JOIN run r ON r.seq = o.run JOIN laptop l ON l.seq = r.laptop
            WHERE o.fault = f.seq AND r.laptop IS DISTINCT FROM done.laptop
                AND o.at_us - l.clock_offset_us > done.at_us
            ORDER BY o.at_us - l.clock_offset_us DESC, o.id LIMIT 1
        ) AS seen
     WHERE f.seq = ANY($1) AND f.state IN ('repaired', 'verified', 'closed') ORDER BY f.seq"
);

/// What was seen too late for those who were done with a fault.
struct Seen {
    fault: i64,
    at_us: i64,
    message: String,
    /// The event that it takes back.
    done: Id,
}

/// Opens a fault of a file again, if it was seen; runs after it was settled, in the caller's transaction.
pub(crate) fn open_again(base: &Base, fault: i64) -> SqlResult<bool> {
    let seen = base.first(IN_FILE, &values![fault], |row| {
        Ok(Seen {
            fault,
            at_us: row.get(0)?,
            message: row.get(1)?,
            done: row.get(2)?,
        })
    })?;
    seen.as_ref()
        .map_or(Ok(()), |seen| answer(base, seen))
        .map(|()| seen.is_some())
}

/// Opens faults of a server again, of these; which they were.
pub(crate) fn open_again_of(base: &Base, server: &Server, faults: &[i64]) -> SqlResult<Vec<i64>> {
    let mut opened = Vec::new();
    for row in server.select_columns(ON_SERVER, &[&faults])? {
        let done: &[u8] = row.try_get(3)?;
        let Ok(done) = done.try_into().map(Id::from_bytes) else {
            continue;
        };
        let seen = Seen {
            fault: row.try_get(0)?,
            at_us: row.try_get(1)?,
            message: row.try_get(2)?,
            done,
        };
        answer(base, &seen)?;
        opened.push(seen.fault);
    }
    Ok(opened)
}

fn answer(base: &Base, seen: &Seen) -> SqlResult<()> {
    let event = NewEvent {
        id: answer_to(seen.done, seen.at_us),
        kind: FaultAction::Occur.event_kind(),
        at_us: seen.at_us,
        who: "",
        body: &seen.message,
        state: Some(FaultState::Open),
    };
    insert_event(base, seen.fault, &event)
}

/// The id of the event that takes back another, the same wherever it is found out: nobody was there to make
/// one.
fn answer_to(done: Id, at_us: i64) -> Id {
    let hash = Sha256::new()
        .chain_update(b"recurred")
        .chain_update(done.as_bytes())
        .finalize();
    let mut random = [0; 10];
    random.copy_from_slice(&hash[..10]);
    Id::mint(at_us.unsigned_abs() / 1000, random)
}
