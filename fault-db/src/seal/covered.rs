//! The rows that seals cover: runs, events and notes. Any other entry of a chain covers only its own payload.

use super::canonical::{CanonicalHash, take_rows};
use super::events_and_notes::{EVENT, EventPayload, NOTE, is_of_its_fault};
use super::{append, run};
use crate::backend::{Backend, SqlResult, values};
use crate::id::Id;

/// The kind of a row that a seal covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Covered {
    Run,
    Event,
    Note,
}

impl Covered {
    /// The kind that an entry of a chain names; `None` for an entry that covers no row.
    pub fn of(what: &str) -> Option<Self> {
        [Self::Run, Self::Event, Self::Note]
            .into_iter()
            .find(|kind| kind.word() == what)
    }

    /// The word for the kind in an entry of a chain.
    pub fn word(self) -> &'static str {
        match self {
            Self::Run => "run",
            Self::Event => "event",
            Self::Note => "note",
        }
    }

    pub fn table(self) -> &'static str {
        match self {
            Self::Run => "run",
            Self::Event => "fault_event",
            Self::Note => "run_note",
        }
    }

    /// The digest of a stored row with this payload.
    pub fn digest(self, backend: &Backend, row: i64, payload: &str) -> SqlResult<[u8; 32]> {
        let fields = match self {
            Self::Run => return run::digest(backend, row, payload),
            Self::Event => EVENT,
            Self::Note => NOTE,
        };
        let mut hash = CanonicalHash::of(self.word());
        take_rows(&mut hash, backend, fields, &values![row])?;
        hash.text(payload);
        Ok(hash.finish())
    }

    /// Whether a stored row matches its seal; an event must also belong to the fault for which it was sealed.
    pub fn fits(
        self,
        backend: &Backend,
        row: i64,
        payload: &str,
        digest: &[u8],
    ) -> SqlResult<bool> {
        let is_same = self.digest(backend, row, payload)? == digest;
        Ok(is_same
            && (self != Self::Event
                || is_of_its_fault(backend, row, EventPayload::of(payload).as_ref())?))
    }
}

/// Seals a run, event or note that came without a seal; `found` says how it came.
pub(crate) fn seal_as_found(
    backend: &Backend,
    kind: Covered,
    row: i64,
    found: &str,
) -> SqlResult<()> {
    let id = format!("SELECT id FROM {} WHERE seq = ?1", kind.table());
    let Some(id) = backend.first(&id, &values![row], |row| row.get::<Id>(0))? else {
        return Ok(());
    };
    let payload = match kind {
        Covered::Run => Some(run::payload(backend, row, found)?.text()),
        Covered::Event => EventPayload::found(backend, row, found)?,
        Covered::Note => Some(serde_json::json!({ "found": found }).to_string()),
    };
    let Some(payload) = payload else {
        return Ok(());
    };
    let digest = kind.digest(backend, row, &payload)?;
    append(backend, kind.word(), id, &payload, &digest)
}
