//! Changes of a fault by users and by runs: each is an event, and the newest event gives the state.

use crate::backend::{Backend, values};
use crate::error::StoreError;
use crate::event_graph::recompute_fault;
use crate::fault_event::{NewEvent, insert_event};
use crate::fault_state::{FaultAction, FaultState};
use crate::id::Id;
use crate::limits;
use crate::record::{REPAIR, RepairRecord};
use crate::store::Store;

impl Store {
    /// Acknowledges a fault: somebody works on it.
    pub fn acknowledge(
        &self,
        fault: Id,
        who: &str,
        note: &str,
        at_us: i64,
    ) -> Result<FaultState, StoreError> {
        limits::note("the note", note)?;
        self.act(fault, FaultAction::Acknowledge, None, who, note, at_us)
    }

    /// Changes the state of a fault, if its current state allows it.
    pub fn set_state(
        &self,
        fault: Id,
        state: FaultState,
        who: &str,
        note: &str,
        at_us: i64,
    ) -> Result<FaultState, StoreError> {
        limits::note("the note", note)?;
        self.act(fault, FaultAction::towards(state), None, who, note, at_us)
    }

    /// Records a repair. The fault counts as repaired until a passing run verifies it.
    pub fn record_repair(
        &self,
        fault: Id,
        repair: &RepairRecord,
        who: &str,
        at_us: i64,
    ) -> Result<FaultState, StoreError> {
        repair.check()?;
        // Strings only: cannot fail.
        let body = serde_json::to_string(repair).unwrap_or_default();
        self.act(fault, FaultAction::Repair, Some(REPAIR), who, &body, at_us)
    }

    /// Adds a note; the state does not change.
    pub fn add_note(&self, fault: Id, who: &str, note: &str, at_us: i64) -> Result<(), StoreError> {
        const DOING: &str = "storing a note";
        limits::name("the name of who says it", who)?;
        limits::note("the note", note)?;
        let id = self.mint()?;
        self.change(DOING, |backend| {
            let (seq, _) = self.fault_row(fault)?;
            let event = NewEvent {
                id,
                kind: "note",
                at_us,
                who,
                body: note,
                state: None,
            };
            insert_event(backend, seq, &event).map_err(|error| self.failed(DOING, error))
        })
    }

    fn act(
        &self,
        fault: Id,
        action: FaultAction,
        kind: Option<&str>,
        who: &str,
        body: &str,
        at_us: i64,
    ) -> Result<FaultState, StoreError> {
        const DOING: &str = "changing a fault's state";
        limits::name("the name of who says it", who)?;
        let id = self.mint()?;
        self.change(DOING, |backend| {
            let (seq, from) = self.fault_row(fault)?;
            let to = from.next(action);
            let to = to.map_err(|source| StoreError::Transition { fault, source })?;
            let kind = kind.unwrap_or(action.event_kind());
            let event = NewEvent {
                id,
                kind,
                at_us,
                who,
                body,
                state: Some(to),
            };
            let work = || {
                insert_event(backend, seq, &event)?;
                // On a server clients may not write derived columns.
                if let Backend::Server(_) = backend {
                    return recompute_fault(backend, seq);
                }
                backend.execute(
                    "UPDATE fault SET state = ?2, closed_at_us = ?3 WHERE seq = ?1",
                    &values![seq, to, (to == FaultState::Closed).then_some(at_us)],
                )?;
                Ok(())
            };
            work().map_err(|error| self.failed(DOING, error))?;
            Ok(to)
        })
    }

    fn fault_row(&self, fault: Id) -> Result<(i64, FaultState), StoreError> {
        let found = self.first(
            "looking up a fault",
            "SELECT seq, state FROM fault WHERE id = ?1
             UNION ALL SELECT f.seq, f.state FROM fault_alias a JOIN fault f ON f.seq = a.fault
                WHERE a.id = ?1",
            &values![fault],
            |row| Ok((row.get(0)?, row.get(1)?)),
        )?;
        found.ok_or_else(|| StoreError::not_found("fault", fault))
    }
}
