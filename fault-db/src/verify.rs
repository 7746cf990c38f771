//! Verifies repairs by passing runs.
//!
//! A repaired fault becomes verified by a run that passed, began when the repair was known here, and passed
//! the step that saw the fault last. With a fault that names the part which its case comes from, the consequences of
//! that part are verified, provided that no other fault naming it is left. Any other fault that no step saw, for
//! instance one read from a unit's log, has to be verified by a user.

use crate::backend::{SqlError, values};
use crate::cases::REST_OF_CASE;
use crate::error::StoreError;
use crate::fault_event::{NewEvent, insert_event};
use crate::fault_state::{FaultAction, FaultState};
use crate::id::Id;
use crate::record::{RunEnd, Verdict};
use crate::store::Store;

/// Repaired faults of a unit whose last step passed in a run.
const PROVEN: &str = "
    SELECT f.seq, f.id FROM fault f
    WHERE f.unit = ?1 AND f.state = 'repaired'
        AND (SELECT max(e.seq) FROM fault_event e WHERE e.fault = f.seq AND e.state = 'repaired') <= ?3
        AND EXISTS (
            SELECT 1 FROM step seen JOIN step again
                ON again.procedure = seen.procedure AND again.name = seen.name
            WHERE again.run = ?2 AND again.verdict = 'passed'
                AND (seen.run, seen.step_index) = (
                    SELECT o.run, o.step_index FROM fault_occurrence o
                    WHERE o.fault = f.seq ORDER BY o.at_us DESC, o.seq DESC LIMIT 1))
    ORDER BY f.seq";

/// The repaired consequences in the case of fault `?1`, which names the cause itself, if no such fault is left that is
/// not verified.
const PROVEN_WITH: &str = "
    AND f.cause = lower(f.lru) AND c.cause <> lower(c.lru) AND c.state = 'repaired'
    AND (SELECT max(e.seq) FROM fault_event e WHERE e.fault = c.seq AND e.state = 'repaired') <= ?2
    AND NOT EXISTS (SELECT 1 FROM fault other WHERE other.unit = f.unit AND other.cause = f.cause
        AND other.cause = lower(other.lru) AND other.state NOT IN ('verified', 'closed'))
    ORDER BY c.seq";

impl Store {
    /// The number of the last event this file knows.
    pub(crate) fn last_event(&self) -> Result<i64, StoreError> {
        let found = self.first(
            "beginning a run",
            "SELECT coalesce(max(seq), 0) FROM fault_event",
            &[],
            |row| row.get(0),
        )?;
        Ok(found.unwrap_or_default())
    }

    /// Verifies the repairs that a run proves, in the caller's transaction: those of its unit made no later
    /// than the event of this number.
    pub(crate) fn verify_proven(
        &self,
        (unit, run, id): (i64, i64, Id),
        known_events: i64,
        end: &RunEnd,
    ) -> Result<Vec<Id>, StoreError> {
        if end.verdict != Verdict::Passed {
            return Ok(Vec::new());
        }
        let proven = self.select(
            "verifying repairs",
            PROVEN,
            &values![unit, run, known_events],
            |row| Ok((row.get::<i64>(0)?, row.get::<Id>(1)?)),
        )?;
        let note = format!("passed in run {}", id.short());
        for (fault, _) in &proven {
            self.verify(*fault, end.finished_at_us, &note)?;
        }
        let mut verified: Vec<Id> = proven.iter().map(|(_, id)| *id).collect();
        let with = format!("SELECT c.seq, c.id FROM {REST_OF_CASE} {PROVEN_WITH}");
        for (fault, id) in proven {
            let note = format!("{note}, with fault {}", id.short());
            let values = values![fault, known_events];
            let consequences = self.select("verifying repairs", &with, &values, |row| {
                Ok((row.get::<i64>(0)?, row.get::<Id>(1)?))
            })?;
            for (fault, id) in consequences {
                self.verify(fault, end.finished_at_us, &note)?;
                verified.push(id);
            }
        }
        Ok(verified)
    }

    /// Marks a repaired fault as verified by a run.
    fn verify(&self, fault: i64, at_us: i64, note: &str) -> Result<(), StoreError> {
        let event = NewEvent {
            id: self.mint()?,
            kind: FaultAction::Verify.event_kind(),
            at_us,
            who: "",
            body: note,
            state: Some(FaultState::Verified),
        };
        let work = || -> Result<(), SqlError> {
            insert_event(self.backend(), fault, &event)?;
            let sql = "UPDATE fault SET state = ?2 WHERE seq = ?1";
            (self.backend()).execute(sql, &values![fault, FaultState::Verified])?;
            Ok(())
        };
        work().map_err(|error| self.failed("verifying repairs", error))
    }
}
