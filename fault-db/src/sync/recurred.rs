//! Faults that a laptop saw again without knowing that somebody had repaired or closed them.
//!
//! In one file a repaired fault that is seen again opens at once. Two laptops find out only when they
//! meet: then the server says it for both, so that neither the repair nor what was seen is forgotten. What
//! came first is told by the clocks, each set right by how far it was off the server's.

use sha2::{Digest as _, Sha256};

use super::ledger::Laptop;
use super::rows::Rows;
use crate::base::{Base, Server, SqlResult};
use crate::fault_log::NewEvent;
use crate::fault_state::{FaultAction, FaultState};
use crate::id::Id;
use crate::server::said;

/// Faults of these occurrences that count as done, when they were seen, and what was seen.
const SEEN_AFTER: &str = "
    SELECT k.fault, max(x.at_us), (array_agg(x.message ORDER BY x.at_us DESC))[1], done.id
    FROM {rows} JOIN laptop_fault k ON k.laptop = {laptop} AND k.id = x.fault
        JOIN fault f ON f.seq = k.fault AND f.state IN ('repaired', 'verified', 'closed')
        CROSS JOIN LATERAL (
            SELECT e.id, e.laptop, e.at_us - coalesce(l.clock_offset_us, 0) AS at_us
            FROM fault_event e LEFT JOIN laptop l ON l.seq = e.laptop
            WHERE e.fault = f.seq AND e.state IS NOT NULL ORDER BY e.turn DESC, e.seq DESC LIMIT 1
        ) AS done
    WHERE done.laptop IS DISTINCT FROM {laptop} AND x.at_us - {offset} > done.at_us
    GROUP BY k.fault, done.id ORDER BY k.fault";

/// The id of the event that takes back another: nobody was there to make one.
fn answer_to(done: &[u8], at_us: i64) -> Id {
    let hash = Sha256::new()
        .chain_update(b"recurred")
        .chain_update(done)
        .finalize();
    let mut random = [0; 10];
    random.copy_from_slice(&hash[..10]);
    Id::mint(at_us.unsigned_abs() / 1000, random)
}

/// Opens them again; which they were. Runs after the faults were settled, in the caller's transaction.
pub(super) fn open_again(
    base: &Base,
    server: &Server,
    laptop: &Laptop,
    occurrences: &Rows,
) -> SqlResult<Vec<i64>> {
    let sql = SEEN_AFTER.replace("{offset}", &laptop.clock_offset_us.to_string());
    let mut faults = Vec::new();
    for row in occurrences.ask(server, laptop.seq, &sql)? {
        let (fault, at_us): (i64, i64) = (row.try_get(0)?, row.try_get(1)?);
        let (message, done): (String, &[u8]) = (row.try_get(2)?, row.try_get(3)?);
        let event = NewEvent {
            id: answer_to(done, at_us),
            kind: FaultAction::Occur.event_kind(),
            at_us,
            who: "",
            body: &message,
            state: Some(FaultState::Open),
        };
        said::insert_event(base, fault, &event)?;
        faults.push(fault);
    }
    Ok(faults)
}
