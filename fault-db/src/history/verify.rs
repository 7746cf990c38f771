//! Proves repairs by passing runs.
//!
//! A passing run is noted at a repaired fault if the repair was known in this file when the run began, and the run
//! passed the step that saw the fault last; it is noted at the repaired consequences in the fault's case, too. Whether
//! that proves the repair depends on how often the fault showed before: an intermittent fault hides. The caller, who
//! knows the rate, decides ([`Store::repairs_to_prove`], [`Store::confirm_repairs`]); until then the repair is a claim,
//! as is a state that a person sets. A fault that no step saw, for instance one read from a unit's log, is verified by
//! a person.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::backend::values;
use crate::error::StoreError;
use crate::history::cases::{CASE_FAULT, REST_OF_CASE, case_fault};
use crate::history::fault_event::{NewEvent, insert_event};
use crate::history::fault_log::Change;
use crate::history::graph_sql::standing;
use crate::id::Id;
use crate::store::Store;
use crate::values::event::FaultEvent;
use crate::values::fault_state::{FaultAction, FaultState};
use crate::values::record::LOG_SOURCE;
use crate::values::record::{RepairRecord, RunEnd, Verdict};

/// Kind of the event that notes a passing run after a repair.
const PASSED: &str = "passed";
/// Kind of the event by which a run proves a repair; the event of a person is `verified`.
const CONFIRMED: &str = "confirmed";
/// Beginning of the note of a `passed` or `confirmed` event; the run's id follows.
const IN_RUN: &str = "in run ";
/// The last runs with the fault, at most this many, are the evidence of how often it shows.
const MOST_RUNS: i64 = 8;

/// SQL: joins to runs `r` their seals `s`, one each, although a copy of a file seals a run again.
macro_rules! sealed_runs {
    () => {
        " LEFT JOIN seal s ON s.id = r.id AND s.what = 'run' AND s.origin = (SELECT x.origin FROM seal x
            WHERE x.id = r.id AND x.what = 'run' ORDER BY x.origin LIMIT 1) "
    };
}

/// The time by which such runs are sorted: runs of one chain in the order of the chain, others by their own times.
macro_rules! time_in_order {
    () => {
        "min(r.started_at_us) OVER (PARTITION BY coalesce(s.origin, r.id) ORDER BY s.ordinal
            ROWS BETWEEN CURRENT ROW AND UNBOUNDED FOLLOWING)"
    };
}

/// SQL: repaired faults of unit `?1` whose step, the last that saw them, passed in run `?2`.
const SHOWN_GONE: &str = concat!(
    "SELECT f.seq, f.id FROM fault f
    WHERE f.unit = ?1 AND f.state = 'repaired'
        AND (SELECT max(e.seq) FROM fault_event e WHERE e.fault = f.seq AND e.state = 'repaired'",
    standing!("e"),
    ") <= ?3
        AND EXISTS (
            SELECT 1 FROM step seen JOIN step again
                ON again.procedure = seen.procedure AND again.name = seen.name
            WHERE again.run = ?2 AND again.verdict = 'passed'
                AND (seen.run, seen.step_index) = (
                    SELECT o.run, o.step_index FROM fault_occurrence o JOIN run r ON r.seq = o.run",
    sealed_runs!(),
    "WHERE o.fault = f.seq ORDER BY ",
    time_in_order!(),
    " DESC, s.ordinal DESC, o.seq DESC LIMIT 1))
    ORDER BY f.seq"
);

/// SQL: repaired consequences in the case of fault `?1`, if that fault points at the part which is the cause.
const WITH_IT: &str = concat!(
    " AND f.cause = lower(f.lru) AND c.cause <> lower(c.lru) AND c.state = 'repaired'
    AND (SELECT max(e.seq) FROM fault_event e WHERE e.fault = c.seq AND e.state = 'repaired'",
    standing!("e"),
    ") <= ?2
    ORDER BY c.seq"
);

/// SQL: consequences in the case of fault `?1` at which a run is noted, if every other fault that points at the cause
/// is verified.
const PROVEN_WITH_IT: &str = "
    AND f.cause = lower(f.lru) AND c.cause <> lower(c.lru) AND c.state = 'repaired'
    AND EXISTS (SELECT 1 FROM fault_event e WHERE e.fault = c.seq AND e.kind = 'passed' AND e.body LIKE ?2)
    AND NOT EXISTS (SELECT 1 FROM fault other WHERE other.unit = f.unit AND other.cause = f.cause
        AND other.cause = lower(other.lru) AND other.state NOT IN ('verified', 'closed'))
    ORDER BY c.seq";

/// SQL: whether a run was recorded no later than another run or an event: by the order of their chain of seals, which
/// no clock changes, or by their times if two files recorded them.
macro_rules! before {
    ($run:literal, $at_us:literal, $event:literal) => {
        before!($run, $at_us, "event", $event, ".at_us")
    };
    ($run:literal, $at_us:literal, $what:literal, $other:literal, $of_other:literal) => {
        concat!(
            "coalesce((SELECT a.ordinal <= b.ordinal FROM seal a JOIN seal b ON b.origin = a.origin
                WHERE a.what = 'run' AND a.id = ",
            $run,
            ".id AND b.what = '",
            $what,
            "' AND b.id = ",
            $other,
            ".id LIMIT 1), ",
            $at_us,
            " <= ",
            $other,
            $of_other,
            ")"
        )
    };
}

/// SQL: the last runs in which fault `?1` was present, newest first: from the first that saw it since it last opened to
/// its repair.
const THERE: &str = concat!(
    "SELECT r.id FROM run r JOIN fault f ON f.unit = r.unit
        JOIN run q ON q.seq = (SELECT o.run FROM fault_occurrence o JOIN run r ON r.seq = o.run",
    sealed_runs!(),
    "WHERE o.fault = ?1 AND NOT EXISTS (SELECT 1 FROM fault_event x
                WHERE x.fault = ?1 AND x.state = 'verified' AND ",
    before!("r", "o.at_us", "x"),
    standing!("x"),
    ") ORDER BY ",
    time_in_order!(),
    ", s.ordinal, o.seq LIMIT 1)",
    sealed_runs!(),
    "WHERE f.seq = ?1 AND r.verdict IN ('passed', 'failed') AND r.source NOT LIKE ?2 AND ",
    before!("q", "q.started_at_us", "run", "r", ".started_at_us"),
    " AND EXISTS (SELECT 1 FROM fault_event x WHERE x.fault = f.seq AND x.kind = 'repair' AND ",
    before!("r", "r.started_at_us", "x"),
    standing!("x"),
    ")
    ORDER BY ",
    time_in_order!(),
    " DESC, s.ordinal DESC, r.seq DESC LIMIT ?3"
);

/// A repair that a run may have proved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RepairToProve {
    /// The repaired fault.
    pub fault: Id,
    /// Name of the fault's code.
    pub code_name: String,
    /// Last runs of the unit in which the fault was present, oldest first; none is older than the first that saw it.
    pub there: Vec<Id>,
    /// Runs that passed since the repair, oldest first; the last one is the run that was asked about.
    pub passed: Vec<Id>,
}

impl Store {
    /// Row number of the last event in this file; 0 without events.
    pub(crate) fn last_event(&self) -> Result<i64, StoreError> {
        let found = self.first(
            "beginning a run",
            "SELECT coalesce(max(seq), 0) FROM fault_event",
            &[],
            |row| row.get(0),
        )?;
        Ok(found.unwrap_or_default())
    }

    /// Notes a passing run at those repaired faults of its unit that it shows to be gone, if they were repaired no
    /// later than event `known_events`. Runs in the caller's transaction.
    pub(crate) fn note_passed(
        &self,
        (unit, run, id): (i64, i64, Id),
        known_events: i64,
        end: &RunEnd,
    ) -> Result<(), StoreError> {
        const DOING: &str = "noting a run that passed";
        if end.verdict != Verdict::Passed {
            return Ok(());
        }
        let values = values![unit, run, known_events];
        let gone = self.select(DOING, SHOWN_GONE, &values, |row| {
            Ok((row.get::<i64>(0)?, row.get::<Id>(1)?))
        })?;
        let mut notes = BTreeMap::new();
        let note = format!("{IN_RUN}{id}");
        let with = format!("SELECT c.seq FROM {REST_OF_CASE} {WITH_IT}");
        for (fault, id) in &gone {
            let values = values![*fault, known_events];
            for consequence in self.select(DOING, &with, &values, |row| row.get::<i64>(0))? {
                notes.insert(consequence, format!("{note}, with fault {}", id.short()));
            }
        }
        notes.extend(gone.iter().map(|(fault, _)| (*fault, note.clone())));
        for (fault, note) in notes {
            let event = NewEvent {
                id: self.mint()?,
                kind: PASSED,
                at_us: end.finished_at_us,
                who: "",
                body: &note,
                state: None,
            };
            self.ask(DOING, |file| insert_event(file, fault, &event))?;
        }
        Ok(())
    }

    /// The repaired faults that a run has shown to be gone, each with the runs that tell how often the fault hides.
    ///
    /// # Errors
    /// There is no such run, or the file cannot be read.
    pub fn repairs_to_prove(&self, run: Id) -> Result<Vec<RepairToProve>, StoreError> {
        const DOING: &str = "looking for repairs to prove";
        let mut repairs: BTreeMap<i64, RepairToProve> = BTreeMap::new();
        let passed = self.select(
            DOING,
            concat!(
                "SELECT f.seq, f.id, f.code_name, e.body FROM run r JOIN fault f ON f.unit = r.unit
                 JOIN fault_event e ON e.fault = f.seq AND e.kind = 'passed'
                 WHERE r.id = ?1 AND f.state = 'repaired' AND e.seq > (SELECT max(x.seq) FROM fault_event x
                    WHERE x.fault = f.seq AND x.state = 'repaired'",
                standing!("x"),
                ") ORDER BY f.seq, e.seq"
            ),
            &values![run],
            |row| {
                let (fault, code_name) = (row.get::<Id>(1)?, row.get::<String>(2)?);
                let passed = noted_run(row.get::<&str>(3)?);
                Ok((row.get::<i64>(0)?, fault, code_name, passed))
            },
        )?;
        for (row, fault, code_name, passed) in passed {
            let repair = repairs.entry(row).or_insert(RepairToProve {
                fault,
                code_name,
                there: Vec::new(),
                passed: Vec::new(),
            });
            repair.passed.extend(passed);
        }
        repairs.retain(|_, repair| repair.passed.last() == Some(&run));
        for (fault, repair) in &mut repairs {
            repair.there = self.select(
                DOING,
                THERE,
                &values![*fault, format!("{LOG_SOURCE}%"), MOST_RUNS],
                |row| row.get::<Id>(0),
            )?;
            repair.there.reverse();
            repair.there.retain(|run| !repair.passed.contains(run));
        }
        Ok(repairs.into_values().collect())
    }

    /// Marks repaired faults as verified by a run, each with the reason in words. With a fault that points at the cause
    /// of its case, the consequences are verified, too, if no other unverified fault points at the cause. Returns all
    /// faults that are verified now.
    ///
    /// # Errors
    /// There is no such run or fault, or the file does not take it.
    pub fn confirm_repairs(&self, run: Id, proven: &[(Id, String)]) -> Result<Vec<Id>, StoreError> {
        const DOING: &str = "verifying repairs";
        let finished = self.first(
            DOING,
            "SELECT finished_at_us FROM run WHERE id = ?1",
            &values![run],
            |row| row.get::<Option<i64>>(0),
        )?;
        let Some(at_us) = finished.flatten() else {
            return Err(StoreError::not_found("finished run", run));
        };
        self.change(DOING, |_| {
            let confirm = |fault, note: &str| {
                let change = Change {
                    action: FaultAction::Verify,
                    kind: CONFIRMED,
                    who: "",
                    body: note,
                    at_us,
                };
                self.apply(fault, &change)
            };
            let mut rows = Vec::new();
            for (fault, note) in proven {
                let fault = self.fault_row(*fault)?;
                if fault.state == FaultState::Repaired {
                    rows.push((fault.seq, fault.id));
                    confirm(fault, note)?;
                }
            }
            let mut verified: Vec<Id> = rows.iter().map(|(_, id)| *id).collect();
            let with = format!("SELECT {CASE_FAULT} FROM {REST_OF_CASE} {PROVEN_WITH_IT}");
            for (fault, id) in rows {
                let noted = format!("{IN_RUN}{run}");
                let note = format!("{noted}, with fault {}", id.short());
                let values = values![fault, format!("{noted}%")];
                for consequence in self.select(DOING, &with, &values, case_fault)? {
                    verified.push(confirm(consequence, &note)?.id);
                }
            }
            Ok(verified)
        })
    }
}

/// The run whose id the note ends with; `None` if the run passed only the step of another fault of the case.
fn noted_run(note: &str) -> Option<Id> {
    note.strip_prefix(IN_RUN)?.parse().ok()
}

/// A fault that a run has verified.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SettledFault {
    /// The fault.
    pub id: Id,
    /// Code of the fault.
    pub code: i64,
    /// Name of the fault's code.
    pub code_name: String,
    /// The part it points at.
    pub lru: String,
    /// The repair that the run has proved; `None` if a person only set the state `repaired`.
    pub repair: Option<RepairRecord>,
}

impl FaultEvent {
    /// The run that passed after the repair, if the event is `passed` or `confirmed`.
    pub fn passed_run(&self) -> Option<Id> {
        if !matches!(&*self.kind, PASSED | CONFIRMED) {
            return None;
        }
        let rest = self.note.strip_prefix(IN_RUN)?;
        rest.split([',', ':']).next()?.parse().ok()
    }

    /// Whether this event says that a run has proved the repair.
    pub fn is_proof(&self) -> bool {
        self.kind == CONFIRMED
    }
}

/// SQL: faults that run `?1` of the unit has verified; the note of an event of that run begins with `?2`.
pub(crate) const SETTLED: &str = concat!(
    "SELECT f.id, f.code, f.code_name, f.lru,
        (SELECT x.body FROM fault_event x WHERE x.fault = f.seq AND x.kind = 'repair' AND x.at_us <= e.at_us",
    standing!("x"),
    " ORDER BY x.at_us DESC, x.seq DESC LIMIT 1)
    FROM run r JOIN fault f ON f.unit = r.unit
    JOIN fault_event e ON e.fault = f.seq AND e.kind = 'confirmed' AND e.body LIKE ?2
    WHERE r.id = ?1 ORDER BY f.seq"
);

/// SQL pattern for the notes of the events that a run has made.
pub(crate) fn made_by(run: Id) -> String {
    format!("{IN_RUN}{run}%")
}
