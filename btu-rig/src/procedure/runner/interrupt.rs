//! Early ends of a run: a lost link, a stalled tester, and the operator's stop.

use protocol::Instant;
use protocol::signal::Sample;

use super::{Phase, Runner, Stop};
use crate::procedure::Verdict;
use crate::procedure::finding::Finding;
use crate::procedure::link_trouble::LinkTrouble;
use crate::procedure::problem::Problem;
use crate::procedure::report::Outside;

impl Runner {
    pub(super) fn lose_link(&mut self, now: Instant, sample: &Sample, why: LinkTrouble) {
        self.link_lost = true;
        let finding = Finding::LinkLost { why };
        match self.phase {
            Phase::CleanUp { .. } | Phase::MakeSafe { .. } | Phase::ReadLog { .. } => {
                self.outside(Outside::Bench, Verdict::Error, finding, now);
            }
            _ => self.break_off(now, sample, finding),
        }
    }

    /// Nothing more is judged: the present step ends as an error, the others are skipped.
    pub(super) fn break_off(&mut self, now: Instant, sample: &Sample, why: Finding) {
        match &mut self.phase {
            Phase::Steps { live, .. } => {
                if let Some(step) = live.as_mut() {
                    step.break_off(Problem::Bench(why.clone()));
                    self.finish_step(now, sample, false);
                    self.note(Verdict::Error, why.clone());
                } else {
                    self.outside(Outside::Bench, Verdict::Error, why.clone(), now);
                }
                self.skip_rest(now, &why.not_run());
            }
            Phase::Setup(_) => {
                self.outside(Outside::Bench, Verdict::Error, why.clone(), now);
                self.phase = Phase::steps_from(0);
                self.skip_rest(now, &why.not_run());
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
                    self.note(Verdict::Aborted, Finding::Stopped);
                } else {
                    if matches!(self.phase, Phase::Setup(_)) {
                        self.phase = Phase::steps_from(0);
                    }
                    self.outside(Outside::Stop, Verdict::Aborted, Finding::Stopped, now);
                }
                self.skip_rest(now, &Finding::Stopped.not_run());
            }
            Phase::CleanUp { .. } if self.stop == Stop::CutShort => {
                let finding = Finding::CleanUpCutShort;
                self.outside(Outside::CleanUp, Verdict::Aborted, finding, now);
                self.phase = Phase::MakeSafe { since: now };
            }
            _ => {}
        }
    }
}
