//! Check procedures: scripts become plans when they are loaded, plans are run by a state machine that is polled.
//!
//! * [`plan`]: what a procedure is, as plain data: actions, conditions, expectations, measures;
//! * [`loader`]: Starlark scripts in, plans or errors with file, line and column out;
//! * [`describe`]: a plan as lines a technician can read before anything is driven;
//! * [`runner`]: runs one procedure; stepped once per I/O scan, sees what the unit does by samples
//!   and log entries, acts through a [`Driver`], reports as a stream of [`RunEvent`]s.
//!
//! No clock, no thread and no script code while a unit is driven.

mod action_run;
mod condition;
pub mod describe;
pub mod event_text;
mod evidence;
mod expectation_run;
pub mod finding;
mod limit;
pub mod link_trouble;
pub mod loader;
mod measure_run;
mod names;
pub mod operator;
pub mod origin;
pub mod plan;
mod problem;
pub mod report;
pub mod runner;
mod scan;
mod step_run;
mod step_verdict;
mod unit_clock;
pub mod worst_case;

use protocol::event::Event;
use protocol::message::{EbCause, LogEntry, Mode, SelfTest, SelfTestItem};
use protocol::signal::Signal;
use protocol::{Instant, Speed};
use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use evidence::{Evidence, LineState, LogState, UnitTime, UnitTimeBounds};
pub use finding::{Finding, Findings};
pub use loader::{LoadError, Loaded, Scripts};
pub use names::spoken;
pub use operator::PromptPolicy;
pub use plan::{Procedure, Step};
pub use protocol::Verdict;
pub use report::{Measurement, Outside, OutsideStep, ResultKind, RunEvent, StepResult};
pub use runner::{Poll, RunOptions, Runner};

use crate::stimulus::Stimulus;

/// Interface that a procedure drives: the rig, or a stand-in for the rig.
pub trait Driver {
    /// Begins a stimulus.
    ///
    /// # Errors
    /// The bench cannot or may not carry out the stimulus.
    fn apply(&mut self, now: Instant, stimulus: &Stimulus) -> Result<(), Refusal>;

    /// Whether no ramp, travel or tester request is under way any more.
    ///
    /// # Errors
    /// A request was refused, for instance "unit refused arming: key_off".
    fn settled(&mut self) -> Result<bool, Refusal>;

    /// Begins to take all generators and test signals away; may be called again and again.
    fn make_safe(&mut self, now: Instant);

    /// Whether [`Driver::make_safe`] has taken effect.
    fn safe(&self) -> bool;

    /// Whether the bench harness is there, so that more than test signals can be given.
    fn has_harness(&self) -> bool {
        true
    }

    /// Evidence by which data from the unit can be trusted.
    fn evidence(&self) -> Evidence {
        Evidence::default()
    }

    /// Result of an item in the last requested self-test; `None` before the result came.
    fn self_test_item(&self, _item: SelfTest) -> Option<SelfTestItem> {
        None
    }

    /// Detail behind a signal that says only whether the unit matches its record; `None` for other signals.
    fn said(&self, _signal: Signal) -> Option<&str> {
        None
    }
}

/// Why a stimulus was not carried out.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Refusal(pub String);

/// Who logs an event: the unit, or TCMS on the train.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventSource {
    Unit,
    /// Train control and monitoring system: its events are of the train.
    Tcms,
}

/// An entry of the unit's event log as received, or of TCMS's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitEvent {
    /// Who logged the entry.
    pub source: EventSource,
    /// Place in the log.
    pub index: u32,
    /// Number in the event dictionary, kept even if this version does not know it.
    pub code: u16,
    /// Time on the clock of the unit or TCMS that logged the entry, ms since its start.
    pub at_ms: u32,
    /// Parameter; its meaning is in the dictionary of events.
    pub parameter: i32,
    /// Measured speed at that time.
    pub speed: Speed,
    /// Limit in force at that time.
    pub limit: Speed,
    /// Position in the section, m.
    pub position_m: f64,
    /// Operating mode at that time.
    pub mode: Mode,
    /// Cause of the emergency brake.
    pub eb_cause: EbCause,
}

impl UnitEvent {
    /// An entry of the unit's log with this event, logged while the train stood.
    pub fn at_stand(index: u32, event: Event, at_ms: u32) -> Self {
        Self {
            source: EventSource::Unit,
            index,
            code: event.definition().code,
            at_ms,
            parameter: 0,
            speed: Speed::ZERO,
            limit: Speed::ZERO,
            position_m: 0.0,
            mode: Mode::default(),
            eb_cause: EbCause::None,
        }
    }

    /// An entry of the unit's log.
    pub fn of_log(entry: &LogEntry) -> Self {
        Self {
            source: EventSource::Unit,
            index: entry.index,
            code: entry.code,
            at_ms: entry.at_ms,
            parameter: entry.parameter,
            speed: Speed::from_cms(entry.speed_cms),
            limit: Speed::from_cms(entry.limit_cms),
            position_m: f64::from(entry.position_cm) / 100.0,
            mode: entry.mode,
            eb_cause: entry.eb_cause,
        }
    }

    /// Parameter in words; empty for an event without one.
    pub fn said(&self) -> String {
        Event::from_code(self.code).map_or_else(
            || format!("parameter {}", self.parameter),
            |event| event_text::parameter(event, self.parameter),
        )
    }

    /// The car, items or reason that the parameter names; `None` if the parameter is a measured value or unused.
    pub fn named(&self) -> Option<String> {
        event_text::named(Event::from_code(self.code)?, self.parameter)
    }
}

impl EventSource {
    /// Name of the source in a message.
    pub fn who(self) -> &'static str {
        match self {
            Self::Unit => "the unit",
            Self::Tcms => "TCMS",
        }
    }

    /// The source that logs this event.
    pub fn of(event: Event) -> Self {
        if event.by_tcms() {
            Self::Tcms
        } else {
            Self::Unit
        }
    }
}
