//! Recurrences found by replication: a fault occurred again on one laptop after it had been repaired or
//! closed on another.
//!
//! In one file a new occurrence of a repaired fault reopens it at once. Two laptops find out when their histories meet:
//! then a `recurred` event is added, the same on either side, so that neither the repair nor the occurrence is lost.
//! Time stamps decide which came first; a server corrects each by the clock offset of its laptop.

use sha2::{Digest as _, Sha256};

use crate::backend::{Backend, Row, SqlError, SqlResult, from_row, values};
use crate::history::fault_event::{EventContext, NewEvent, insert_event_with_context};
use crate::history::graph_sql::heads;
use crate::id::Id;
use crate::values::fault_state::{FaultAction, FaultState};

/// SQL: heads that resolved fault `?1` of a file, each with the first occurrence after it, if the fault has more
/// occurrences than the head's author knew.
const RECURRED_IN_FILE: &str = concat!(
    "SELECT e.fault, e.id, e.turn, o.at_us, o.message FROM fault f, fault_occurrence o, ",
    heads!("?1"),
    " AND e.state IN ('repaired', 'verified', 'closed') AND f.seq = e.fault AND f.occurrences > e.seen
        AND o.seq = (SELECT x.seq FROM fault_occurrence x WHERE x.fault = e.fault AND x.at_us > e.at_us
            ORDER BY x.at_us, x.id LIMIT 1)
     ORDER BY e.id"
);

/// SQL: heads that resolved these faults of a server, each with the first later occurrence on another laptop than the
/// author's. Only pairs of which the head is newer than event `$2` or the occurrence newer than `$3`: older pairs were
/// judged before, with the clock offsets of their time. Occurrences with an invalid time, stored by an early version of
/// the server, are ignored.
const RECURRED_ON_SERVER: &str = concat!(
    "SELECT f.seq, done.id, done.turn, seen.at_us, seen.message FROM fault f
        CROSS JOIN LATERAL (
            SELECT e.seq, e.id, e.turn, e.laptop, near(e.at_us) - coalesce(
                (SELECT l.clock_offset_us FROM laptop l WHERE l.seq = e.laptop), 0) AS at_us
            FROM ",
    heads!("f.seq"),
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

/// An occurrence after a resolution whose author did not know of it.
struct Recurrence {
    fault: i64,
    /// The event that resolved the fault, and its Lamport number.
    resolution: Id,
    lamport: i64,
    at_us: i64,
    message: String,
}

/// Row numbers of the last event and the last occurrence of a store.
#[derive(Clone, Copy)]
pub(crate) struct HighWaterMark {
    event: i64,
    occurrence: i64,
}

impl HighWaterMark {
    /// Reads the mark; call it under the writers' lock, before anything is added.
    pub fn of(backend: &Backend) -> SqlResult<Self> {
        let found = backend.first(
            "SELECT coalesce((SELECT max(seq) FROM fault_event), 0),
                coalesce((SELECT max(seq) FROM fault_occurrence), 0)",
            &[],
            |row| Ok((row.get(0)?, row.get(1)?)),
        )?;
        let (event, occurrence) = found.unwrap_or_default();
        Ok(Self { event, occurrence })
    }
}

/// Adds `recurred` events to these faults; returns the faults that were reopened. On a server only pairs are judged of
/// which the event or the occurrence is newer than the mark. Runs in the caller's transaction, which has to recompute
/// the faults afterwards.
pub(crate) fn reopen_recurred(
    backend: &Backend,
    faults: &[i64],
    mark: HighWaterMark,
) -> SqlResult<Vec<i64>> {
    let mut found = Vec::new();
    match backend {
        Backend::File(_) => {
            for fault in faults {
                found.extend(backend.select(RECURRED_IN_FILE, &values![*fault], read)?);
            }
        }
        Backend::Server(server) => {
            let marks: [&(dyn postgres::types::ToSql + Sync); 3] =
                [&faults, &mark.event, &mark.occurrence];
            for row in server.select_columns(RECURRED_ON_SERVER, &marks)? {
                match read(Row::Server(&row)) {
                    // An invalid id, which an early version of the server accepted.
                    Err(SqlError::Value { .. }) => {}
                    recurrence => found.push(recurrence?),
                }
            }
        }
    }
    for recurrence in &found {
        insert_recurrence(backend, recurrence)?;
    }
    let mut reopened: Vec<i64> = found.iter().map(|recurrence| recurrence.fault).collect();
    reopened.dedup();
    Ok(reopened)
}

fn read(row: Row<'_>) -> SqlResult<Recurrence> {
    Ok(from_row!(row => Recurrence: fault, resolution, lamport, at_us, message))
}

/// Adds the event of a recurrence, with the same id in whatever store it is found.
fn insert_recurrence(backend: &Backend, recurrence: &Recurrence) -> SqlResult<()> {
    let event = NewEvent {
        id: recurrence_id(recurrence.resolution, recurrence.at_us),
        kind: FaultAction::Occur.event_kind(),
        at_us: recurrence.at_us,
        who: "",
        body: &recurrence.message,
        state: Some(FaultState::Open),
    };
    let context = EventContext {
        parents: recurrence.resolution.as_bytes().to_vec(),
        lamport: recurrence.lamport + 1,
        occurrences_known: 0,
    };
    insert_event_with_context(backend, recurrence.fault, &event, &context)
}

/// The id of a `recurred` event, derived from the event it answers: no person made it.
fn recurrence_id(resolution: Id, at_us: i64) -> Id {
    let hash = Sha256::new()
        .chain_update(b"recurred")
        .chain_update(resolution.as_bytes())
        .finalize();
    let mut random = [0; 10];
    random.copy_from_slice(&hash[..10]);
    Id::mint(at_us.unsigned_abs() / 1000, random)
}
