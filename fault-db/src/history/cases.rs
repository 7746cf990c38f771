//! Cases: the faults of a unit that are not closed and that one part explains.
//!
//! A case has no row of its own. An event `cause` (of a person) or `diagnosed` (of a run) attributes a fault to a part,
//! and is merged like every event; the faults attributed to the same part are the case.

use crate::backend::{Row, SqlResult, from_row, values};
use crate::error::StoreError;
use crate::history::event_graph::recompute_fault;
use crate::history::fault_event::{NewEvent, insert_event};
use crate::history::graph_sql::standing;
use crate::history::limits;
use crate::id::Id;
use crate::store::Store;
use crate::values::fault_state::{FaultAction, FaultState};
use crate::values::record::{CAUSE, CauseRecord, DIAGNOSED, part_name};

/// A fault that is changed, alone or with its case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseFault {
    pub(crate) seq: i64,
    /// The fault.
    pub id: Id,
    /// Name of the fault's code.
    pub code_name: String,
    /// The part that the fault points at.
    pub lru: String,
    /// State of the fault; after a change the new state.
    pub state: FaultState,
}

/// SQL after `FROM`: the other faults `c` of the case of fault `?1`.
pub(crate) const REST_OF_CASE: &str =
    "fault f JOIN fault c ON c.unit = f.unit AND c.cause = f.cause
     WHERE f.seq = ?1 AND c.seq <> f.seq AND f.state <> 'closed' AND c.state <> 'closed'";

/// Columns of `c` that [`case_fault`] reads.
pub(crate) const CASE_FAULT: &str = "c.seq, c.id, c.code_name, c.lru, c.state";

impl Store {
    /// Records a person's word on the part that a fault comes from; an empty part: the fault stands alone. No diagnosis
    /// changes that later.
    ///
    /// # Errors
    /// There is no such fault, a text is too long, or the file or server does not take it.
    pub fn set_cause(
        &self,
        fault: Id,
        cause: &CauseRecord,
        who: &str,
        at_us: i64,
    ) -> Result<(), StoreError> {
        const DOING: &str = "attributing a fault";
        cause.check()?;
        limits::name("the name of who says it", who)?;
        self.change(DOING, |_| {
            let seq = self.fault_row(fault)?.seq;
            self.attribute(seq, CAUSE, cause, who, at_us)
        })
    }

    /// Attributes faults to the part that the diagnosis of a run found, and returns those whose attribution changed. A
    /// fault that is closed, or that a person has attributed, stays as it is.
    ///
    /// # Errors
    /// There is no such fault, a text is too long, or the file or server does not take it.
    pub fn attribute_diagnosed(
        &self,
        faults: &[Id],
        cause: &CauseRecord,
        at_us: i64,
    ) -> Result<Vec<Id>, StoreError> {
        const DOING: &str = "attributing faults";
        const STAYS: &str = concat!(
            "SELECT 1 FROM fault f WHERE f.seq = ?1 AND (f.state = 'closed' OR f.cause = ?2
            OR EXISTS (SELECT 1 FROM fault_event e WHERE e.fault = f.seq AND e.kind = 'cause'",
            standing!("e"),
            "))"
        );
        cause.check()?;
        let part = part_name(&cause.part);
        self.change(DOING, |_| {
            let mut attributed = Vec::new();
            for fault in faults {
                let seq = self.fault_row(*fault)?.seq;
                if !self.has(DOING, STAYS, &values![seq, part.as_str()])? {
                    self.attribute(seq, DIAGNOSED, cause, "", at_us)?;
                    attributed.push(*fault);
                }
            }
            Ok(attributed)
        })
    }

    /// Adds the event of an attribution, in the caller's transaction.
    fn attribute(
        &self,
        seq: i64,
        kind: &str,
        cause: &CauseRecord,
        who: &str,
        at_us: i64,
    ) -> Result<(), StoreError> {
        // Text and numbers only: cannot fail.
        let body = serde_json::to_string(cause).unwrap_or_default();
        let event = NewEvent {
            id: self.mint()?,
            kind,
            at_us,
            who,
            body: &body,
            state: None,
        };
        self.ask("attributing a fault", |backend| {
            insert_event(backend, seq, &event)?;
            recompute_fault(backend, seq)
        })
    }

    /// The fault that has, or had before a merge, this id.
    pub(crate) fn fault_row(&self, fault: Id) -> Result<CaseFault, StoreError> {
        let sql = format!(
            "SELECT {CASE_FAULT} FROM fault c
             WHERE c.seq = (SELECT seq FROM fault WHERE id = ?1
                UNION ALL SELECT fault FROM fault_alias WHERE id = ?1)"
        );
        let found = self.first("looking up a fault", &sql, &values![fault], case_fault)?;
        found.ok_or_else(|| StoreError::not_found("fault", fault))
    }

    /// The other faults of a fault's case to which an action on that fault applies, too.
    pub(crate) fn settled_with(
        &self,
        fault: &CaseFault,
        action: FaultAction,
    ) -> Result<Vec<CaseFault>, StoreError> {
        let sql = format!("SELECT {CASE_FAULT} FROM {REST_OF_CASE} ORDER BY c.seq");
        let mut rest = self.select("looking up a case", &sql, &values![fault.seq], case_fault)?;
        rest.retain(|other| follows(action, fault.state, other.state));
        Ok(rest)
    }
}

/// Whether an action on the named fault applies to another fault of its case. A repair applies to all of them, any
/// other action only to faults in the same state: a fault that came back must not be closed with a verified one.
fn follows(action: FaultAction, named: FaultState, other: FaultState) -> bool {
    (action == FaultAction::Repair || other == named) && other.next(action).is_ok()
}

pub(crate) fn case_fault(row: Row<'_>) -> SqlResult<CaseFault> {
    Ok(from_row!(row => CaseFault: seq, id, code_name, lru, state))
}
