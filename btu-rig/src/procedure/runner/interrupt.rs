//! What ends a run early: a lost link, a stalled tester, and the operator's stop.

use protocol::Instant;
use protocol::signal::Sample;

use super::{Phase, Runner, Stop};
use crate::procedure::Verdict;
use crate::procedure::action_run::Problem;

impl Runner {
    pub(super) fn lose_link(&mut self, now: Instant, sample: &Sample, error: &str) {
        self.link_lost = true;
        let text = format!("link to the unit: {error}");
        match self.phase {
            Phase::CleanUp { .. } | Phase::MakeSafe { .. } | Phase::ReadLog { .. } => {
                self.fault(text);
            }
            _ => self.break_off(now, sample, text),
        }
    }

    /// Nothing more is judged: the present step ends as an error, the others are skipped.
    pub(super) fn break_off(&mut self, now: Instant, sample: &Sample, text: String) {
        match &mut self.phase {
            Phase::Steps { live, .. } => {
                if let Some(step) = live.as_mut() {
                    step.break_off(Problem::Bench(text.clone()));
                    self.finish_step(now, sample, false);
                }
                self.fault(text.clone());
                self.skip_rest(now, &format!("not run, {text}"));
            }
            Phase::Setup(_) => {
                self.fault(text.clone());
                self.phase = Phase::Steps {
                    next: 0,
                    live: None,
                };
                self.skip_rest(now, &format!("not run, {text}"));
            }
            Phase::NotStarted
            | Phase::CleanUp { .. }
            | Phase::MakeSafe { .. }
            | Phase::ReadLog { .. }
            | Phase::Done => {}
        }
    }

    pub(super) fn obey_stop(&mut self, now: Instant, sample: &Sample) {
        if self.stop == Stop::No {
            return;
        }
        match &self.phase {
            Phase::Setup(_) | Phase::Steps { .. } => {
                if matches!(self.phase, Phase::Steps { live: Some(_), .. }) {
                    self.finish_step(now, sample, true);
                } else if matches!(self.phase, Phase::Setup(_)) {
                    self.phase = Phase::Steps {
                        next: 0,
                        live: None,
                    };
                }
                self.note(Verdict::Aborted, "stopped by the operator".into());
                self.skip_rest(now, "not run, stopped by the operator");
            }
            Phase::CleanUp { .. } if self.stop == Stop::CutShort => {
                self.note(
                    Verdict::Aborted,
                    "clean-up cut short by the operator".into(),
                );
                self.phase = Phase::MakeSafe { since: now };
            }
            _ => {}
        }
    }
}
