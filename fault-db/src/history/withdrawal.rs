//! Withdrawals: a person takes back what was written about a fault, by an event that says so.
//!
//! An event of the kind `withdrawn` names the event that it takes back. Both stay in the history; whatever is derived
//! from events (state, cause, repairs, counts, what diagnosis learns) is as if the withdrawn event had never been
//! written.

use crate::backend::{Row, Value, from_row, values};
use crate::error::StoreError;
use crate::history::cases::{CASE_FAULT, CaseFault, case_fault};
use crate::history::event_graph::recompute_fault;
use crate::history::fault_event::{NewEvent, insert_withdrawal};
use crate::history::graph_sql::standing;
use crate::history::limits;
use crate::id::Id;
use crate::store::Store;
use crate::values::withdrawal_error::WithdrawalError;

/// Kind of the event that takes back another event.
pub(crate) const WITHDRAWN: &str = "withdrawn";

/// Extent of a withdrawal.
#[derive(Clone, Copy, Debug, Default)]
pub struct ToWithdraw {
    /// Withdraw only an event written at this time, µs since 1970; `None`: a person's last event, whenever it was
    /// written.
    pub written_at_us: Option<i64>,
    /// Withdraw at this fault alone, even if the same was written at other faults of its case.
    pub only: bool,
}

/// An entry that was taken back.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Withdrawn {
    /// Kind of the event.
    pub kind: String,
    /// When it was written, µs since 1970.
    pub at_us: i64,
    /// Author of the withdrawn event.
    pub who: String,
    /// The named fault, then the other faults at which the same event was withdrawn; each in its state afterwards.
    pub faults: Vec<CaseFault>,
}

/// An event that a person wrote.
struct Written {
    seq: i64,
    id: Id,
    kind: String,
    at_us: i64,
    who: String,
    has_state: bool,
    lamport: i64,
}

/// SQL: last event that a person wrote about fault `?1` and that is not withdrawn.
const LAST_WRITTEN: &str = concat!(
    "SELECT e.seq, e.id, e.kind, e.at_us, e.who, CASE WHEN e.state IS NULL THEN 0 ELSE 1 END, e.turn
     FROM fault_event e WHERE e.fault = ?1 AND e.kind IN
        ('acknowledged', 'repair', 'repaired', 'verified', 'closed', 'reopened', 'note', 'cause')",
    standing!("e"),
    " ORDER BY e.turn DESC, e.id DESC LIMIT 1"
);

/// SQL: an event after event `?2` of fault `?1` that builds on it: not withdrawn, with a Lamport number above `?3`, and
/// with a state or the note of a passing run.
const RESTS_ON_IT: &str = concat!(
    "SELECT e.kind FROM fault_event e WHERE e.fault = ?1 AND e.turn > ?3 AND e.id <> ?2
        AND (e.state IS NOT NULL OR e.kind = 'passed')",
    standing!("e"),
    " ORDER BY e.turn, e.id LIMIT 1"
);

/// SQL: an unclosed fault that replaced fault `?1`, which is closed.
const SEEN_SINCE: &str =
    "SELECT 1 FROM fault f JOIN fault d ON d.unit = f.unit AND d.code = f.code AND d.lru = f.lru
     WHERE f.seq = ?1 AND f.state = 'closed' AND d.seq <> f.seq AND d.state <> 'closed' LIMIT 1";

/// SQL after `FROM`: other faults `c` of the unit of fault `?1` at which the same was written as event `?2`.
const WRITTEN_WITH_IT: &str = concat!(
    "fault f JOIN fault c ON c.unit = f.unit AND c.seq <> f.seq
     JOIN fault_event e ON e.fault = c.seq JOIN fault_event s ON s.seq = ?2
     WHERE f.seq = ?1 AND (e.kind, e.at_us, e.who, e.body) = (s.kind, s.at_us, s.who, s.body)",
    standing!("e"),
    " ORDER BY c.seq"
);

impl Store {
    /// Withdraws what a person wrote last about a fault, in one transaction also at the other faults where the same was
    /// written.
    ///
    /// # Errors
    /// There is no such fault, nothing can be withdrawn, a text is too long, or the file or server refuses.
    pub fn withdraw(
        &self,
        fault: Id,
        what: ToWithdraw,
        who: &str,
        reason: &str,
        at_us: i64,
    ) -> Result<Withdrawn, StoreError> {
        limits::name("the name of who says it", who)?;
        limits::note("the note", reason)?;
        const DOING: &str = "withdrawing what was written";
        self.change(DOING, |_| {
            let named = self.fault_row(fault)?;
            let written = self.last_written(&named, what.written_at_us)?;
            let mut faults = vec![named];
            if !what.only {
                let values = values![faults[0].seq, written.seq];
                let sql = format!("SELECT {CASE_FAULT} FROM {WRITTEN_WITH_IT}");
                faults.extend(self.select(DOING, &sql, &values, case_fault)?);
            }
            let mut changed = Vec::new();
            for fault in &faults {
                let of_fault = self.last_written(fault, Some(written.at_us))?;
                self.check_last(fault, &of_fault)?;
                let event = NewEvent {
                    id: self.mint()?,
                    kind: WITHDRAWN,
                    at_us,
                    who,
                    body: reason,
                    state: None,
                };
                self.ask(DOING, |backend| {
                    insert_withdrawal(backend, fault.seq, &event, of_fault.id)?;
                    recompute_fault(backend, fault.seq)
                })?;
                changed.push(self.fault_row(fault.id)?);
            }
            let Written {
                kind, at_us, who, ..
            } = written;
            Ok(Withdrawn {
                kind,
                at_us,
                who,
                faults: changed,
            })
        })
    }

    /// Last event that a person wrote about the fault; an error if `at_us` is given and the event is of another time.
    fn last_written(&self, fault: &CaseFault, at_us: Option<i64>) -> Result<Written, StoreError> {
        let row = |row: Row<'_>| {
            Ok(from_row!(row => Written:
                seq, id, kind, at_us, who, _, lamport;
                has_state: row.get::<i64>(5)? == 1
            ))
        };
        let found = self.first(
            "reading what was written",
            LAST_WRITTEN,
            &values![fault.seq],
            row,
        )?;
        let refuse = |source| StoreError::Withdrawal(fault.id, source);
        let found = found.ok_or_else(|| refuse(WithdrawalError::NothingWritten))?;
        if at_us.is_some_and(|at_us| at_us != found.at_us) {
            let Written { kind, who, .. } = found;
            return Err(refuse(WithdrawalError::OtherWritten { kind, who }));
        }
        Ok(found)
    }

    /// Refuses to withdraw a state on which later events build. On notes and causes nothing builds.
    fn check_last(&self, fault: &CaseFault, written: &Written) -> Result<(), StoreError> {
        const DOING: &str = "looking at what was written since";
        if !written.has_state {
            return Ok(());
        }
        let refuse = |source| Err(StoreError::Withdrawal(fault.id, source));
        let values = values![fault.seq, written.id, written.lamport];
        if let Some(after) = self.first(DOING, RESTS_ON_IT, &values, |row| row.get(0))? {
            let kind = written.kind.clone();
            return refuse(WithdrawalError::Rested { kind, after });
        }
        match self.has(DOING, SEEN_SINCE, &values![fault.seq])? {
            true => refuse(WithdrawalError::SeenSince),
            false => Ok(()),
        }
    }
}

/// Checks an event from another store: a withdrawal must name one event as its parent, and no state.
pub(crate) fn check_parents(
    kind: &str,
    state: &Value<'_>,
    parents: &Value<'_>,
) -> Result<(), String> {
    let one = matches!(parents, Value::Bytes(ids) if ids.len() == 16);
    match kind != WITHDRAWN || (one && matches!(state, Value::Null)) {
        true => Ok(()),
        false => Err("it withdraws one event and says no state".to_owned()),
    }
}
