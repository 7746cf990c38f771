//! What a bench makes of procedures: steps that it cannot do are skipped with the reason, a person is asked for what a
//! person does, and limits are as much wider as its instruments are uncertain; each says so.

use std::collections::BTreeSet;
use std::sync::Arc;

use btu_rig::procedure::plan::{
    Action, Expectation, Measure, Operand, Procedure, Step, TimeFrom, What,
};
use btu_rig::stimulus::Stimulus;
use protocol::Duration;
use protocol::signal::Signal;

use super::file::{InstrumentEntry, Place, Places, Point};
use super::worker::Values;
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
        Stimulus::Doors { .. } | Stimulus::DoorsFollow { .. } => &["doors_closed"],
        Stimulus::SideDoors { left: true, .. } | Stimulus::DoorObstacle { left: true, .. } => {
            &["doors_by_side", "left_closed", "left_locked"]
        }
        Stimulus::SideDoors { .. } | Stimulus::DoorObstacle { .. } => {
            &["doors_by_side", "right_closed", "right_locked"]
        }
        Stimulus::DoorLine { on: Some(_), .. } => &["doors_closed", "doors_by_side"],
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
        _ => &[],
    }
}

/// The action itself, wherever it is done.
fn inner(action: &Action) -> &Action {
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
        self.ask_for(&mut procedure.setup, say);
        self.ask_for(&mut procedure.cleanup, say);
        let mut before: Option<String> = None;
        for step in &mut procedure.steps {
            let own = step
                .lacks
                .is_none()
                .then(|| self.step_lacks(step).map(say))
                .flatten();
            // It cannot begin in the state that a step left which was not run.
            let lacks = own.or_else(|| before.clone().filter(|_| step.continues));
            if let Some(lacks) = &lacks {
                step.lacks = Some(lacks.clone());
            } else {
                self.fit_step(step, say);
            }
            before = lacks;
        }
    }

    fn fit_step(&self, step: &mut Step, say: &dyn Fn(BenchNote) -> String) {
        let before = worst_case(&step.actions);
        self.widen(step, say);
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
                let missing = needs(stimulus).iter().find(|name| self.is_none(name));
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
        let model = self.models.get(name)?;
        let can =
            level_mv == 0.0 || rate_hz > 0.0 || !model.acts.get("code")?.unmodulated.is_empty();
        if !can {
            return Some(self.no_place("code, unmodulated"));
        }
        let values = Values::from([
            ("carrier_hz", carrier_hz),
            ("rate_hz", rate_hz),
            ("level_mv", level_mv),
        ]);
        let beyond = model.out_of_range(&values)?;
        Some(BenchNote::Beyond(
            self.name.clone(),
            name.to_owned(),
            beyond.to_string(),
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

    fn late(&self, point: &Point) -> Duration {
        match point.place() {
            Place::Instrument(name) => Duration::from_ms(self.instruments[name].uncertainty_ms),
            _ => Duration::ZERO,
        }
    }

    /// How late the latest of its instruments acts.
    fn acts_late(&self) -> Duration {
        let all = self.stimuli.values().map(|point| self.late(point));
        all.max().unwrap_or(Duration::ZERO)
    }

    /// How late the latest of these signals is read.
    fn reads_late(&self, of: &dyn Fn(Signal) -> bool) -> Duration {
        let read = self.readings.iter().filter(|(signal, _)| of(**signal));
        let late = read.map(|(_, point)| self.late(point));
        late.max().unwrap_or(Duration::ZERO)
    }

    fn widen(&self, step: &mut Step, say: &dyn Fn(BenchNote) -> String) {
        let acts = self.acts_late();
        let mut motion = (0.0f64, 0.0f64);
        for action in &step.actions {
            if let Action::Stimulus(
                Stimulus::Speed {
                    to: speed,
                    accel_mps2,
                }
                | Stimulus::Travel {
                    speed, accel_mps2, ..
                },
            ) = inner(action)
            {
                motion = (motion.0.max(speed.mps()), motion.1.max(*accel_mps2));
            }
        }
        for measure in &mut step.measures {
            let signals = signals_of(measure);
            let late = acts + self.reads_late(&|signal| signals.contains(&signal));
            let of_value = |signal: &Signal| {
                self.readings
                    .get(signal)
                    .map_or(0.0, |point| point.uncertainty)
            };
            let by = match &measure.what {
                What::Time { .. } => late.as_secs() * 1000.0,
                What::At { signal, .. } => {
                    let moves = match signal.definition().unit {
                        "km/h" => motion.1 * 3.6,
                        "m" => motion.0,
                        _ => 0.0,
                    };
                    of_value(signal) + moves * late.as_secs()
                }
                What::Value(signal) | What::Maximum(signal) | What::Minimum(signal) => {
                    of_value(signal)
                }
                What::Change(signal) => 2.0 * of_value(signal),
                What::SelfTest { .. } => 0.0,
            };
            let used = self.used_for(&signals, acts);
            if by > 0.0 && !used.is_empty() {
                measure.low.iter_mut().for_each(|low| shift(low, -by));
                measure.high.iter_mut().for_each(|high| shift(high, by));
                measure.within += late;
                let by = format!("{:.1} {}", by, measure.unit());
                measure
                    .origin
                    .add(say(BenchNote::Wider(self.name.clone(), used, by)));
            }
        }
        let late = acts + self.reads_late(&READ_ANY);
        if late == Duration::ZERO {
            return;
        }
        let mut wider = false;
        for expected in &mut step.expectations {
            if let Expectation::Becomes { within, .. } | Expectation::Logs { within, .. } = expected
            {
                *within += late;
                wider = true;
            }
        }
        for action in &mut step.actions {
            if let Action::Until { within, .. } = action {
                *within += late;
                wider = true;
            }
        }
        // Until all instruments have acted, the unit shows what was before; until all have read, some of them do.
        let holds = |expected: &Expectation| matches!(expected, Expectation::Holds { .. });
        let acted = matches!(step.actions.last().map(inner), Some(Action::Stimulus(_)));
        match step.expectations.iter().any(holds) {
            true => step.actions.push(Action::Wait(late)),
            false if acted => step.actions.push(Action::Wait(acts)),
            false => {}
        }
        if wider {
            let used = self.safe.join(" ");
            let by = format!("{:.0} ms", late.as_secs() * 1000.0);
            step.origin
                .add(say(BenchNote::Wider(self.name.clone(), used, by)));
        }
    }

    /// Instruments behind signals, and those that act, with their serial numbers.
    fn used_for(&self, signals: &BTreeSet<Signal>, acts: Duration) -> String {
        let read = signals
            .iter()
            .filter_map(|signal| self.readings.get(signal));
        let act = self.stimuli.values().filter(|_| acts > Duration::ZERO);
        let names = read.chain(act).filter_map(|point| match point.place() {
            Place::Instrument(name) => Some(name),
            _ => None,
        });
        let names: BTreeSet<_> = names.collect();
        let told = names
            .into_iter()
            .map(|name| format!("{name} {}", self.instruments[name].serial));
        told.collect::<Vec<_>>().join(", ")
    }
}

/// Whatever is read.
const READ_ANY: fn(Signal) -> bool = |_| true;

fn worst_case(actions: &[Action]) -> Duration {
    let add = |sum: Duration, action: &Action| sum + action.worst_case();
    actions.iter().fold(Duration::ZERO, add)
}

fn signals_of(measure: &Measure) -> BTreeSet<Signal> {
    let mut signals = BTreeSet::new();
    let mut note = |signal| {
        signals.insert(signal);
    };
    match &measure.what {
        What::Time { from, to } => {
            if let TimeFrom::Condition(from) = from {
                from.for_each_signal(&mut note);
            }
            to.for_each_signal(&mut note);
        }
        What::At { signal, when } => {
            note(*signal);
            when.for_each_signal(&mut note);
        }
        What::Value(signal)
        | What::Maximum(signal)
        | What::Minimum(signal)
        | What::Change(signal) => {
            note(*signal);
        }
        What::SelfTest { .. } => {}
    }
    signals
}

fn shift(limit: &mut Operand, by: f64) {
    match limit {
        Operand::Literal(number) => *number += by,
        Operand::Measured { offset, .. } => *offset += by,
    }
}
