//! Pause and single step: between steps the outputs stay as they are, and the next step waits.

use protocol::Instant;

use super::{Phase, Runner};
use crate::procedure::report::RunEvent;

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pause {
    on: bool,
    /// Number of steps that may begin in spite of the pause.
    single: u32,
    /// The pause before the next step has been reported.
    said: bool,
}

impl Runner {
    /// No further step begins until [`resume`](Self::resume); the present one goes on to its end.
    /// Stop, clean-up and safe outputs do not wait.
    pub fn pause(&mut self) {
        self.pause.on = true;
    }

    /// Steps begin again.
    pub fn resume(&mut self) {
        self.pause = Pause::default();
    }

    /// One more step may begin while paused.
    pub fn single_step(&mut self) {
        self.pause.single = self.pause.single.saturating_add(1);
    }

    /// Nothing goes on until the operator answers a prompt or lets the next step begin.
    pub fn awaits_operator(&self) -> bool {
        let procedure = &self.procedure;
        match &self.phase {
            Phase::Setup(actions) => actions.asks(&procedure.setup),
            Phase::Steps { next, live } => match live {
                Some(run) => {
                    let step = self.schedule.get(*next);
                    let step = step.and_then(|turn| procedure.steps.get(turn.index));
                    step.is_some_and(|step| run.asks(step))
                }
                None => self.pause.on && self.pause.said,
            },
            Phase::CleanUp { actions, .. } => actions.asks(&procedure.cleanup),
            Phase::NotStarted | Phase::MakeSafe { .. } | Phase::ReadLog { .. } | Phase::Done => {
                false
            }
        }
    }

    /// Whether the next step, called `name`, must wait; says so once.
    pub(super) fn holds_back(&mut self, name: &str, now: Instant) -> bool {
        if !self.pause.on {
            return false;
        }
        if self.pause.single > 0 {
            self.pause.single -= 1;
            self.pause.said = false;
            return false;
        }
        if !self.pause.said {
            self.pause.said = true;
            self.out.push(RunEvent::Paused {
                next: name.to_owned(),
                at: now,
            });
        }
        true
    }
}
