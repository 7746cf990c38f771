//! Findings of a run, as data: stored as JSON, told in English by `english`; other crates tell them in other
//! languages.

mod english;
mod list;

use protocol::Duration;
use protocol::event::Event;
use serde::{Deserialize, Serialize};

pub use super::condition::MissingData;
use super::link_trouble::LinkTrouble;
use super::plan::{Condition, Connection, Expectation};
use super::{EventSource, UnitEvent};
pub use list::{Findings, Found};

/// An entry of the unit's log or of TCMS's, by its code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LoggedEvent {
    pub source: EventSource,
    /// Number in the event dictionary, also one that this version does not know.
    pub code: u16,
    /// Parameter; its meaning is in the dictionary of events.
    pub parameter: i32,
}

/// A measured value outside its limits, all in `unit`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitMissed {
    /// Name in its script.
    pub measurement: String,
    /// Measured value.
    pub value: f64,
    /// Uncertainty of the true value.
    pub uncertainty: Option<f64>,
    /// Least value allowed.
    pub low: Option<f64>,
    /// Greatest value allowed.
    pub high: Option<f64>,
    /// Unit of value, uncertainty and limits; empty for counts and states.
    pub unit: String,
}

/// One thing that was found, or the reason why nothing could be found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// A measured value is outside its limits.
    LimitMissed(LimitMissed),
    /// A condition did not come true in time.
    NeverBecame {
        condition: Condition,
        within: Duration,
        /// Bits of the condition's signal at the end, where that signal is a set of bits.
        seen: Option<u16>,
        /// The data that were missing then.
        missing: Option<MissingData>,
        /// The reason that a signal of the condition gives, such as a refusal of the unit.
        said: Option<String>,
    },
    /// A condition did not stay true.
    HeldOnlyFor {
        condition: Condition,
        /// Time for which the condition stayed true.
        held: Duration,
        /// The data that were missing then.
        missing: Option<MissingData>,
    },
    /// A condition came true that must not.
    CameTrue {
        condition: Condition,
    },
    /// It is not known whether a condition came true that must not.
    Unknown {
        condition: Condition,
        missing: MissingData,
    },
    /// An event was not logged that should have been.
    NotLogged {
        event: Event,
        /// Least and greatest parameter.
        parameter: [i32; 2],
        within: Duration,
    },
    /// An event was logged that must not be.
    Logged {
        event: Event,
    },
    /// An event was logged that no step provoked.
    Unprovoked(LoggedEvent),
    /// The emergency brake was applied in a step that does not ask for it.
    BrakeApplied,
    /// The operator answered a question with no.
    SaidNo {
        question: String,
    },
    /// The operator did not answer a question.
    NoAnswer {
        question: String,
    },
    /// There is no operator to answer a question.
    NeedsOperator {
        question: String,
    },
    /// A measurement has no value.
    NoValue {
        /// Name in its script.
        measurement: String,
        /// Number of other measurements of the step without a value for the same reason.
        others: u32,
        why: WhyNoValue,
    },
    /// A limit of a measurement refers to an earlier measurement without a value.
    LimitUnknown {
        /// Name in its script.
        measurement: String,
    },
    /// The unit or the bench refused a stimulus or request, in their words.
    Refused {
        why: String,
    },
    /// A unit on a train started again while it was tested, because its supply was interrupted.
    StartedAgain,
    /// A unit on a train ended test mode by itself.
    TestModeEnded {
        /// The unit's code for the reason.
        refusal: u8,
    },
    /// A motion of the tachometer generators, or a request of the tester, did not end in time.
    NotFinished {
        within: Duration,
    },
    /// Frames lost between tester and unit may be the reason why `event` was logged; with `None`, why the emergency
    /// brake was applied.
    LineDisturbed {
        event: Option<LoggedEvent>,
    },
    /// Frames were lost between tester and unit in a step that failed.
    FramesLost {
        frames: u64,
    },
    /// The unit's log could not be read while a step waited for the log.
    LogNotRead {
        within: Duration,
    },
    /// The log was not read to its end after the procedure.
    LogNotReadToEnd {
        within: Duration,
    },
    /// A step took longer than its time limit.
    TimeLimit {
        limit: Duration,
        waiting: Option<WaitedFor>,
    },
    /// The link to the unit, or an instrument of the bench, cannot be used.
    LinkLost {
        why: LinkTrouble,
    },
    /// The tester's computer, or the link, stood still in an attempt at a step.
    StoodStill {
        by: Duration,
        /// Number of the attempt, from 1.
        attempt: u32,
    },
    /// A finding from before the tester's computer, or the link, stood still.
    BeforeStandstill(Box<Finding>),
    /// A finding in the actions before the first step.
    InSetUp(Box<Finding>),
    /// A finding in the actions after the last step.
    InCleanUp(Box<Finding>),
    /// Clean-up actions did not end in time.
    CleanUpTooLong {
        within: Duration,
    },
    /// The operator cut the clean-up actions short.
    CleanUpCutShort,
    /// Outputs did not become safe in time.
    NotSafe {
        within: Duration,
    },
    /// The operator stopped the run.
    Stopped,
    /// A step was not run.
    NotRun(Box<Finding>),
    /// A procedure was not begun.
    NotBegun(Box<Finding>),
    /// An earlier step did not pass, so no step after that one is run.
    NotPassed {
        step: String,
    },
    /// The step from which this step continues was not tested.
    NotTestedBefore {
        step: String,
    },
    /// Only a bench with its harness can run the step or procedure, or test the unit.
    NeedsHarness,
    /// The condition under which a step is run does not hold.
    ConditionFalse {
        /// The reason that a signal of the condition gives, such as a refusal of the unit.
        said: Option<String>,
    },
    /// Whether the condition under which a step is run holds is not known.
    ConditionUnknown {
        missing: MissingData,
    },
    /// The selection has no step.
    NoStepToRun,
    NoStepRun,
    ProgramFailed,
    /// The link, or an instrument of the bench, was lost before all steps were run.
    LinkLostAt {
        /// Steps that were run.
        run: u32,
        /// Steps that were due.
        of: u32,
        /// Steps that were not run.
        left: u32,
        /// The instrument of the bench that failed; none = the link to the unit.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        instrument: Option<String>,
        /// The bench that the instrument belongs to, where that is known.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        bench: Option<String>,
    },
    /// An adaptive run found no fault, which does not accept the unit.
    NotAcceptance {
        /// Steps that were run.
        run: u32,
        /// Steps that were due.
        of: u32,
    },
    /// The unit says that items of its self-test failed.
    SelfTestFailed {
        items: u16,
    },
    /// Logs had more entries than are kept.
    TooManyEvents {
        more: u64,
    },
    /// The unit's clock runs faster or slower than the bench's.
    ClockWrong {
        /// Excess of the unit's clock, thousandths.
        by_permille: i32,
    },
    /// A fault was found while the unit was brought up, or settled again.
    FoundBefore {
        fault: String,
        before: Before,
    },
    /// An entry of a log, as a fault.
    Event {
        event: LoggedEvent,
        /// Measured speed at that time, km/h.
        speed_kmh: f64,
        /// Limit in force at that time, km/h.
        limit_kmh: f64,
        /// Time on the clock of the unit or TCMS that logged the entry, s.
        time_s: f64,
    },
    /// A step that failed, as a fault.
    CheckFailed {
        /// Procedure of the step.
        procedure: String,
        step: String,
        /// Number of the repetition, from 1.
        turn: u32,
        /// Number of repetitions that were asked for.
        turns: u32,
        findings: Findings,
    },
    /// Number of further findings, which are not kept.
    More {
        n: u32,
    },
    /// This unit's software does not tell signals that the procedure looks at.
    NotToldByUnit {
        /// Version of the software, if the unit says it.
        software: Option<String>,
        signals: Vec<String>,
    },
    /// The tester could not begin or go on, in both languages, because a file, a port or a setting does not serve.
    Prevented {
        english: String,
        korean: String,
    },
    /// A step's note, in the words of the script.
    Told(String),
}

/// Why a measurement has no value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WhyNoValue {
    Missing(MissingData),
    /// The condition that ends the measurement did not come true.
    NeverEnded(Condition),
    NotMeasured,
}

/// Purpose of bringing a unit up, or of letting it settle again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Before {
    /// The first step of a procedure.
    FirstStep,
    /// A step that was not tested and is run again.
    RepeatedStep,
    /// The next repetition of a procedure.
    Repetition,
}

/// Condition that a step was waiting for when its time was over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WaitedFor {
    /// The end of the step's actions.
    Actions,
    Expectation(Expectation),
}

impl Connection {
    /// Why a procedure for this connection cannot be run on the connection `on`; `None` if it can. The harness can do all
    /// that the maintenance port can.
    pub fn lacks(self, on: Self) -> Option<Finding> {
        (self == Self::Btu && on == Self::Ptu).then_some(Finding::NeedsHarness)
    }
}

impl Finding {
    /// The finding that a step, procedure or unit was not run, with this finding as the reason.
    pub fn not_run(self) -> Self {
        Self::NotRun(Box::new(self))
    }

    /// The finding says that nothing could be run without the harness of a bench.
    pub fn needs_harness(&self) -> bool {
        match self {
            Self::NeedsHarness => true,
            Self::NotRun(why) => why.needs_harness(),
            _ => false,
        }
    }

    /// An instrument of the bench failed, or the tester stood still: such a finding tells nothing of the unit.
    pub fn is_of_the_bench(&self) -> bool {
        match self {
            Self::LinkLost { why } => why.is_of_the_bench(),
            Self::StoodStill { .. } | Self::BeforeStandstill(_) => true,
            Self::LinkLostAt { instrument, .. } => instrument.is_some(),
            Self::NotRun(why) | Self::InSetUp(why) | Self::InCleanUp(why) => why.is_of_the_bench(),
            _ => false,
        }
    }
}

impl LoggedEvent {
    /// The event, if this version knows it.
    pub fn event(&self) -> Option<Event> {
        Event::from_code(self.code)
    }
}

impl From<&UnitEvent> for LoggedEvent {
    fn from(entry: &UnitEvent) -> Self {
        Self {
            source: entry.source,
            code: entry.code,
            parameter: entry.parameter,
        }
    }
}
