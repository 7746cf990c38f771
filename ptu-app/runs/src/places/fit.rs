//! What a bench makes of procedures: steps that it cannot do are skipped with the reason, a person is asked for what a
//! person does, and limits are as much wider as its instruments are uncertain; each says so.

use std::sync::Arc;

use btu_rig::procedure::plan::{Action, Expectation, Procedure, Step};
use btu_rig::stimulus::{DoorLine, Stimulus};
use protocol::Duration;
use protocol::signal::Signal;

use super::file::{InstrumentEntry, Place, Places, Point};
use super::model::code_values;
use super::widen::{Motion, READ_ANY};
use crate::words::BenchNote;

/// What a stimulus needs.
fn needs(stimulus: &Stimulus) -> &'static [&'static str] {
    match stimulus {
        Stimulus::Code { .. } | Stimulus::CodeDrift { .. } | Stimulus::CodesAlong { on: true } => {
            &["code"]
        }
        Stimulus::Crosstalk { level_mv, .. } if *level_mv > 0.0 => &["crosstalk"],
        Stimulus::Speed { .. }
        | Stimulus::Travel { .. }
        | Stimulus::Direction { .. }
        | Stimulus::TrainDriven { on: true } => &["tacho1", "tacho2"],
        Stimulus::Tacho { channel: 1, .. } => &["tacho1"],
        Stimulus::Tacho { .. } => &["tacho2"],
        Stimulus::Marker { .. }
        | Stimulus::MarkerMoved { .. }
        | Stimulus::MarkersAlong { section: Some(_) } => &["marker"],
        Stimulus::Station(_) | Stimulus::Orders(Some(_)) | Stimulus::Wayside(_) => &["twc"],
        Stimulus::Doors { .. } | Stimulus::DoorsFollow { .. } => &[
            "doors_closed",
            "left_closed",
            "left_locked",
            "right_closed",
            "right_locked",
        ],
        Stimulus::SideDoors { left: true, .. } | Stimulus::DoorObstacle { left: true, .. } => {
            &["doors_by_side", "left_closed", "left_locked"]
        }
        Stimulus::SideDoors { .. } | Stimulus::DoorObstacle { .. } => {
            &["doors_by_side", "right_closed", "right_locked"]
        }
        Stimulus::DoorLine { on: Some(_), line } => match line {
            DoorLine::All => &["doors_closed"],
            DoorLine::LeftClosed => &["left_closed"],
            DoorLine::LeftLocked => &["left_locked"],
            DoorLine::RightClosed => &["right_closed"],
            DoorLine::RightLocked => &["right_locked"],
            DoorLine::BySide => &["doors_by_side"],
        },
        Stimulus::Hcr { .. } => &["hcr"],
        Stimulus::MaintenanceKey { .. } => &["maintenance_key"],
        Stimulus::TrainNumber { number: 1.. } => &["entries"],
        Stimulus::WheelDiameter { diameter_mm } if *diameter_mm > 0.0 => &["entries"],
        Stimulus::ModeSwitch(_) => &["mode_switch"],
        Stimulus::Controller { .. }
        | Stimulus::ControllerVolts { volts: Some(_) }
        | Stimulus::ControllerContacts { contacts: Some(_) } => &["controller"],
        Stimulus::Reverser { .. } => &["forward", "backward"],
        Stimulus::Acknowledge => &["acknowledge"],
        Stimulus::Start => &["start"],
        Stimulus::Crosstalk { .. }
        | Stimulus::CodeOff
        | Stimulus::CodesAlong { on: false }
        | Stimulus::TrainDriven { on: false }
        | Stimulus::Adhesion { .. }
        | Stimulus::MarkersAlong { section: None }
        | Stimulus::Orders(None)
        | Stimulus::DoorLine { on: None, .. }
        | Stimulus::TrainNumber { number: 0 }
        | Stimulus::WheelDiameter { .. }
        | Stimulus::ControllerVolts { volts: None }
        | Stimulus::ControllerContacts { contacts: None }
        | Stimulus::Switch { .. }
        | Stimulus::CutOut { .. }
        | Stimulus::Failure { .. }
        | Stimulus::Gradient { .. }
        | Stimulus::Tcms(_)
        | Stimulus::AtoEnable { .. }
        | Stimulus::Load { .. }
        | Stimulus::PtuArm
        | Stimulus::PtuAskToArm
        | Stimulus::PtuDisarm
        | Stimulus::PtuSilent { .. }
        | Stimulus::PtuCode { .. }
        | Stimulus::PtuSpeed { .. }
        | Stimulus::PtuMarker { .. }
        | Stimulus::PtuTwc(_)
        | Stimulus::PtuRelease
        | Stimulus::PtuSelfTest
        | Stimulus::PtuClearLog => &[],
    }
}

/// The action itself, wherever it is done.
pub(super) fn inner(action: &Action) -> &Action {
    match action {
        Action::OnBench(action) | Action::OnTrain(action) => action,
        action => action,
    }
}

pub(super) fn inner_mut(action: &mut Action) -> &mut Action {
    match action {
        Action::OnBench(action) | Action::OnTrain(action) => action,
        action => action,
    }
}

impl Places {
    /// The procedures as this bench does them; `say` puts a note into words.
    pub fn fit(
        &self,
        procedures: Vec<Arc<Procedure>>,
        say: &dyn Fn(BenchNote) -> String,
    ) -> Vec<Arc<Procedure>> {
        let fit = |mut procedure: Arc<Procedure>| {
            self.fit_one(Arc::make_mut(&mut procedure), say);
            procedure
        };
        procedures.into_iter().map(fit).collect()
    }

    /// What is to be switched off by hand if the program was killed, of instruments without a watchdog.
    pub fn by_hand(&self) -> impl Iterator<Item = BenchNote> {
        let told = |(name, entry): (&String, &InstrumentEntry)| {
            let what = entry.by_hand.clone().filter(|_| entry.watchdog.is_none())?;
            Some(BenchNote::ByHand(name.clone(), what))
        };
        self.instruments.iter().filter_map(told)
    }

    fn fit_one(&self, procedure: &mut Procedure, say: &dyn Fn(BenchNote) -> String) {
        if procedure.lacks.is_none() {
            let lacks = procedure
                .setup
                .iter()
                .find_map(|action| self.lacks_for(action));
            procedure.lacks = lacks.map(say);
        }
        self.wait_longer(&mut procedure.setup);
        self.wait_longer(&mut procedure.cleanup);
        self.ask_for(&mut procedure.setup, say);
        self.ask_for(&mut procedure.cleanup, say);
        let mut before: Option<String> = None;
        let mut motion = Motion::default();
        for step in &mut procedure.steps {
            let own = step
                .lacks
                .is_none()
                .then(|| self.step_lacks(step).map(say))
                .flatten();
            if !step.continues {
                motion = Motion::default();
            }
            // It cannot begin in the state that a step left which was not run.
            let lacks = own.or_else(|| before.clone().filter(|_| step.continues));
            if let Some(lacks) = &lacks {
                step.lacks = Some(lacks.clone());
            } else {
                self.fit_step(step, &mut motion, say);
            }
            before = lacks;
        }
    }

    fn fit_step(&self, step: &mut Step, motion: &mut Motion, say: &dyn Fn(BenchNote) -> String) {
        let before = worst_case(&step.actions);
        self.widen(step, motion, say);
        self.see_for(step, say);
        self.ask_for(&mut step.actions, say);
        let longer =
            worst_case(&step.actions) - before + self.acts_late() + self.reads_late(&READ_ANY);
        step.time_limit += longer;
        step.worst_case += longer;
    }

    fn no_place(&self, what: &str) -> BenchNote {
        BenchNote::NoPlace(self.name.clone(), what.to_owned())
    }

    /// Why this bench cannot do the action, if so.
    fn lacks_for(&self, action: &Action) -> Option<BenchNote> {
        match inner(action) {
            Action::Stimulus(stimulus) => {
                // Without word of doors by side, the unit goes by the line of all doors.
                let of_all = matches!(
                    stimulus,
                    Stimulus::Doors { .. } | Stimulus::DoorsFollow { .. }
                ) && self.is_none("doors_by_side");
                let mut needs = needs(stimulus).iter();
                let missing =
                    needs.find(|name| self.is_none(name) && (!of_all || **name == "doors_closed"));
                missing
                    .map(|name| self.no_place(name))
                    .or_else(|| self.beyond(stimulus))
            }
            Action::Until { condition, .. } => {
                let mut missing = None;
                condition.for_each_signal(&mut |signal| {
                    if self.unread(signal) {
                        missing.get_or_insert(signal);
                    }
                });
                missing.map(|signal| self.no_place(signal.name()))
            }
            _ => None,
        }
    }

    fn is_none(&self, stimulus: &str) -> bool {
        let point = self.stimuli.get(stimulus);
        point.is_some_and(|point| point.place() == Place::None)
    }

    /// No instrument and no frame reads it.
    fn unread(&self, signal: Signal) -> bool {
        let place = self.readings.get(&signal).map(Point::place);
        matches!(place, Some(Place::None | Place::Operator(_)))
    }

    /// A code that the generator cannot make.
    fn beyond(&self, stimulus: &Stimulus) -> Option<BenchNote> {
        let Stimulus::Code {
            carrier_hz,
            rate_hz,
            level_mv,
        } = *stimulus
        else {
            return None;
        };
        let Place::Instrument(name) = self.stimuli.get("code")?.place() else {
            return None;
        };
        let values = code_values(carrier_hz, rate_hz, level_mv);
        if values["level_mv"] == 0.0 {
            return None;
        }
        let model = self.models.get(name)?;
        if rate_hz <= 0.0 && model.acts.get("code")?.get_ref().unmodulated.is_empty() {
            return Some(self.no_place("code, unmodulated"));
        }
        let beyond = model.out_of_range(&values)?;
        Some(BenchNote::Beyond(
            self.name.clone(),
            name.to_owned(),
            beyond,
        ))
    }

    fn step_lacks(&self, step: &Step) -> Option<BenchNote> {
        let missing = step
            .actions
            .iter()
            .find_map(|action| self.lacks_for(action));
        missing.or_else(|| {
            let mut missing = None;
            let mut seen = step.clone();
            seen.expectations
                .retain(|expected| self.asked(expected).is_none());
            seen.for_each_signal(&mut |signal| {
                if self.unread(signal) {
                    missing.get_or_insert(signal);
                }
            });
            missing.map(|signal| self.no_place(signal.name()))
        })
    }

    /// What a person has to see, and in which time.
    fn asked(&self, expected: &Expectation) -> Option<(String, u64)> {
        let Expectation::Becomes { condition, .. } = expected else {
            return None;
        };
        let (mut all, mut within) = (true, None);
        condition.for_each_signal(
            &mut |signal| match self.readings.get(&signal).map(Point::place) {
                Some(Place::Operator(within_s)) => within = Some(within_s),
                _ => all = false,
            },
        );
        within
            .filter(|_| all)
            .map(|within| (condition.to_string(), within))
    }

    /// What a person sees is asked at the end of the actions.
    fn see_for(&self, step: &mut Step, say: &dyn Fn(BenchNote) -> String) {
        let asked: Vec<_> = step
            .expectations
            .iter()
            .filter_map(|e| self.asked(e))
            .collect();
        step.expectations
            .retain(|expected| self.asked(expected).is_none());
        for (what, within_s) in asked {
            step.actions.push(Action::Prompt {
                text: say(BenchNote::See(what)),
                within: Duration::from_ms(within_s * 1000),
            });
        }
    }

    /// What a person does is asked for before it counts as done.
    fn ask_for(&self, actions: &mut Vec<Action>, say: &dyn Fn(BenchNote) -> String) {
        let asked = |action: Action| {
            let within = match inner(&action) {
                Action::Stimulus(stimulus) => {
                    needs(stimulus)
                        .iter()
                        .find_map(|name| match self.stimuli.get(name)?.place() {
                            Place::Operator(within_s) => Some((stimulus.to_string(), within_s)),
                            _ => None,
                        })
                }
                _ => None,
            };
            let prompt = within.map(|(what, within_s)| {
                let prompt = Action::Prompt {
                    text: say(BenchNote::Do(what)),
                    within: Duration::from_ms(within_s * 1000),
                };
                match &action {
                    Action::OnBench(_) => Action::OnBench(Box::new(prompt)),
                    Action::OnTrain(_) => Action::OnTrain(Box::new(prompt)),
                    _ => prompt,
                }
            });
            prompt.into_iter().chain([action])
        };
        *actions = std::mem::take(actions)
            .into_iter()
            .flat_map(asked)
            .collect();
    }
}

fn worst_case(actions: &[Action]) -> Duration {
    let add = |sum: Duration, action: &Action| sum + action.worst_case();
    actions.iter().fold(Duration::ZERO, add)
}
