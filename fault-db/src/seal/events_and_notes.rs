//! Seals of fault events and of notes on runs, made when they are stored.

use serde::{Deserialize, Serialize};

use super::append;
use super::canonical::CanonicalHash;
use crate::backend::{Backend, SqlResult, Value, values};
use crate::id::Id;

/// Sealed fields of an event that its row may lose: its fault may be merged with another, and a laptop that receives
/// the event may know fewer occurrences of the fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct EventPayload {
    /// Id of the event's fault when the event was made.
    pub fault: String,
    /// Number of occurrences known when the event was made. The key `seen` is part of what is hashed.
    #[serde(rename = "seen")]
    pub occurrences_known: i64,
    /// How the event came (`import`, `sync`), if it came without a seal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub found: Option<String>,
}

impl EventPayload {
    pub fn of(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }

    /// The payload of a stored event that is sealed as found, as text; `None` of an event without a fault.
    pub fn found(backend: &Backend, event: i64, found: &str) -> SqlResult<Option<String>> {
        let sql = "SELECT f.id, e.seen FROM fault_event e JOIN fault f ON f.seq = e.fault WHERE e.seq = ?1";
        let payload = backend.first(sql, &values![event], |row| {
            Ok(Self {
                fault: row.get::<Id>(0)?.to_string(),
                occurrences_known: row.get(1)?,
                found: Some(found.to_owned()),
            })
        })?;
        Ok(payload.map(|payload| payload.text()))
    }

    fn text(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// SQL: the sealed fields of an event, and of its fault.
pub(super) const EVENT: &str =
    "SELECT e.id, e.kind, e.at_us, e.who, e.body, e.state, e.turn, e.follows, u.serial, f.code, f.lru
     FROM fault_event e JOIN fault f ON f.seq = e.fault JOIN unit u ON u.seq = f.unit WHERE e.seq = ?1";

/// Whether an event belongs to the fault for which it was sealed, with no more known occurrences than were sealed.
pub(crate) fn is_of_its_fault(
    backend: &Backend,
    event: i64,
    payload: Option<&EventPayload>,
) -> SqlResult<bool> {
    let Some((payload, of)) =
        payload.and_then(|payload| Some((payload, payload.fault.parse::<Id>().ok()?)))
    else {
        return Ok(false);
    };
    backend.has(
        "SELECT 1 FROM fault_event e JOIN fault f ON f.seq = e.fault
         WHERE e.seq = ?1 AND e.seen <= ?3
            AND (f.id = ?2 OR EXISTS (SELECT 1 FROM fault_alias a WHERE a.id = ?2 AND a.fault = f.seq))",
        &values![event, of, payload.occurrences_known],
    )
}

/// Seals an event of a fault; `fields` are the event's own, in the order of [`EVENT`].
pub(crate) fn event(
    backend: &Backend,
    fault: i64,
    id: Id,
    fields: &[Value<'_>],
    occurrences_known: i64,
) -> SqlResult<()> {
    let of_fault = backend.first(
        "SELECT f.id, u.serial, f.code, f.lru FROM fault f JOIN unit u ON u.seq = f.unit
         WHERE f.seq = ?1",
        &values![fault],
        |row| {
            Ok((
                row.get::<Id>(0)?,
                row.get::<String>(1)?,
                row.get::<i64>(2)?,
                row.get::<String>(3)?,
            ))
        },
    )?;
    let Some((of, serial, code, lru)) = of_fault else {
        return Ok(());
    };
    let payload = EventPayload {
        fault: of.to_string(),
        occurrences_known,
        found: None,
    };
    let payload = payload.text();
    let mut hash = CanonicalHash::of("event");
    hash.values(fields);
    hash.values(&values![serial, code, lru]);
    hash.text(&payload);
    append(backend, "event", id, &payload, &hash.finish())
}

/// SQL: the sealed fields of a note.
pub(super) const NOTE: &str = "SELECT n.id, r.id, n.at_us, n.who, n.trace, n.place_us, n.text
     FROM run_note n JOIN run r ON r.seq = n.run WHERE n.seq = ?1";

/// Seals a note; `fields` are in the order of [`NOTE`].
pub(crate) fn note(backend: &Backend, id: Id, fields: &[Value<'_>]) -> SqlResult<()> {
    let mut hash = CanonicalHash::of("note");
    hash.values(fields);
    hash.text("");
    append(backend, "note", id, "", &hash.finish())
}
