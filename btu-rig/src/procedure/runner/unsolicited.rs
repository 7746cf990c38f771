//! Events and emergency brakes of the unit that no step provoked, and a clock that goes wrong.

use protocol::Instant;
use protocol::event::{Event, LOG_ENTRIES, Severity};
use protocol::signal::{Sample, Signal};

use super::{Phase, Runner};
use crate::procedure::UnitEvent;
use crate::procedure::Verdict;
use crate::procedure::finding::Finding;
use crate::procedure::plan::Step;
use crate::procedure::report::{Outside, RunEvent};

/// Events after which the emergency brake is applied.
const BRAKING_EVENTS: [Event; 15] = [
    Event::SelfTestFailed,
    Event::InternalError,
    Event::InputsLost,
    Event::OverspeedEb,
    Event::ServiceBrakeIneffective,
    Event::TachoDisagree,
    Event::TachoDead1,
    Event::TachoDead2,
    Event::TachoDirection,
    Event::TachoNoise1,
    Event::TachoNoise2,
    Event::Rollback,
    Event::EbRelayWelded,
    Event::EbRelayOpen,
    Event::DoorOpenMoving,
];

impl Runner {
    /// Hands the unit's events to the live step and reports those that no step provoked.
    ///
    /// Only while steps run: power-up, making safe and what the last procedure left behind cause
    /// events of their own. A restart of the unit by itself counts at any time.
    pub(super) fn take_unit_events(&mut self, events: &[UnitEvent], now: Instant) {
        let evidence = &self.evidence;
        let is_open =
            |entry: &UnitEvent| evidence.leaves_open(Event::from_code(entry.code), entry.parameter);
        let all = self.left_open.drain(..).chain(events.iter().copied());
        let (open, events): (Vec<_>, Vec<_>) = all.partition(is_open);
        self.left_open = open;
        let restarts =
            |entry: &&UnitEvent| Event::from_code(entry.code).is_some_and(Event::restarts_unit);
        let pause = self.after_pause(now);
        let Phase::Steps { live, .. } = &mut self.phase else {
            for entry in events.iter().filter(restarts) {
                self.restarted = true;
                self.outside_event(entry, now);
                self.out.push(RunEvent::UnsolicitedEvent(*entry));
            }
            return;
        };
        self.restarted |= events.iter().any(|entry| restarts(&entry));
        if let Some(step) = live.as_mut().filter(|_| self.restarted) {
            step.note_restart();
        }
        let mut outside = Vec::new();
        for entry in &events {
            let known = Event::from_code(entry.code);
            if let (Some(step), Some(event)) = (live.as_mut(), known) {
                step.note_event(event, entry.parameter);
            }
            // An event that is not in the dictionary cannot have been asked for.
            let asked = known.is_some_and(|event| {
                event.definition().severity <= Severity::Info || self.provoked.contains(&event)
            });
            if !asked && self.evidence.explains(known, entry.parameter) {
                if let Some(step) = live.as_mut() {
                    step.hold_against_line(Some(entry.into()));
                }
            } else if let Some(by) = pause.filter(|_| !asked && live.is_some()) {
                self.stood_still = Some(by);
            } else if !asked {
                self.verdict = self.verdict.and(Verdict::Failed);
                if let Some(step) = live.as_mut() {
                    step.fail_by_event(entry);
                } else if self.reported < LOG_ENTRIES {
                    outside.push(entry);
                }
                if self.reported < LOG_ENTRIES {
                    self.reported += 1;
                    self.out.push(RunEvent::UnsolicitedEvent(*entry));
                } else {
                    self.not_reported += 1;
                }
                if let Some(event) = known.filter(|event| event.about_train()) {
                    let part = || event.suspect(entry.parameter);
                    self.train_part = self.train_part.take().or_else(part);
                }
            }
        }
        for entry in outside {
            self.outside_event(entry, now);
        }
    }

    fn outside_event(&mut self, entry: &UnitEvent, now: Instant) {
        let finding = Finding::Unprovoked(entry.into());
        self.outside(Outside::UnprovokedEvent, Verdict::Failed, finding, now);
    }

    /// Looks at what no event tells: an emergency brake, and the unit's clock.
    pub(super) fn watch_unit(&mut self, now: Instant, sample: &Sample) {
        self.watch_brake(now, sample);
        self.watch_clock(now);
    }

    fn watch_brake(&mut self, now: Instant, sample: &Sample) {
        let applied = sample.get(Signal::Eb).map(|value| value != 0.0);
        let before = self.brake_applied;
        self.brake_applied = applied.or(before);
        if (before, applied) != (Some(false), Some(true)) {
            return;
        }
        let pause = self.after_pause(now);
        if let Phase::Steps {
            live: Some(live),
            next,
        } = &mut self.phase
        {
            let step = &self.procedure.steps[self.schedule[*next].index];
            if asks_for_brake(step) {
                return;
            }
            if let Some(by) = pause {
                self.stood_still = Some(by);
                return;
            }
            if self.evidence.line.lost_or_damaged_lately > 0 {
                live.hold_against_line(None);
                return;
            }
            self.verdict = self.verdict.and(Verdict::Failed);
            live.fail_by_brake();
            self.out.push(RunEvent::UnsolicitedBrake { at: now });
        }
    }

    /// A clock of the unit that is found wrong fails the procedure, once: no step is about the clock, and how soon the
    /// error shows depends on how long the unit has been watched.
    fn watch_clock(&mut self, now: Instant) {
        let Some(by_permille) = self.evidence.clock_wrong_by_permille else {
            return;
        };
        if self.clock_reported || !matches!(self.phase, Phase::Steps { .. }) {
            return;
        }
        self.clock_reported = true;
        let finding = Finding::ClockWrong { by_permille };
        self.outside(Outside::Whole, Verdict::Failed, finding, now);
        self.out.push(RunEvent::UnitClockWrong {
            by_permille,
            at: now,
        });
    }
}

/// Whether a step looks at the emergency brake or provokes an event that applies it.
fn asks_for_brake(step: &Step) -> bool {
    let mut looks = false;
    step.for_each_signal(&mut |signal| {
        looks |= matches!(signal, Signal::Eb | Signal::EbLoop | Signal::EbCause);
    });
    looks || step.provoked().any(|event| BRAKING_EVENTS.contains(&event))
}
