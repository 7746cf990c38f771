//! Data of a check procedure: plain data that can be shown, chosen from, stored and run.

use protocol::event::Event;
use protocol::message::SelfTest;
use protocol::signal::Signal;
use protocol::{Duration, LruId};
use serde::{Deserialize, Serialize};

pub use super::condition::{Comparison, Condition, Operand};
use super::origin::Origin;
use crate::stimulus::Stimulus;

/// How the tester reaches the unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Connection {
    /// The bench drives every input of a unit alone.
    Btu,
    /// The laptop on the train, through the TEST board.
    Ptu,
}

impl Connection {
    pub fn word(self) -> &'static str {
        match self {
            Self::Btu => "harness",
            Self::Ptu => "ptu",
        }
    }
}

/// One check procedure: one script file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Procedure {
    /// Path under the scripts folder without `.star`, for instance `atp/overspeed`.
    pub id: String,
    /// Purpose of the check, in English.
    pub title: String,
    pub title_ko: Option<String>,
    pub needs: Connection,
    /// Run only when it is asked for by name: too long for a run of everything.
    pub on_request: bool,
    /// Reason in unit type, line or train for which all steps of the procedure are skipped.
    pub lacks: Option<String>,
    /// Part to suspect when a step fails that names none itself.
    pub suspect: Option<LruId>,
    /// Path of the script under the scripts folder.
    pub path: String,
    /// SHA-256 of the script text, in hex.
    pub sha256: String,
    /// Done before the first step.
    pub setup: Vec<Action>,
    /// Done after the last step, whatever happened.
    pub cleanup: Vec<Action>,
    pub steps: Vec<Step>,
    /// Number of measurements in the steps: the number of slots to capture them.
    pub slots: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Name, unique in the procedure.
    pub name: String,
    /// Source line of the `step()` call.
    pub line: u32,
    /// Actions of the step, in order.
    pub actions: Vec<Action>,
    pub expectations: Vec<Expectation>,
    /// Where the numbers of the step's expectations come from: times, and values with which signals are compared.
    pub origin: Origin,
    pub measures: Vec<Measure>,
    /// Events this step is meant to cause.
    pub provokes: Vec<Event>,
    /// Run only if this holds when the step's turn comes; else skipped.
    pub when: Option<Condition>,
    /// Reason in unit type, line or train for which the step is skipped.
    pub lacks: Option<String>,
    /// Number of repetitions, each of which must pass.
    pub repeat: u32,
    /// Course after a failure of the step.
    pub on_fail: OnFail,
    /// The step begins in the state that the step before left, and cannot be run without that step.
    pub continues: bool,
    /// Time after which the step is ended as an error.
    pub time_limit: Duration,
    /// Longest time one repetition can take.
    pub worst_case: Duration,
    /// Part to suspect when the step fails: the step's own, else the procedure's.
    pub suspect: Option<LruId>,
    /// A remark for the technician.
    pub note: Option<String>,
}

/// Course of a procedure after a step that did not pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum OnFail {
    /// The next step is run.
    Continue,
    /// The remaining steps are skipped.
    Stop,
}

/// One thing done by a step, setup or clean-up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// Something is done to the unit.
    Stimulus(Stimulus),
    /// Time passes.
    Wait(Duration),
    /// Waits until a condition holds; not in time = failed.
    Until {
        /// Looked at in each scan.
        condition: Condition,
        /// Time allowed.
        within: Duration,
    },
    /// Waits until tachometer motion or the tester's request is finished; not in time = error.
    Settle {
        /// Time allowed.
        within: Duration,
    },
    /// Asks the operator; without one this is an error.
    Prompt {
        text: String,
        /// Time allowed.
        within: Duration,
    },
    /// Done only where the bench harness is there: on a train the cab is as its people left it.
    OnBench(Box<Action>),
    /// Done only on a train, without the bench harness: what people do there.
    OnTrain(Box<Action>),
}

/// Observation that a step needs to pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Expectation {
    /// True at the end of the actions or at some time after.
    Becomes {
        /// True in one scan is enough.
        condition: Condition,
        /// Time allowed from the end of the actions.
        within: Duration,
    },
    /// True from the end of the actions on, without a break.
    Holds {
        /// False in one scan fails the step.
        condition: Condition,
        /// From the end of the actions.
        duration: Duration,
    },
    /// Not true at any time from the beginning to the end of the step.
    Never {
        /// True in one scan fails the step.
        condition: Condition,
    },
    /// The unit logs this event in this step.
    Logs {
        /// Event of the dictionary, of the unit or of TCMS.
        event: Event,
        /// Least and greatest value of its parameter, in the event's own unit.
        parameter: [i32; 2],
        /// Time allowed from the end of the actions.
        within: Duration,
    },
    /// The unit does not log this event in this step.
    NeverLogs {
        /// Event of the dictionary, of the unit or of TCMS.
        event: Event,
    },
}

/// From when a time is measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum TimeFrom {
    /// From the beginning of the step.
    StepStart,
    /// From the end of the actions, that is the last stimulus or wait.
    ActionsEnd,
    /// From the first scan in which this holds.
    Condition(Condition),
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum What {
    /// Time to the first scan in which a condition holds, ms.
    Time {
        /// Beginning of the measured time.
        from: TimeFrom,
        /// End of the time: the first scan in which this condition holds.
        to: Condition,
    },
    /// Value at the end of the step.
    Value(Signal),
    /// Value in the first scan in which a condition holds.
    At {
        /// Signal whose value is taken.
        signal: Signal,
        /// Looked at in each scan of the step.
        when: Condition,
    },
    /// Greatest value in the step.
    Maximum(Signal),
    /// Least value in the step.
    Minimum(Signal),
    /// Value at the end of the step less value at its beginning.
    Change(Signal),
    /// Result of an item in the unit's self-test, with the unit's own limits.
    SelfTest {
        /// Number of the item's bit.
        bit: u8,
    },
}

/// A named value with limits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// Name, unique in its step.
    pub name: String,
    /// Place among the captured values, where later steps find the measured value.
    pub slot: usize,
    pub what: What,
    /// Least value allowed, in the unit of [`unit`](Self::unit).
    pub low: Option<Operand>,
    /// Greatest value allowed, in the unit of [`unit`](Self::unit).
    pub high: Option<Operand>,
    /// Time allowed from the end of the actions; unused by values taken at the step's end.
    pub within: Duration,
    /// Where the limits come from.
    pub origin: Origin,
}

impl What {
    /// Calls `f` with each signal that is read.
    pub fn for_each_signal(&self, f: &mut impl FnMut(Signal)) {
        self.signal().into_iter().for_each(&mut *f);
        match self {
            Self::Time { from, to } => {
                if let TimeFrom::Condition(condition) = from {
                    condition.for_each_signal(f);
                }
                to.for_each_signal(f);
            }
            Self::At { when, .. } => when.for_each_signal(f),
            Self::Value(_)
            | Self::Maximum(_)
            | Self::Minimum(_)
            | Self::Change(_)
            | Self::SelfTest { .. } => {}
        }
    }

    /// The signal whose value is measured; `None` for a time and for an item of the self-test.
    pub fn signal(&self) -> Option<Signal> {
        match self {
            Self::Value(signal)
            | Self::At { signal, .. }
            | Self::Maximum(signal)
            | Self::Minimum(signal)
            | Self::Change(signal) => Some(*signal),
            Self::Time { .. } | Self::SelfTest { .. } => None,
        }
    }
}

impl Measure {
    /// Lowers the least and raises the greatest permitted value by this amount; the other way round if
    /// negative.
    pub fn widen(&mut self, by: f64) {
        let shift = |limit: &mut Operand, by: f64| match limit {
            Operand::Literal(number) => *number += by,
            Operand::Measured { offset, .. } => *offset += by,
        };
        self.low.iter_mut().for_each(|low| shift(low, -by));
        self.high.iter_mut().for_each(|high| shift(high, by));
    }

    /// Unit of the measured value; the unit of a self-test's item comes with the result.
    pub fn unit(&self) -> &'static str {
        match &self.what {
            What::Time { .. } => "ms",
            what => what.signal().map_or("", |signal| signal.definition().unit),
        }
    }

    /// Whether the step must wait for the measurement.
    pub fn is_awaited(&self) -> bool {
        matches!(self.what, What::Time { .. } | What::At { .. })
    }
}

pub(super) fn of_self_test() -> impl Iterator<Item = Measure> {
    SelfTest::SPEC.entries.iter().map(|(bit, name, _)| Measure {
        name: format!("self_test.{}", name.to_lowercase()),
        slot: usize::MAX,
        what: What::SelfTest { bit: *bit },
        low: None,
        high: None,
        within: Duration::ZERO,
        origin: Origin::of("unit"),
    })
}

impl Action {
    /// The action without `OnBench` or `OnTrain`, and whether the action is done `with_harness` (else: on a train).
    pub fn where_done(&self, with_harness: bool) -> (&Self, bool) {
        match self {
            Self::OnBench(action) => (action, with_harness),
            Self::OnTrain(action) => (action, !with_harness),
            action => (action, true),
        }
    }

    /// The action asks the operator something, wherever the action is done.
    pub(super) fn asks(&self) -> bool {
        matches!(self.where_done(true).0, Self::Prompt { .. })
    }

    /// Calls `f` with each signal that the action looks at on a train.
    fn for_each_signal(&self, f: &mut impl FnMut(Signal)) {
        match self {
            Self::Until { condition, .. } => condition.for_each_signal(f),
            Self::OnTrain(action) => action.for_each_signal(f),
            _ => {}
        }
    }
}

impl Step {
    /// Calls `f` with each signal the step looks at, apart from `when`.
    pub fn for_each_signal(&self, f: &mut impl FnMut(Signal)) {
        self.actions
            .iter()
            .for_each(|action| action.for_each_signal(f));
        for expectation in &self.expectations {
            match expectation {
                Expectation::Becomes { condition, .. }
                | Expectation::Holds { condition, .. }
                | Expectation::Never { condition } => condition.for_each_signal(f),
                Expectation::Logs { .. } | Expectation::NeverLogs { .. } => {}
            }
        }
        for measure in &self.measures {
            measure.what.for_each_signal(f);
        }
    }

    /// Gives `sources` to the numbers of the step that have no source so far.
    pub(super) fn fill(&mut self, sources: &[String]) {
        self.origin.fill(sources);
        for measure in &mut self.measures {
            measure.origin.fill(sources);
        }
    }

    /// Events that the step is meant to cause or waits for.
    pub fn provoked(&self) -> impl Iterator<Item = Event> + '_ {
        let awaited = self.expectations.iter().filter_map(|e| match e {
            Expectation::Logs { event, .. } => Some(*event),
            _ => None,
        });
        self.provokes.iter().copied().chain(awaited)
    }
}

impl Procedure {
    /// One line for each limit that names no source: script, line and step.
    pub fn without_source(&self) -> Vec<String> {
        let of_step = |step: &Step| {
            let expected = step.origin.lacks.then(|| "what it expects".to_owned());
            let measured = step.measures.iter().filter(|m| m.origin.lacks);
            let measured = measured.map(|m| format!("measurement \"{}\"", m.name));
            let said = |what| {
                let (path, line, name) = (&self.path, step.line, &step.name);
                format!("{path}:{line}: step \"{name}\", {what}: a limit names no source")
            };
            expected
                .into_iter()
                .chain(measured)
                .map(said)
                .collect::<Vec<_>>()
        };
        self.steps.iter().flat_map(of_step).collect()
    }

    /// The procedure asks the operator something, on a bench or on a train.
    pub fn asks(&self) -> bool {
        let steps = self.steps.iter().flat_map(|step| &step.actions);
        let mut actions = self.setup.iter().chain(&self.cleanup).chain(steps);
        actions.any(Action::asks)
    }

    /// Calls `f` with each signal that set-up or a step looks at.
    pub fn for_each_signal(&self, f: &mut impl FnMut(Signal)) {
        self.setup
            .iter()
            .for_each(|action| action.for_each_signal(f));
        self.steps.iter().for_each(|step| step.for_each_signal(f));
    }
}
