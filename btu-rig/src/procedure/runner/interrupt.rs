//! What ends a run early: a lost link, a stalled tester, and the operator's stop.

use protocol::Instant;
use protocol::signal::Sample;

use super::{Phase, Runner, Stop};
use crate::procedure::Verdict;
use crate::procedure::action_run::Problem;
use crate::procedure::report::Outside;

impl Runner {
    pub(super) fn lose_link(&mut self, now: Instant, sample: &Sample, error: &str) {
        self.link_lost = true;
        let text = format!("link to the unit: {error}");
        match self.phase {
            Phase::CleanUp { .. } | Phase::MakeSafe { .. } | Phase::ReadLog { .. } => {
                self.outside(Outside::Bench, Verdict::Error, text, now);
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
                    self.note(Verdict::Error, text.clone());
                } else {
                    self.outside(Outside::Bench, Verdict::Error, text.clone(), now);
                }
                self.skip_rest(now, &format!("not run, {text}"));
            }
            Phase::Setup(_) => {
                self.outside(Outside::Bench, Verdict::Error, text.clone(), now);
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
                let text = "stopped by the operator".to_owned();
                if matches!(self.phase, Phase::Steps { live: Some(_), .. }) {
                    self.finish_step(now, sample, true);
                    self.note(Verdict::Aborted, text);
                } else {
                    if matches!(self.phase, Phase::Setup(_)) {
                        self.phase = Phase::Steps {
                            next: 0,
                            live: None,
                        };
                    }
                    self.outside(Outside::Stop, Verdict::Aborted, text, now);
                }
                self.skip_rest(now, "not run, stopped by the operator");
            }
            Phase::CleanUp { .. } if self.stop == Stop::CutShort => {
                let text = "clean-up cut short by the operator".into();
                self.outside(Outside::CleanUp, Verdict::Aborted, text, now);
                self.phase = Phase::MakeSafe { since: now };
            }
            _ => {}
        }
    }
}
