//! Changes of a fault, most of them by users: each is an event. The event graph (`graph_sql`) gives the state.

use crate::backend::{Backend, values};
use crate::error::StoreError;
use crate::history::cases::CaseFault;
use crate::history::event_graph::recompute_fault;
use crate::history::fault_event::{NewEvent, insert_event};
use crate::history::limits;
use crate::id::Id;
use crate::store::Store;
use crate::values::fault_state::{FaultAction, FaultState};
use crate::values::record::{REPAIR, RepairRecord};

/// A change of a fault's state, by a person or by a run that proves a repair.
pub(crate) struct Change<'a> {
    pub action: FaultAction,
    pub kind: &'a str,
    pub who: &'a str,
    pub body: &'a str,
    pub at_us: i64,
}

impl Store {
    /// Acknowledges a fault: somebody works on it.
    pub fn acknowledge(
        &self,
        fault: Id,
        who: &str,
        note: &str,
        at_us: i64,
    ) -> Result<FaultState, StoreError> {
        self.set_state(fault, FaultState::Acknowledged, who, note, at_us)
    }

    /// Changes the state of a fault alone, if its current state allows it.
    pub fn set_state(
        &self,
        fault: Id,
        state: FaultState,
        who: &str,
        note: &str,
        at_us: i64,
    ) -> Result<FaultState, StoreError> {
        let change = Change::towards(state, (who, note), at_us);
        Ok(self.act(fault, &change, false)?.0.state)
    }

    /// Changes the state of a fault, if its current state allows it, and of the other faults of its case that are in
    /// the same state, in one transaction. Returns the fault that was named, and the others.
    pub fn set_case_state(
        &self,
        fault: Id,
        state: FaultState,
        who: &str,
        note: &str,
        at_us: i64,
    ) -> Result<(CaseFault, Vec<CaseFault>), StoreError> {
        self.act(fault, &Change::towards(state, (who, note), at_us), true)
    }

    /// Records a repair of a fault alone. The fault counts as repaired until a passing run verifies it.
    pub fn record_repair(
        &self,
        fault: Id,
        repair: &RepairRecord,
        who: &str,
        at_us: i64,
    ) -> Result<FaultState, StoreError> {
        Ok(self.repair(fault, repair, (who, at_us), false)?.0.state)
    }

    /// Records a repair of a fault and of the other faults of its case, in one transaction. Returns the fault that was
    /// named, and the others.
    pub fn repair_case(
        &self,
        fault: Id,
        repair: &RepairRecord,
        who: &str,
        at_us: i64,
    ) -> Result<(CaseFault, Vec<CaseFault>), StoreError> {
        self.repair(fault, repair, (who, at_us), true)
    }

    fn repair(
        &self,
        fault: Id,
        repair: &RepairRecord,
        (who, at_us): (&str, i64),
        whole_case: bool,
    ) -> Result<(CaseFault, Vec<CaseFault>), StoreError> {
        repair.check()?;
        // Strings only: cannot fail.
        let body = serde_json::to_string(repair).unwrap_or_default();
        let change = Change {
            action: FaultAction::Repair,
            kind: REPAIR,
            who,
            body: &body,
            at_us,
        };
        self.act(fault, &change, whole_case)
    }

    /// Adds a note; the state does not change.
    pub fn add_note(&self, fault: Id, who: &str, note: &str, at_us: i64) -> Result<(), StoreError> {
        const DOING: &str = "storing a note";
        limits::name("the name of who says it", who)?;
        limits::note("the note", note)?;
        let id = self.mint()?;
        self.change(DOING, |_| {
            let seq = self.fault_row(fault)?.seq;
            let event = NewEvent {
                id,
                kind: "note",
                at_us,
                who,
                body: note,
                state: None,
            };
            self.ask(DOING, |backend| insert_event(backend, seq, &event))
        })
    }

    fn act(
        &self,
        fault: Id,
        change: &Change<'_>,
        whole_case: bool,
    ) -> Result<(CaseFault, Vec<CaseFault>), StoreError> {
        limits::name("the name of who says it", change.who)?;
        if change.kind != REPAIR {
            limits::note("the note", change.body)?;
        }
        self.change("changing a fault's state", |_| {
            let named = self.fault_row(fault)?;
            let rest = match whole_case {
                true => self.settled_with(&named, change.action)?,
                false => Vec::new(),
            };
            let named = self.apply(named, change)?;
            let rest = rest.into_iter().map(|of_case| self.apply(of_case, change));
            Ok((named, rest.collect::<Result<_, _>>()?))
        })
    }

    /// Adds the event of a change to one fault, in the caller's transaction.
    pub(crate) fn apply(
        &self,
        fault: CaseFault,
        change: &Change<'_>,
    ) -> Result<CaseFault, StoreError> {
        let to = fault.state.next(change.action);
        let to = to.map_err(|source| StoreError::Transition {
            fault: fault.id,
            source,
        })?;
        let event = NewEvent {
            id: self.mint()?,
            kind: change.kind,
            at_us: change.at_us,
            who: change.who,
            body: change.body,
            state: Some(to),
        };
        self.ask("changing a fault's state", |backend| {
            insert_event(backend, fault.seq, &event)?;
            // On a server clients may not write derived columns.
            if let Backend::Server(_) = backend {
                return recompute_fault(backend, fault.seq);
            }
            let closed_at_us = (to == FaultState::Closed).then_some(change.at_us);
            backend.execute(
                "UPDATE fault SET state = ?2, closed_at_us = ?3 WHERE seq = ?1",
                &values![fault.seq, to, closed_at_us],
            )?;
            Ok(())
        })?;
        Ok(CaseFault { state: to, ..fault })
    }
}

impl<'a> Change<'a> {
    fn towards(state: FaultState, (who, note): (&'a str, &'a str), at_us: i64) -> Self {
        let action = FaultAction::towards(state);
        Self {
            action,
            kind: action.event_kind(),
            who,
            body: note,
            at_us,
        }
    }
}
