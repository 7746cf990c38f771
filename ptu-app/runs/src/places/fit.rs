//! Procedures as a bench can do them: steps that the bench cannot do are skipped with the reason, a person is asked for what
//! a person does, and limits are widened by the uncertainty of the instruments; each step says so.

use std::sync::Arc;

use btu_rig::procedure::plan::{Action, Condition, Expectation, Procedure, Step};
use btu_rig::rig::InstrumentFault;
use btu_rig::stimulus::Stimulus;
use protocol::Duration;
use protocol::signal::Signal;

use super::file::Places;
use super::instrument::InstrumentEntry;
use super::model::code_values;
use super::needs::{DRIVES, FOLLOWS, needs};
use super::points::{Place, Point, UnitInput};
use super::teller::Teller;
use super::widen::{Motion, READ_ANY, inner, inner_mut};
use crate::words::BenchNote;

impl Places {
    /// The procedures as this bench does them; `tell` puts the changes into words.
    pub fn fit(&self, procedures: Vec<Arc<Procedure>>, tell: &Teller<'_>) -> Vec<Arc<Procedure>> {
        let fit = |mut procedure: Arc<Procedure>| {
            self.fit_one(Arc::make_mut(&mut procedure), tell);
            procedure
        };
        procedures.into_iter().map(fit).collect()
    }

    /// Outputs of instruments without a watchdog, which a person has to switch off if the program was killed.
    pub fn by_hand(&self) -> impl Iterator<Item = BenchNote> {
        let told = |(name, entry): (&String, &InstrumentEntry)| {
            let what = entry.by_hand.clone().filter(|_| entry.watchdog.is_none())?;
            Some(BenchNote::ByHand(name.clone(), what))
        };
        self.instruments.iter().filter_map(told)
    }

    fn fit_one(&self, procedure: &mut Procedure, tell: &Teller<'_>) {
        if procedure.lacks.is_none() {
            let lacks = procedure
                .setup
                .iter()
                .find_map(|action| self.lacks_for(action, tell));
            procedure.lacks = lacks.map(tell.note);
        }
        self.wait_longer(&mut procedure.setup);
        self.wait_longer(&mut procedure.cleanup);
        self.ask_for(&mut procedure.setup, tell);
        self.ask_for(&mut procedure.cleanup, tell);
        let mut before: Option<String> = None;
        let mut motion = Motion::default();
        for step in &mut procedure.steps {
            let own = step
                .lacks
                .is_none()
                .then(|| self.step_lacks(step, tell).map(tell.note))
                .flatten();
            if !step.continues {
                motion = Motion::default();
            }
            // The step cannot begin in the state that the step before would have left.
            let lacks = own.or_else(|| before.clone().filter(|_| step.continues));
            if let Some(lacks) = &lacks {
                step.lacks = Some(lacks.clone());
            } else {
                self.fit_step(step, &mut motion, tell);
            }
            before = lacks;
        }
    }

    fn fit_step(&self, step: &mut Step, motion: &mut Motion, tell: &Teller<'_>) {
        let before = worst_case(&step.actions);
        self.widen(step, motion, tell);
        self.see_for(step, tell);
        self.ask_for(&mut step.actions, tell);
        let longer =
            worst_case(&step.actions) - before + self.acts_late() + self.reads_late(&READ_ANY);
        step.time_limit += longer;
        step.worst_case += longer;
    }

    fn unread_note(&self, signal: Signal, tell: &Teller<'_>) -> BenchNote {
        let (bench, what) = (self.name.clone(), (tell.signal)(signal));
        match self.readings.get(&signal).map(Point::place) {
            Some(Place::Operator(_)) => BenchNote::TooSlow(bench, what),
            _ => BenchNote::Unread(bench, what),
        }
    }

    /// Reason for which this bench cannot do the action, if there is one.
    fn lacks_for(&self, action: &Action, tell: &Teller<'_>) -> Option<BenchNote> {
        use UnitInput as U;
        match inner(action) {
            Action::Stimulus(stimulus) => {
                // A unit that is not told of doors by side goes by the line of all doors.
                let of_all = matches!(
                    stimulus,
                    Stimulus::Doors { .. } | Stimulus::DoorsFollow { .. }
                ) && self.is_none(U::DoorsBySide);
                let drives = matches!(stimulus, Stimulus::TrainDriven { on: true });
                if let Some(signal) = DRIVES.iter().find(|one| drives && self.unread(**one)) {
                    return Some(self.unread_note(*signal, tell));
                }
                let mut needs = needs(stimulus).iter();
                let missing = needs
                    .find(|name| self.is_none(**name) && (!of_all || **name == U::DoorsClosed));
                missing
                    .map(|name| BenchNote::NoPlace(self.name.clone(), (tell.text)(name.name())))
                    .or_else(|| self.beyond(stimulus))
            }
            Action::Until { condition, .. } if self.seen(condition).is_none() => {
                let mut missing = None;
                condition.for_each_signal(&mut |signal| {
                    if self.unread(signal) {
                        missing.get_or_insert(signal);
                    }
                });
                missing.map(|signal| self.unread_note(signal, tell))
            }
            _ => None,
        }
    }

    fn is_none(&self, input: UnitInput) -> bool {
        let point = self.stimuli.get(&input);
        point.is_some_and(|point| point.place() == Place::None)
    }

    /// Whether neither an instrument nor a frame reads the signal.
    fn unread(&self, signal: Signal) -> bool {
        let by_itself = |signal: &Signal| {
            let place = self.readings.get(signal).map(Point::place);
            matches!(place, Some(Place::None | Place::Operator(_)))
        };
        let follows = FOLLOWS.iter().filter(|(of, _)| *of == signal);
        by_itself(&signal) || follows.flat_map(|(_, from)| *from).any(by_itself)
    }

    /// A code that the generator cannot make.
    fn beyond(&self, stimulus: &Stimulus) -> Option<BenchNote> {
        let Stimulus::Code(signal) = *stimulus else {
            return None;
        };
        let Place::Instrument(name) = self.stimuli.get(&UnitInput::Code)?.place() else {
            return None;
        };
        let values = code_values(signal.carrier_hz, signal.rate_hz, signal.level_mv);
        if values["level_mv"] == 0.0 {
            return None;
        }
        let model = self.models.get(name)?;
        let unmodulated = &model.acts.get("code")?.get_ref().unmodulated;
        let beyond = match signal.rate_hz <= 0.0 && unmodulated.is_empty() {
            true => InstrumentFault::NoUnmodulated,
            false => model.out_of_range(&values)?,
        };
        Some(BenchNote::Beyond(
            self.name.clone(),
            name.to_owned(),
            beyond,
        ))
    }

    fn step_lacks(&self, step: &Step, tell: &Teller<'_>) -> Option<BenchNote> {
        let missing = step
            .actions
            .iter()
            .find_map(|action| self.lacks_for(action, tell));
        missing.or_else(|| {
            let mut missing = None;
            let mut seen = step.clone();
            seen.expectations
                .retain(|expected| self.asked(expected).is_none());
            seen.actions.retain(|action| !self.is_seen(action));
            seen.for_each_signal(&mut |signal| {
                if self.unread(signal) {
                    missing.get_or_insert(signal);
                }
            });
            missing.map(|signal| self.unread_note(signal, tell))
        })
    }

    /// The condition that a person has to see, and the time for that, s.
    fn asked<'a>(&self, expected: &'a Expectation) -> Option<(&'a Condition, u64)> {
        let Expectation::Becomes { condition, .. } = expected else {
            return None;
        };
        Some((condition, self.seen(condition)?))
    }

    /// The action waits for something that a person sees.
    fn is_seen(&self, action: &Action) -> bool {
        matches!(inner(action), Action::Until { condition, .. } if self.seen(condition).is_some())
    }

    /// Time in which a person says whether the condition holds, s; `None` if the condition is not for a person alone.
    fn seen(&self, condition: &Condition) -> Option<u64> {
        let (mut all, mut within) = (true, None);
        condition.for_each_signal(
            &mut |signal| match self.readings.get(&signal).map(Point::place) {
                Some(Place::Operator(within_s)) => within = Some(within_s),
                _ => all = false,
            },
        );
        within.filter(|_| all)
    }

    /// Asks the person at the end of the actions for what a person sees.
    fn see_for(&self, step: &mut Step, tell: &Teller<'_>) {
        let asked: Vec<_> = step
            .expectations
            .iter()
            .filter_map(|e| self.asked(e))
            .map(|(what, within_s)| (BenchNote::See((tell.condition)(what)), within_s))
            .collect();
        step.expectations
            .retain(|expected| self.asked(expected).is_none());
        for (what, within_s) in asked {
            let note = BenchNote::Looks(self.name.clone(), within_s);
            step.origin.add((tell.note)(note));
            step.actions.push(Action::Prompt {
                text: (tell.note)(what),
                within: Duration::from_ms(within_s * 1000),
            });
        }
    }

    /// Asks the person to do what a person does, before it counts as done, and for what a person sees, in place of waiting.
    fn ask_for(&self, actions: &mut Vec<Action>, tell: &Teller<'_>) {
        let asked = |mut action: Action| {
            let inner_action = inner_mut(&mut action);
            if let Action::Until { condition, .. } = &*inner_action
                && let Some(within_s) = self.seen(condition)
            {
                *inner_action = Action::Prompt {
                    text: (tell.note)(BenchNote::See((tell.condition)(condition))),
                    within: Duration::from_ms(within_s * 1000),
                };
            }
            let within = match inner(&action) {
                Action::Stimulus(stimulus) => {
                    needs(stimulus)
                        .iter()
                        .find_map(|name| match self.stimuli.get(name)?.place() {
                            Place::Operator(within_s) => Some((*stimulus, within_s)),
                            _ => None,
                        })
                }
                _ => None,
            };
            let prompt = within.map(|(what, within_s)| {
                let prompt = Action::Prompt {
                    text: (tell.note)(BenchNote::Do((tell.text)(&what.to_string()))),
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
