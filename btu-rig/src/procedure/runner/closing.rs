//! The end of every run: clean-up, then safe outputs.

use std::sync::Arc;

use protocol::signal::Sample;
use protocol::{Duration, Instant};

use super::{Phase, Runner, Stop};
use crate::procedure::action_run::Progress;
use crate::procedure::evidence::LogState;
use crate::procedure::finding::Finding;
use crate::procedure::report::{Outside, RunEvent};
use crate::procedure::scan::Scan;
use crate::procedure::worst_case::{TIME_LIMIT_MARGIN, total_worst_case};
use crate::procedure::{Driver, Verdict};

/// Time outputs have to become safe: a wheel at top speed comes to rest first, because one that
/// stops at once would be an impossible wheel.
pub const SAFE_WITHIN: Duration = Duration::from_ms(25_000);
/// Time allowed for reading the rest of the unit's log: four times what a whole log takes.
const LOG_WITHIN: Duration = Duration::from_ms(25_000);
/// Time clean-up has when the link to the unit is lost.
pub const CLEANUP_WITHOUT_LINK: Duration = Duration::from_ms(2000);

impl Runner {
    /// An action of clean-up that does not succeed is reported and the next one tried.
    pub(super) fn run_clean_up(&mut self, now: Instant, sample: &Sample, driver: &mut dyn Driver) {
        let procedure = Arc::clone(&self.procedure);
        let mut operator = self.operator();
        let Phase::CleanUp { actions, since } = &mut self.phase else {
            return;
        };
        let mut allowed = total_worst_case(&procedure.cleanup) + TIME_LIMIT_MARGIN;
        if self.link_lost {
            allowed = allowed.min(CLEANUP_WITHOUT_LINK);
        }
        let scan = Scan::new(now, sample, &self.captured, &self.evidence);
        let mut problems = Vec::new();
        let mut over = loop {
            match actions.advance(
                &procedure.cleanup,
                scan,
                &mut operator,
                driver,
                &mut self.out,
            ) {
                Progress::Waiting => break false,
                Progress::Done => break true,
                Progress::Stuck(problem) => {
                    let what = Box::new(problem.finding().clone());
                    problems.push(Finding::InCleanUp(what));
                    actions.skip();
                }
            }
        };
        if !over && now.since(*since) >= allowed {
            problems.push(Finding::CleanUpTooLong { within: allowed });
            over = true;
        }
        // Before a repetition the unit may have braked because it was not driven: the next set-up shows what is wrong.
        if self.resume.is_some() {
            problems.clear();
        }
        for finding in problems {
            self.outside(Outside::CleanUp, Verdict::Error, finding, now);
        }
        if over {
            self.phase = Phase::MakeSafe { since: now };
        }
    }

    pub(super) fn make_safe(&mut self, now: Instant, since: Instant, driver: &mut dyn Driver) {
        driver.make_safe(now);
        if !driver.safe() {
            if now.since(since) < SAFE_WITHIN {
                return;
            }
            let within = SAFE_WITHIN;
            let finding = Finding::NotSafe { within };
            self.outside(Outside::SafeOutputs, Verdict::Error, finding, now);
        }
        self.phase = Phase::ReadLog { since: now };
    }

    /// A procedure is over when all that the unit has logged meanwhile is read; the bench does not wait for the log
    /// after a stop, or when the link is lost.
    pub(super) fn read_log(&mut self, now: Instant, since: Instant) {
        let awaited = self.stop == Stop::No && !self.link_lost;
        if awaited && self.evidence.log != LogState::Read {
            if now.since(since) < LOG_WITHIN {
                return;
            }
            let within = LOG_WITHIN;
            let finding = Finding::LogNotReadToEnd { within };
            self.outside(Outside::UnitLog, Verdict::Error, finding, now);
        }
        self.phase = Phase::Done;
        self.conclude(now);
        self.out.push(RunEvent::ProcedureFinished {
            verdict: self.overall(),
            findings: self.findings.clone(),
            at: now,
        });
    }
}
