//! Faults that somebody saw again without knowing that they had been repaired or closed.
//!
//! In one file a repaired fault that is seen again opens at once. Two laptops find out only when they
//! meet: then it is said for both, so that neither the repair nor what was seen is forgotten. What came
//! first is told by the clocks; a server sets each right by how far it was off its own.

use sha2::{Digest as _, Sha256};

use crate::base::{Base, Server, SqlResult, values};
use crate::fault_log::{Known, NewEvent, insert_knowing};
use crate::fault_state::{FaultAction, FaultState};
use crate::id::Id;
use crate::settle::last_words;

/// Last words by which a fault of a file was done with, and when it was first seen after that, if it was seen
/// more often than was known then.
const IN_FILE: &str = concat!(
    "SELECT e.fault, e.id, e.turn, o.at_us, o.message FROM fault f, fault_occurrence o, ",
    last_words!("?1"),
    " AND e.state IN ('repaired', 'verified', 'closed') AND f.seq = e.fault AND f.occurrences > e.seen
        AND o.seq = (SELECT x.seq FROM fault_occurrence x WHERE x.fault = e.fault AND x.at_us > e.at_us
            ORDER BY x.at_us, x.id LIMIT 1)
     ORDER BY e.id"
);

/// Last words by which these faults of a server were done with, and when another laptop than the one where
/// that was said first saw them after it: if either has come after `$2`, the last event, and `$3`, the last
/// occurrence that were here. What both were here has been judged, by the clocks of that time. An occurrence of
/// no time, from before the server refused such, is no answer to anything.
const ON_SERVER: &str = concat!(
    "SELECT f.seq, done.id, done.turn, seen.at_us, seen.message FROM fault f
        CROSS JOIN LATERAL (
            SELECT e.seq, e.id, e.turn, e.laptop, near(e.at_us) - coalesce(
                (SELECT l.clock_offset_us FROM laptop l WHERE l.seq = e.laptop), 0) AS at_us
            FROM ",
    last_words!("f.seq"),
    " AND e.state IN ('repaired', 'verified', 'closed')
        ) AS done
        CROSS JOIN LATERAL (
            SELECT o.at_us, o.message FROM fault_occurrence o
                JOIN run r ON r.seq = o.run JOIN laptop l ON l.seq = r.laptop
            WHERE o.fault = f.seq AND r.laptop IS DISTINCT FROM done.laptop AND is_time(o.at_us)
                AND near(o.at_us) - l.clock_offset_us > done.at_us AND (done.seq > $2 OR o.seq > $3)
            ORDER BY near(o.at_us) - l.clock_offset_us, o.id LIMIT 1
        ) AS seen
     WHERE f.seq = ANY($1) ORDER BY f.seq, done.id"
);

/// What was seen too late for somebody who was done with a fault.
struct Seen {
    fault: i64,
    /// The event that it takes back, and its turn.
    done: Id,
    turn: i64,
    at_us: i64,
    message: String,
}

/// Takes back what was said too early about a fault of a file; whether anything was. Runs in the caller's
/// transaction; the fault is to be settled after it.
pub(crate) fn open_again(base: &Base, fault: i64) -> SqlResult<bool> {
    let all = base.select(IN_FILE, &values![fault], |row| {
        Ok(Seen {
            fault: row.get(0)?,
            done: row.get(1)?,
            turn: row.get(2)?,
            at_us: row.get(3)?,
            message: row.get(4)?,
        })
    })?;
    all.iter().try_for_each(|seen| answer(base, seen))?;
    Ok(!all.is_empty())
}

/// The last event and the last occurrence of a server.
#[derive(Clone, Copy)]
pub(crate) struct Mark {
    event: i64,
    occurrence: i64,
}

impl Mark {
    /// Before anything is added, by who alone may add.
    pub fn of(base: &Base) -> SqlResult<Self> {
        let found = base.first(
            "SELECT coalesce((SELECT max(seq) FROM fault_event), 0),
                coalesce((SELECT max(seq) FROM fault_occurrence), 0)",
            &[],
            |row| Ok((row.get(0)?, row.get(1)?)),
        )?;
        let (event, occurrence) = found.unwrap_or_default();
        Ok(Self { event, occurrence })
    }
}

/// The same of faults of a server, as far as either is new since the mark; which faults they were.
pub(crate) fn open_again_of(
    base: &Base,
    server: &Server,
    faults: &[i64],
    mark: Mark,
) -> SqlResult<Vec<i64>> {
    let mut opened = Vec::new();
    let found = server.select_columns(ON_SERVER, &[&faults, &mark.event, &mark.occurrence])?;
    for row in found {
        let done: &[u8] = row.try_get(1)?;
        let Ok(done) = done.try_into().map(Id::from_bytes) else {
            continue;
        };
        let seen = Seen {
            fault: row.try_get(0)?,
            done,
            turn: row.try_get(2)?,
            at_us: row.try_get(3)?,
            message: row.try_get(4)?,
        };
        answer(base, &seen)?;
        opened.push(seen.fault);
    }
    opened.dedup();
    Ok(opened)
}

/// The answer to each is its own, and the same wherever it is found out.
fn answer(base: &Base, seen: &Seen) -> SqlResult<()> {
    let event = NewEvent {
        id: answer_to(seen.done, seen.at_us),
        kind: FaultAction::Occur.event_kind(),
        at_us: seen.at_us,
        who: "",
        body: &seen.message,
        state: Some(FaultState::Open),
    };
    let known = Known {
        follows: seen.done.as_bytes().to_vec(),
        turn: seen.turn + 1,
        seen: 0,
    };
    insert_knowing(base, seen.fault, &event, &known)
}

/// The id of the event that takes back another: nobody was there to make one.
fn answer_to(done: Id, at_us: i64) -> Id {
    let hash = Sha256::new()
        .chain_update(b"recurred")
        .chain_update(done.as_bytes())
        .finalize();
    let mut random = [0; 10];
    random.copy_from_slice(&hash[..10]);
    Id::mint(at_us.unsigned_abs() / 1000, random)
}
