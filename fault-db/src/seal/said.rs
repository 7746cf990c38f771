//! What people and the tester say about faults and runs, sealed as it is said.

use serde::{Deserialize, Serialize};

use super::canon::{Canon, take_rows};
use super::{append, hex};
use crate::base::{Base, SqlResult, Value, values};
use crate::id::Id;

/// What an event's row does not keep for ever: two faults may become one, and a laptop that an event came to
/// may have seen less of its fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct EventSays {
    /// The fault it was said of.
    pub fault: String,
    /// Occurrences known then.
    pub seen: i64,
    /// How it came, if it came without a seal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub found: Option<String>,
}

impl EventSays {
    pub fn of(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }

    fn text(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}

const EVENT: &str =
    "SELECT e.id, e.kind, e.at_us, e.who, e.body, e.state, e.turn, e.follows, u.serial, f.code, f.lru
     FROM fault_event e JOIN fault f ON f.seq = e.fault JOIN unit u ON u.seq = f.unit WHERE e.seq = ?1";

/// The digest of an event as it lies there.
pub(crate) fn event_digest(base: &Base, event: i64, says: &str) -> SqlResult<[u8; 32]> {
    let mut hash = Canon::of("event");
    take_rows(&mut hash, base, EVENT, &values![event])?;
    hash.text(says);
    Ok(hash.finish())
}

/// Seals an event of this fault, its fields as they were given, in the order of [`EVENT`], without what
/// follows from the fault.
pub(crate) fn event(
    base: &Base,
    fault: i64,
    id: Id,
    fields: &[Value<'_>],
    seen: i64,
) -> SqlResult<()> {
    let of_fault = base.first(
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
    let says = EventSays {
        fault: of.to_string(),
        seen,
        found: None,
    };
    let says = says.text();
    let mut hash = Canon::of("event");
    hash.values(fields);
    hash.values(&values![serial, code, lru]);
    hash.text(&says);
    append(base, "event", id, &says, hash.finish())
}

/// Seals an event as it is found, since it came without a seal.
pub(crate) fn found_event(base: &Base, event: i64, found: &str) -> SqlResult<()> {
    let sql = "SELECT e.id, f.id, e.seen FROM fault_event e JOIN fault f ON f.seq = e.fault WHERE e.seq = ?1";
    let read = base.first(sql, &values![event], |row| {
        Ok((row.get::<Id>(0)?, row.get::<Id>(1)?, row.get::<i64>(2)?))
    })?;
    let Some((id, fault, seen)) = read else {
        return Ok(());
    };
    let says = EventSays {
        fault: fault.to_string(),
        seen,
        found: Some(found.to_owned()),
    };
    let says = says.text();
    append(base, "event", id, &says, event_digest(base, event, &says)?)
}

const NOTE: &str = "SELECT n.id, r.id, n.at_us, n.who, n.text
     FROM run_note n JOIN run r ON r.seq = n.run WHERE n.seq = ?1";

/// The digest of a note on a run as it lies there.
pub(crate) fn note_digest(base: &Base, note: i64, says: &str) -> SqlResult<[u8; 32]> {
    let mut hash = Canon::of("note");
    take_rows(&mut hash, base, NOTE, &values![note])?;
    hash.text(says);
    Ok(hash.finish())
}

/// Seals a note, its fields as they were given, in the order of [`NOTE`].
pub(crate) fn note(base: &Base, id: Id, fields: &[Value<'_>]) -> SqlResult<()> {
    let mut hash = Canon::of("note");
    hash.values(fields);
    hash.text("");
    append(base, "note", id, "", hash.finish())
}

/// Seals a note as it is found, since it came without a seal.
pub(crate) fn found_note(base: &Base, note: i64, found: &str) -> SqlResult<()> {
    let sql = "SELECT id FROM run_note WHERE seq = ?1";
    let says = serde_json::json!({ "found": found }).to_string();
    match base.first(sql, &values![note], |row| row.get(0))? {
        Some(id) => append(base, "note", id, &says, note_digest(base, note, &says)?),
        None => Ok(()),
    }
}

/// The digest of the row with this number, with what its entry says.
type DigestOf = fn(&Base, i64, &str) -> SqlResult<[u8; 32]>;

/// Of all events or notes up to one, as they lie there: what was not sealed before the fifth schema.
pub(crate) fn earlier(base: &Base, what: Earlier, last: i64) -> SqlResult<EarlierSays> {
    let (seqs, digest): (&str, DigestOf) = match what {
        Earlier::Events => (
            "SELECT seq FROM fault_event WHERE seq <= ?1 ORDER BY seq",
            event_digest,
        ),
        Earlier::Notes => (
            "SELECT seq FROM run_note WHERE seq <= ?1 ORDER BY seq",
            note_digest,
        ),
    };
    let seqs: Vec<i64> = base.select(seqs, &values![last], |row| row.get(0))?;
    let mut all = Canon::new();
    for seq in &seqs {
        all.plain(&digest(base, *seq, "")?);
    }
    Ok(EarlierSays {
        last: seqs.last().copied().unwrap_or(0),
        count: seqs.len(),
        sha256: hex(&all.finish()),
    })
}

/// Which rows.
#[derive(Clone, Copy)]
pub(crate) enum Earlier {
    Events,
    Notes,
}

/// Rows that were there before they were sealed one by one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct EarlierSays {
    /// The number of the last.
    pub last: i64,
    pub count: usize,
    pub sha256: String,
}
