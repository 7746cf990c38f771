//! Results of a run: measurements, step results, and the one stream of events.

use protocol::{Duration, Instant, LruId, Verdict};

use super::UnitEvent;
use super::finding::{Finding, Findings};
use super::plan::Action;

/// A measured value with its limits and verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Name within its step.
    pub name: String,
    pub value: Option<f64>,
    /// Unit of the value; empty for counts and states.
    pub unit: &'static str,
    /// Least value allowed, in `unit`.
    pub low: Option<f64>,
    /// Greatest value allowed, in `unit`.
    pub high: Option<f64>,
    /// Uncertainty of the true value, in `unit`; `None` = less than the steps in which the value is
    /// given.
    pub uncertainty: Option<f64>,
    /// Where its limits come from, [`Origin::text`](super::origin::Origin::text).
    pub limit_source: Option<String>,
    /// Passed, failed or error.
    pub verdict: Verdict,
}

/// How a result of a step counts: each step has one result that counts, and may have others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResultKind {
    /// The result that counts for the step.
    Step,
    /// The step was not tested because the tester's computer, or the link, stood still, and is begun again: another result follows.
    Attempt,
    /// The step was run again only for the state that it leaves, and shows something else now.
    Again,
}

/// Result of one step, or of one repetition of it.
#[derive(Clone, Debug, PartialEq)]
pub struct StepResult {
    /// Place in the procedure.
    pub index: usize,
    /// Name that the script gives the step.
    pub name: String,
    /// Number of the repetition, from 1.
    pub turn: u32,
    /// Number of repetitions that were asked for.
    pub turns: u32,
    pub kind: ResultKind,
    /// Line of the `step()` call in the script, from 1.
    pub line: u32,
    /// Verdict over the step's expectations and measurements.
    pub verdict: Verdict,
    /// Findings for which the step did not pass, or notes.
    pub findings: Findings,
    /// Part to suspect if the step failed: named by an event of unit or TCMS or by a self-test, else by the script.
    pub suspect: Option<LruId>,
    /// Bench time at which the step began.
    pub started: Instant,
    /// Time that the step took on the bench.
    pub bench_time: Duration,
    /// Where the numbers of its expectations come from, as [`Measurement::limit_source`].
    pub limit_source: Option<String>,
    pub measurements: Vec<Measurement>,
}

protocol::labelled! {
    /// Place of a failure outside the steps of a procedure. Reports show the place's [`name`](Outside::name).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Outside: name {
        /// While the unit was brought up, or settled between two procedures.
        BringUp = "bring-up",
        /// In the actions before the first step.
        SetUp = "set-up",
        /// In the actions after the last step.
        CleanUp = "clean-up",
        /// While outputs were made safe.
        SafeOutputs = "safe outputs",
        /// The unit logged an event that no step provoked, while no step was under way.
        UnprovokedEvent = "unprovoked event",
        /// The unit says that its self-test failed.
        SelfTest = "self-test",
        /// The unit's log could not be read to its end, or held more than is kept.
        UnitLog = "unit log",
        /// The link to the unit or the tester itself, while no step was under way.
        Bench = "bench",
        /// The operator's stop, while no step was under way.
        Stop = "stop",
        /// The procedure was due and not begun.
        NotBegun = "not begun",
        /// The procedure or the run as a whole.
        Whole = "as a whole",
    }
}

impl Outside {
    /// The place of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|place| place.name() == name)
    }
}

/// Failure outside the steps of a procedure.
#[derive(Clone, Debug, PartialEq)]
pub struct OutsideStep {
    pub place: Outside,
    /// Failed, error or aborted.
    pub verdict: Verdict,
    pub finding: Finding,
    /// Bench time.
    pub at: Instant,
}

/// The stream of a run: console, window, database and reports all read this.
#[derive(Clone, Debug, PartialEq)]
pub enum RunEvent {
    /// A procedure begins with its setup.
    ProcedureStarted {
        /// Steps to be run, repetitions counted.
        steps: usize,
        /// Bench time.
        at: Instant,
    },
    StepStarted {
        /// Place in the procedure.
        index: usize,
        /// Name that the script gives the step.
        name: String,
        /// Number of the repetition, from 1.
        turn: u32,
        /// Number of repetitions that were asked for.
        turns: u32,
        /// Bench time.
        at: Instant,
    },
    /// The run is paused and the next step waits.
    Paused {
        /// Name of the step that waits.
        next: String,
        /// Bench time.
        at: Instant,
    },
    /// Something is being waited for; repeated twice a second.
    Waiting {
        /// The action that takes its time.
        action: Action,
        /// How long it may still take.
        left: Duration,
    },
    /// The operator is asked; answer with [`super::Runner::answer`].
    Prompt {
        text: String,
        /// Time left for an answer.
        left: Duration,
    },
    Measured {
        /// Step's place in the procedure.
        index: usize,
        /// Value, limits and verdict.
        measurement: Measurement,
    },
    StepFinished(StepResult),
    /// The unit logged an event above information that no step so far provoked.
    UnsolicitedEvent(UnitEvent),
    /// The emergency brake was applied in a step that did not ask for it.
    UnsolicitedBrake {
        /// Bench time.
        at: Instant,
    },
    /// The unit's clock runs faster or slower than the bench's.
    UnitClockWrong {
        /// Excess of the unit's clock, thousandths.
        by_permille: i32,
        /// Bench time.
        at: Instant,
    },
    /// Something failed that belongs to no step.
    OutsideStep(OutsideStep),
    /// The procedure is over and outputs are safe, or could not be made so, which is an error.
    ProcedureFinished {
        /// Verdict over the procedure's steps and what stands beside them.
        verdict: Verdict,
        /// Findings outside steps; empty if there are none.
        findings: Findings,
        /// Bench time.
        at: Instant,
    },
}
