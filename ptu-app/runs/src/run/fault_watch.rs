//! Derives faults from the events of a run: unit events that were not provoked, a brake that was not
//! asked for, a check that failed.

use btu_rig::procedure::{Finding, Procedure, StepResult, UnitEvent, Verdict};
use protocol::event::{Event, Severity};
use protocol::message::SelfTest;
use protocol::signal::Sample;
use protocol::{Instant, LruId};

use super::trace_data::freeze_frame;

/// Code of a fault found by a failed check.
pub const CHECK_FAILED: u16 = 9000;
/// Code of an emergency brake that was not requested.
pub const EB_UNREQUESTED: u16 = 9001;

/// Code of a clock of the unit that goes wrong.
pub const CLOCK_WRONG: u16 = 9002;

/// A fault as a procedure finds it.
#[derive(Clone, Debug)]
pub struct FaultSeen {
    /// Number of the fault.
    pub code: u16,
    pub name: String,
    /// Part it points at.
    pub lru: Option<LruId>,
    pub severity: Severity,
    /// When, on the procedure's bench.
    pub at: Instant,
    /// Step under way, by its turn in the procedure.
    pub step: Option<usize>,
    pub finding: Finding,
    /// All signals at that moment.
    pub freeze: Vec<fault_db::FreezeSample>,
}

/// Whether an unprovoked event is a fault: all above information, and all unknown ones.
pub fn is_fault(entry: &UnitEvent) -> bool {
    Event::from_code(entry.code).is_none_or(|event| event.definition().severity > Severity::Info)
}

/// The event entry as a fault. An event that names no part gives a fault without one: the step under way need not have
/// to do with it.
pub fn of_event(entry: &UnitEvent, at: Instant, sample: &Sample) -> FaultSeen {
    let event = Event::from_code(entry.code);
    let (name, severity) = match event.map(Event::definition) {
        Some(known) => (known.name.to_owned(), known.severity),
        None => (format!("event_{}", entry.code), Severity::Major),
    };
    FaultSeen {
        code: entry.code,
        name,
        lru: event.and_then(|event| event.suspect(entry.parameter)),
        severity,
        at,
        step: None,
        finding: Finding::Event {
            event: entry.into(),
            speed_kmh: entry.speed.kmh(),
            limit_kmh: entry.limit.kmh(),
            time_s: f64::from(entry.at_ms) / 1000.0,
        },
        freeze: freeze_frame(sample),
    }
}

/// The fault of a unit that says its self-test failed, whenever that was.
pub fn of_self_test(failed: SelfTest, at: Instant, sample: &Sample) -> FaultSeen {
    let event = Event::SelfTestFailed;
    let known = event.definition();
    let items = failed.bits();
    FaultSeen {
        code: known.code,
        name: known.name.to_owned(),
        lru: event.suspect(i32::from(failed.bits())),
        severity: known.severity,
        at,
        step: None,
        finding: Finding::SelfTestFailed { items },
        freeze: freeze_frame(sample),
    }
}

/// An emergency brake that was not requested.
pub fn of_brake(at: Instant, sample: &Sample) -> FaultSeen {
    FaultSeen {
        code: EB_UNREQUESTED,
        name: "eb_unrequested".into(),
        lru: None,
        severity: Severity::Critical,
        at,
        step: None,
        finding: Finding::BrakeApplied,
        freeze: freeze_frame(sample),
    }
}

/// A clock of the unit that goes wrong, measured by the bench's: it is on the board of ATP's processor.
pub fn of_clock(by_permille: i32, at: Instant, sample: &Sample) -> FaultSeen {
    FaultSeen {
        code: CLOCK_WRONG,
        name: diagnosis::CLOCK_WRONG.into(),
        lru: Some(LruId::from_static("atp_cpu")),
        severity: Severity::Critical,
        at,
        step: None,
        finding: Finding::ClockWrong { by_permille },
        freeze: freeze_frame(sample),
    }
}

/// A step that failed, unless an event already stands for it.
pub fn of_step(
    procedure: &Procedure,
    result: &StepResult,
    explained: bool,
    sample: &Sample,
) -> Option<FaultSeen> {
    if result.verdict != Verdict::Failed || explained {
        return None;
    }
    Some(FaultSeen {
        code: CHECK_FAILED,
        name: "check_failed".into(),
        lru: result.suspect.clone(),
        severity: Severity::Major,
        at: result.started + result.bench_time,
        step: None,
        finding: Finding::CheckFailed {
            procedure: procedure.id.clone(),
            step: result.name.clone(),
            turn: result.turn,
            turns: result.turns,
            findings: result.findings.clone(),
        },
        freeze: freeze_frame(sample),
    })
}
