//! What a run finds, as data: stored as JSON, told in English here and in other languages by whoever shows it.

use std::fmt::{self, Display, Formatter};

use protocol::Duration;
use protocol::event::{Event, LOG_ENTRIES};
use protocol::message::SelfTest;
use serde::{Deserialize, Serialize};

pub use super::condition::MissingData;
use super::describe::{bit_names, clock_wrong, limits, logged_text, meanings};
use super::plan::{Condition, Expectation};
use super::runner::ATTEMPTS;
use super::{EventSource, UnitEvent};
use crate::stimulus::text::number;

/// Most findings of a step that are kept apart; the others are counted.
const MOST: usize = 64;

/// An entry of the unit's log or of TCMS's, by its code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LoggedEvent {
    /// Whose log has it.
    pub source: EventSource,
    /// Number in the event dictionary, also one that this version does not know.
    pub code: u16,
    /// What the dictionary says it is.
    pub parameter: i32,
}

/// One thing that was found, or why nothing could be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// A measured value is outside its limits, all in `unit`.
    LimitMissed {
        /// Name in its script.
        measurement: String,
        /// What was measured.
        value: f64,
        /// How far the true value may be off.
        uncertainty: Option<f64>,
        /// Least value allowed.
        low: Option<f64>,
        /// Greatest value allowed.
        high: Option<f64>,
        /// Unit of all these; empty for counts and states.
        unit: String,
    },
    /// A condition did not come true in time.
    NeverBecame {
        /// Which.
        condition: Condition,
        /// The time it had.
        within: Duration,
        /// The bits of its signal at the end, where it is a set of these.
        seen: Option<u16>,
        /// The data that were missing then.
        missing: Option<MissingData>,
        /// What is behind its signals.
        said: Option<String>,
    },
    /// A condition did not stay true.
    HeldOnlyFor {
        /// Which.
        condition: Condition,
        /// For how long it did.
        held: Duration,
        /// The data that were missing then.
        missing: Option<MissingData>,
    },
    /// A condition came true that must not.
    CameTrue {
        /// Which.
        condition: Condition,
    },
    /// Whether a condition that must not come true did is not known.
    Unknown {
        /// Which.
        condition: Condition,
        /// The data that were missing.
        missing: MissingData,
    },
    /// An event was not logged that should have been.
    NotLogged {
        /// Which.
        event: Event,
        /// Least and greatest parameter.
        parameter: [i32; 2],
        /// The time it had.
        within: Duration,
    },
    /// An event was logged that must not be.
    Logged {
        /// Which.
        event: Event,
    },
    /// An event was logged that no step provoked.
    Unprovoked(LoggedEvent),
    /// The emergency brake was applied in a step that does not ask for it.
    BrakeApplied,
    /// The operator answered a question with no.
    SaidNo {
        /// The question.
        question: String,
    },
    /// The operator did not answer a question.
    NoAnswer {
        /// The question.
        question: String,
    },
    /// There is no operator to answer a question.
    NeedsOperator {
        /// The question.
        question: String,
    },
    /// A measurement has no value.
    NoValue {
        /// Name in its script.
        measurement: String,
        /// How many others of the step have none for the same reason.
        others: u32,
        /// Why.
        why: WhyNoValue,
    },
    /// A limit of a measurement refers to one without a value.
    LimitUnknown {
        /// Name in its script.
        measurement: String,
    },
    /// The unit or the bench refused a stimulus or request, in their words.
    Refused {
        /// Why.
        why: String,
    },
    /// A motion or request of the tester did not end in time.
    NotFinished {
        /// The time it had.
        within: Duration,
    },
    /// Frames that were lost between tester and unit may be why this event was logged, or, without one, why the
    /// emergency brake was applied.
    LineDisturbed {
        /// The event.
        event: Option<LoggedEvent>,
    },
    /// Frames were lost between tester and unit in a step that failed.
    FramesLost {
        /// How many.
        frames: u64,
    },
    /// The log could not be read while a step waited for it.
    LogNotRead {
        /// The time that took.
        within: Duration,
    },
    /// The log was not read to its end after the procedure.
    LogNotReadToEnd {
        /// The time that took.
        within: Duration,
    },
    /// A step took longer than it may.
    TimeLimit {
        /// The time it had.
        limit: Duration,
        /// What it waited for.
        waiting: Option<WaitedFor>,
    },
    /// The link to the unit cannot be used.
    LinkLost {
        /// Why.
        why: String,
    },
    /// The tester's computer stood still in an attempt at a step.
    StoodStill {
        /// For how long.
        by: Duration,
        /// In which attempt, from 1.
        attempt: u32,
    },
    /// It was found before the tester's computer stood still.
    BeforeStandstill(Box<Finding>),
    /// In the actions before the first step.
    InSetUp(Box<Finding>),
    /// In the actions after the last step.
    InCleanUp(Box<Finding>),
    /// These actions did not end in time.
    CleanUpTooLong {
        /// The time they had.
        within: Duration,
    },
    /// The operator cut these actions short.
    CleanUpCutShort,
    /// Outputs did not become safe in time.
    NotSafe {
        /// The time they had.
        within: Duration,
    },
    /// The operator stopped the run.
    Stopped,
    /// A step was not run.
    NotRun(Box<Finding>),
    /// A procedure was not begun.
    NotBegun(Box<Finding>),
    /// A step before did not pass, after which no other is run.
    NotPassed {
        /// Its name.
        step: String,
    },
    /// The step before, from which this one continues, was not tested.
    NotTestedBefore {
        /// Its name.
        step: String,
    },
    /// Only a bench with its harness can do it.
    NeedsHarness,
    /// The condition under which a step is run does not hold.
    ConditionFalse {
        /// What is behind its signals.
        said: Option<String>,
    },
    /// Whether the condition under which a step is run holds is not known.
    ConditionUnknown {
        /// The data that were missing.
        missing: MissingData,
    },
    /// The selection has no step.
    NoStepToRun,
    /// No step was run.
    NoStepRun,
    /// The program itself failed.
    ProgramFailed,
    /// The link was lost, and steps were left.
    LinkLostAt {
        /// Steps that were run.
        run: u32,
        /// Steps that were due.
        of: u32,
        /// Steps that were not run.
        left: u32,
    },
    /// A search for a fault found none and accepts nothing.
    NotAcceptance {
        /// Steps that were run.
        run: u32,
        /// Steps that were due.
        of: u32,
    },
    /// The unit says that items of its self-test failed.
    SelfTestFailed {
        /// Their bits.
        items: u16,
    },
    /// More entries of logs than are kept.
    TooManyEvents {
        /// How many more.
        more: u64,
    },
    /// The unit's clock goes wrong by the bench's.
    ClockWrong {
        /// By how much it is faster, thousandths.
        by_permille: i32,
    },
    /// A fault was found while the unit was brought up, or settled again.
    FoundBefore {
        /// Its name.
        fault: String,
        /// What came after.
        before: Before,
    },
    /// An entry of a log, as a fault.
    Event {
        /// The entry.
        event: LoggedEvent,
        /// Measured speed at that time, km/h.
        speed_kmh: f64,
        /// Limit in force at that time, km/h.
        limit_kmh: f64,
        /// Time of the unit or TCMS that logged it, s.
        time_s: f64,
    },
    /// A step that failed, as a fault.
    CheckFailed {
        /// Its procedure.
        procedure: String,
        /// Its name.
        step: String,
        /// What it found.
        findings: Findings,
    },
    /// More that was found, and is not kept.
    More {
        /// How many.
        n: u32,
    },
    /// Words of a script, a file, an operating system or another program.
    Told(String),
}

/// Why a measurement has no value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WhyNoValue {
    /// Data were missing.
    Missing(MissingData),
    /// What ends it did not come about.
    NeverEnded(Condition),
    /// It was not measured.
    NotMeasured,
}

/// What a unit is brought up for, or settles again for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Before {
    /// The first step of a procedure.
    FirstStep,
    /// A step that was not tested and is made again.
    RepeatedStep,
    /// The next repetition of a procedure.
    Repetition,
}

/// What a step waits for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WaitedFor {
    /// The end of its actions.
    Actions,
    /// An expectation.
    Expectation(Expectation),
}

/// All that was found in one place, each once with how often it came, in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Findings(Vec<Found>);

/// A finding, and how often it came.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// What.
    pub finding: Finding,
    /// How often; left out if once.
    #[serde(default = "once", skip_serializing_if = "is_once")]
    pub times: u32,
}

const fn once() -> u32 {
    1
}

fn is_once(times: &u32) -> bool {
    *times == 1
}

impl Findings {
    /// Each of them, in the order in which it came first.
    pub fn iter(&self) -> impl Iterator<Item = &Found> {
        self.0.iter()
    }

    /// Nothing was found.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// As they are stored; `None` for nothing.
    pub fn to_json(&self) -> Option<String> {
        let stored = || serde_json::to_string(self).ok();
        (!self.is_empty()).then(stored)?
    }

    /// As they were stored; `None` for what this version does not know.
    pub fn from_json(text: &str) -> Option<Self> {
        serde_json::from_str(text).ok()
    }

    /// Adds one that came so often.
    pub fn add(&mut self, finding: Finding, times: u32) {
        if let Some(known) = self.0.iter_mut().find(|found| found.finding == finding) {
            known.times += times;
        } else if self.0.len() < MOST {
            self.0.push(Found { finding, times });
        } else if let Some(Found {
            finding: Finding::More { n },
            ..
        }) = self.0.last_mut()
        {
            *n += 1;
        } else {
            let finding = Finding::More { n: 1 };
            self.0.push(Found { finding, times: 1 });
        }
    }
}

impl From<Finding> for Findings {
    fn from(finding: Finding) -> Self {
        Self(vec![Found { finding, times: 1 }])
    }
}

impl Extend<Finding> for Findings {
    fn extend<T: IntoIterator<Item = Finding>>(&mut self, all: T) {
        all.into_iter().for_each(|one| self.add(one, 1));
    }
}

impl Finding {
    /// The step, procedure or unit it is about was not run for this reason.
    pub fn not_run(self) -> Self {
        Self::NotRun(Box::new(self))
    }

    /// It is why nothing could be run without the harness of a bench.
    pub fn needs_harness(&self) -> bool {
        match self {
            Self::NeedsHarness => true,
            Self::NotRun(why) => why.needs_harness(),
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

/// Who logged what, as the beginning of a sentence.
impl Display for LoggedEvent {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let event = self.event();
        let name = event.map_or("unknown", |event| event.definition().name);
        let named = event.and_then(|event| super::event_text::named(event, self.parameter));
        let named = named.map_or(String::new(), |named| format!(", {named}"));
        write!(
            f,
            "{} logged {name} ({}{named})",
            self.source.who(),
            self.code
        )
    }
}

impl Display for Findings {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (place, found) in self.0.iter().enumerate() {
            if place > 0 {
                f.write_str("; ")?;
            }
            found.finding.fmt(f)?;
            if found.times > 1 {
                write!(f, " ({} times)", found.times)?;
            }
        }
        Ok(())
    }
}

impl Display for Finding {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::LimitMissed {
                measurement,
                value,
                uncertainty,
                low,
                high,
                unit,
            } => {
                let off = uncertainty.map_or(String::new(), |off| format!(" ± {}", number(off)));
                let (value, limits) = (number(*value), limits(*low, *high));
                let text = format!("{measurement} = {value}{off}, allowed {limits} {unit}");
                f.write_str(text.trim_end())
            }
            Self::NeverBecame {
                condition,
                within,
                seen,
                missing,
                said,
            } => {
                write!(f, "{condition} did not come within {within}")?;
                if let Some((signal, names)) = seen.and_then(|bits| named_bits(condition, bits)) {
                    write!(f, " ({signal} = {names})")?;
                }
                because(f, missing.as_ref())?;
                because(f, said.as_ref())
            }
            Self::HeldOnlyFor {
                condition,
                held,
                missing,
            } => {
                write!(f, "{condition} held only for {held}")?;
                because(f, missing.as_ref())
            }
            Self::CameTrue { condition } => write!(f, "{condition} came true"),
            Self::Unknown { condition, missing } => {
                write!(f, "{missing}, so never {condition} cannot be told")
            }
            Self::NotLogged {
                event,
                parameter,
                within,
            } => {
                let who = EventSource::of(*event).who();
                let entry = logged_text(*event, *parameter);
                write!(f, "{who} did not log {entry} within {within}")
            }
            Self::Logged { event } => {
                let who = EventSource::of(*event).who();
                write!(f, "{who} logged {}", event.definition().name)
            }
            Self::Unprovoked(event) => write!(f, "{event}, which no step provoked"),
            Self::BrakeApplied => {
                f.write_str("the emergency brake was applied, which this step does not ask for")
            }
            Self::SaidNo { question } => write!(f, "the operator said no: {question}"),
            Self::NoAnswer { question } => write!(f, "the operator did not answer: {question}"),
            Self::NeedsOperator { question } => write!(f, "needs an operator: {question}"),
            Self::NoValue {
                measurement,
                others,
                why,
            } => {
                f.write_str(measurement)?;
                if *others > 0 {
                    write!(f, " and {others} more")?;
                }
                match why {
                    WhyNoValue::Missing(missing) => write!(f, ": {missing}"),
                    WhyNoValue::NotMeasured => f.write_str(": no value"),
                    WhyNoValue::NeverEnded(end) => {
                        write!(f, ": no value, {end} did not come about in time")
                    }
                }
            }
            Self::LimitUnknown { measurement } => {
                write!(
                    f,
                    "{measurement}: a limit refers to a measurement without a value"
                )
            }
            Self::Refused { why } | Self::Told(why) => f.write_str(why),
            Self::NotFinished { within } => {
                write!(f, "motion or tester request not finished within {within}")
            }
            Self::LineDisturbed { event } => {
                match event {
                    Some(event) => event.fmt(f)?,
                    None => f.write_str("the emergency brake was applied")?,
                }
                f.write_str(
                    " while frames between tester and unit did not come through: check the line and run this \
                     again",
                )
            }
            Self::FramesLost { frames } => write!(
                f,
                "{frames} frames between tester and unit did not come through meanwhile: check the line and \
                 run this again"
            ),
            Self::LogNotRead { within } => write!(
                f,
                "the unit's log could not be read within {within}, so what it logged is not known"
            ),
            Self::LogNotReadToEnd { within } => {
                write!(f, "the unit's log was not read to its end within {within}")
            }
            Self::TimeLimit { limit, waiting } => {
                write!(f, "took longer than its time limit of {limit}")?;
                match waiting {
                    None => Ok(()),
                    Some(WaitedFor::Actions) => f.write_str(" in its actions"),
                    Some(WaitedFor::Expectation(expectation)) => {
                        write!(f, " waiting for: {expectation}")
                    }
                }
            }
            Self::LinkLost { why } => write!(f, "link to the unit: {why}"),
            Self::StoodStill { by, attempt } => {
                write!(
                    f,
                    "not tested in attempt {attempt} of {ATTEMPTS}: the tester's computer stood still for \
                     {:.2} s, which says nothing about the unit; ",
                    by.as_secs()
                )?;
                match *attempt < ATTEMPTS {
                    true => write!(f, "the step is repeated ({} of {ATTEMPTS})", attempt + 1),
                    false => f.write_str("end other programs and run this again"),
                }
            }
            Self::BeforeStandstill(what) => {
                write!(f, "before the tester's computer stood still: {what}")
            }
            Self::InSetUp(what) => write!(f, "setup: {what}"),
            Self::InCleanUp(what) => write!(f, "clean-up: {what}"),
            Self::CleanUpTooLong { within } => write!(f, "clean-up took longer than {within}"),
            Self::CleanUpCutShort => f.write_str("clean-up cut short by the operator"),
            Self::NotSafe { within } => {
                write!(f, "outputs are not confirmed safe after {within}")
            }
            Self::Stopped => f.write_str("stopped by the operator"),
            Self::NotRun(why) => write!(f, "not run, {why}"),
            Self::NotBegun(why) => write!(f, "not begun, {why}"),
            Self::NotPassed { step } => write!(f, "\"{step}\" did not pass"),
            Self::NotTestedBefore { step } => {
                write!(f, "it continues from \"{step}\", which was not tested")
            }
            Self::NeedsHarness => {
                f.write_str("needs the bench harness, and only the maintenance port is connected")
            }
            Self::ConditionFalse { said } => {
                f.write_str(said.as_deref().unwrap_or("its condition does not hold"))
            }
            Self::ConditionUnknown { missing } => write!(f, "its condition: {missing}"),
            Self::NoStepToRun => f.write_str("no step to run"),
            Self::NoStepRun => f.write_str("no step was run"),
            Self::ProgramFailed => f.write_str("the program failed in this run"),
            Self::LinkLostAt { run, of, left } => {
                write!(f, "link lost at step {run} of {of}; {left} not run")
            }
            Self::NotAcceptance { run, of } => {
                write!(f, "not an acceptance: {run} of {of} steps run, all passed")
            }
            Self::SelfTestFailed { items } => {
                let items = meanings(&SelfTest::SPEC, *items);
                write!(f, "the unit says its self-test failed: {items}")
            }
            Self::TooManyEvents { more } => write!(
                f,
                "the unit logged more than {LOG_ENTRIES} events that no step provoked, and {more} more \
                 entries, not stored"
            ),
            Self::ClockWrong { by_permille } => f.write_str(&clock_wrong(*by_permille)),
            Self::FoundBefore { fault, before } => {
                let before = match before {
                    Before::FirstStep => "the first step",
                    Before::RepeatedStep => "the repetition of a step",
                    Before::Repetition => "the next repetition",
                };
                write!(f, "found before {before}: {fault}")
            }
            Self::Event {
                event,
                speed_kmh,
                limit_kmh,
                time_s,
            } => {
                let who = event.source.who().trim_start_matches("the ");
                write!(f, "{} at {speed_kmh:.1} km/h", happened(event))?;
                write!(f, ", limit {limit_kmh:.1} km/h, {who} time {time_s:.3} s")
            }
            Self::CheckFailed {
                procedure,
                step,
                findings,
            } => write!(f, "{procedure}, {step}: {findings}"),
            Self::More { n } => write!(f, "and {n} more"),
        }
    }
}

/// What the bits that a condition asks for are instead, with the name of their signal; `None` where it has no set of bits.
pub fn named_bits(condition: &Condition, bits: u16) -> Option<(&'static str, String)> {
    let Condition::Compare { signal, .. } = condition else {
        return None;
    };
    Some((signal.name(), bit_names(*signal, bits)?))
}

/// What an event is, with what its parameter says.
fn happened(logged: &LoggedEvent) -> String {
    let Some(event) = logged.event() else {
        let (code, parameter) = (logged.code, logged.parameter);
        return format!("event {code} is not in the dictionary (parameter {parameter})");
    };
    let said = super::event_text::parameter(event, logged.parameter);
    match said.is_empty() {
        true => event.definition().text.to_owned(),
        false => format!("{} ({said})", event.definition().text),
    }
}

fn because(f: &mut Formatter<'_>, why: Option<&impl Display>) -> fmt::Result {
    why.map_or(Ok(()), |why| write!(f, ": {why}"))
}
