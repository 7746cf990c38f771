//! How much wider a bench makes limits: by as much as its instruments act and read late, and by what a reading is uncertain.

use std::collections::BTreeSet;

use btu_rig::procedure::plan::{Action, Expectation, Step, What};
use btu_rig::stimulus::Stimulus;
use protocol::Duration;
use protocol::signal::Signal;

use super::file::Places;
use super::points::{Place, Point};
use super::teller::Teller;
use crate::words::BenchNote;

/// The action itself, without the mark that it is for a bench or a train only.
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

/// Greatest speed and acceleration of steps that continue each other.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Motion {
    speed_mps: f64,
    accel_mps2: f64,
}

/// Any signal that the bench reads.
pub(super) const READ_ANY: fn(Signal) -> bool = |_| true;

impl Places {
    fn late(&self, point: &Point) -> Duration {
        match point.place() {
            Place::Instrument(name) => Duration::from_ms(self.instruments[name].uncertainty_ms),
            _ => Duration::ZERO,
        }
    }

    /// How late the latest of its instruments acts.
    pub(super) fn acts_late(&self) -> Duration {
        let all = self.stimuli.values().map(|point| self.late(point));
        all.max().unwrap_or(Duration::ZERO)
    }

    /// How late the latest of these signals is read.
    pub(super) fn reads_late(&self, of: &dyn Fn(Signal) -> bool) -> Duration {
        let read = self.readings.iter().filter(|(signal, _)| of(**signal));
        let late = read.map(|(_, point)| self.late(point));
        late.max().unwrap_or(Duration::ZERO)
    }

    /// Widens the limits of a step. `motion` is what the steps that this one continues have left, and becomes what this
    /// one leaves.
    pub(super) fn widen(&self, step: &mut Step, motion: &mut Motion, tell: &Teller<'_>) {
        let acts = self.acts_late();
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
                motion.speed_mps = motion.speed_mps.max(speed.mps());
                motion.accel_mps2 = motion.accel_mps2.max(*accel_mps2);
            }
        }
        for measure in &mut step.measures {
            let mut signals = BTreeSet::new();
            measure.what.for_each_signal(&mut |signal| {
                signals.insert(signal);
            });
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
                        "km/h" => motion.accel_mps2 * 3.6,
                        "m" => motion.speed_mps,
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
                measure.widen(by);
                measure.within += late;
                let by = format!("{:.1} {}", by, measure.unit());
                measure
                    .origin
                    .add((tell.note)(BenchNote::Wider(self.name.clone(), used, by)));
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
        wider |= self.wait_longer(&mut step.actions);
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
                .add((tell.note)(BenchNote::Wider(self.name.clone(), used, by)));
        }
    }

    /// Gives each wait for a condition as much more time as instruments act and read late; whether there is such a
    /// wait.
    pub(super) fn wait_longer(&self, actions: &mut [Action]) -> bool {
        let late = self.acts_late() + self.reads_late(&READ_ANY);
        let mut longer = false;
        for action in actions.iter_mut().map(inner_mut) {
            if let Action::Until { within, .. } = action {
                *within += late;
                longer = true;
            }
        }
        longer
    }

    /// Instruments behind signals, and those that act, with their serial numbers.
    pub(super) fn used_for(&self, signals: &BTreeSet<Signal>, acts: Duration) -> String {
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
