//! Carries out a list of actions, one after the other, without blocking.

use protocol::{Duration, Instant};

use super::Driver;
use super::condition::Answer;
use super::describe::bits_seen;
use super::finding::Finding;
use super::operator::{Operator, PromptPolicy};
use super::plan::Action;
use super::problem::Problem;
use super::report::RunEvent;
use super::scan::Scan;

/// How often a wait is reported.
const WAITING_EVERY: Duration = Duration::from_ms(500);

/// Progress of a list of actions.
#[derive(Debug, PartialEq)]
pub(super) enum Progress {
    /// An action takes its time.
    Waiting,
    Done,
    /// An action did not succeed; the list can be [resumed](ActionRun::skip) after it.
    Stuck(Problem),
}

/// Progress through a list of actions.
#[derive(Debug, Default)]
pub(super) struct ActionRun {
    at: usize,
    /// When the present action began to wait.
    since: Option<Instant>,
    /// When the last stimulus was applied.
    stimulated: Option<Instant>,
    reported: Option<Instant>,
}

impl ActionRun {
    /// Whether the sample of this scan is older than the last stimulus: such a sample proves nothing.
    pub(super) fn sample_is_stale(&self, now: Instant) -> bool {
        self.stimulated == Some(now)
    }

    /// Goes on with the action after a stuck one.
    pub(super) fn skip(&mut self) {
        self.at += 1;
        self.since = None;
        self.reported = None;
    }

    /// Carries out actions until one takes its time or all are done.
    pub(super) fn advance(
        &mut self,
        actions: &[Action],
        scan: Scan<'_>,
        operator: &mut Operator,
        driver: &mut dyn Driver,
        out: &mut Vec<RunEvent>,
    ) -> Progress {
        while let Some(action) = actions.get(self.at) {
            let (action, here) = action.where_done(driver.has_harness());
            if !here {
                self.skip();
                continue;
            }
            let since = *self.since.get_or_insert(scan.now);
            let waited = scan.now.since(since);
            let done = match action {
                Action::Stimulus(stimulus) => {
                    if let Err(refusal) = driver.apply(scan.now, stimulus) {
                        return Progress::Stuck(Problem::Bench(Finding::Refused {
                            why: refusal.0,
                        }));
                    }
                    self.stimulated = Some(scan.now);
                    true
                }
                Action::Wait(span) => waited >= *span,
                _ if self.sample_is_stale(scan.now) => false,
                Action::Until { condition, within } => {
                    let truth = condition.truth(scan.sample, scan.captured);
                    let never = || Finding::NeverBecame {
                        condition: condition.clone(),
                        within: *within,
                        seen: bits_seen(condition, scan.sample),
                        missing: None,
                        said: None,
                    };
                    match truth {
                        Answer::Yes => true,
                        Answer::No if waited >= *within => {
                            return Progress::Stuck(Problem::Failed(never()));
                        }
                        Answer::NoData(_) if waited >= *within => {
                            return Progress::Stuck(Problem::NoData(never()));
                        }
                        Answer::No | Answer::NoData(_) => false,
                    }
                }
                Action::Settle { within } => match driver.settled() {
                    Err(refusal) => {
                        return Progress::Stuck(Problem::Refused(Finding::Refused {
                            why: refusal.0,
                        }));
                    }
                    Ok(false) if waited >= *within => {
                        let within = *within;
                        return Progress::Stuck(Problem::Refused(Finding::NotFinished { within }));
                    }
                    Ok(settled) => settled,
                },
                Action::Prompt { text, within } => {
                    match prompt(text, operator, waited >= *within) {
                        Ok(done) => done,
                        Err(problem) => return Progress::Stuck(problem),
                    }
                }
                // `where_done` has taken this wrapper off, and scripts cannot put one into another.
                Action::OnBench(_) | Action::OnTrain(_) => true,
            };
            if !done {
                self.report(action, scan.now, waited, out);
                return Progress::Waiting;
            }
            self.skip();
        }
        Progress::Done
    }

    /// The present action waits for the operator's answer.
    pub(super) fn asks(&self, actions: &[Action]) -> bool {
        self.since.is_some() && actions.get(self.at).is_some_and(Action::asks)
    }

    /// Reports what is waited for: a prompt at once, another action if it takes longer than a moment.
    fn report(&mut self, action: &Action, now: Instant, waited: Duration, out: &mut Vec<RunEvent>) {
        let left = action.worst_case() - waited;
        if let Action::Prompt { text, .. } = action {
            if self.reported.replace(now).is_none() {
                let text = text.clone();
                out.push(RunEvent::Prompt { text, left });
            }
            return;
        }
        if now.since(*self.reported.get_or_insert(now)) >= WAITING_EVERY {
            self.reported = Some(now);
            let action = action.clone();
            out.push(RunEvent::Waiting { action, left });
        }
    }
}

fn prompt(question: &str, operator: &mut Operator, late: bool) -> Result<bool, Problem> {
    let question = question.to_owned();
    match (operator.policy, operator.answer.take()) {
        (PromptPolicy::Refuse, _) => Err(Problem::Bench(Finding::NeedsOperator { question })),
        (PromptPolicy::Ask, Some(true)) => Ok(true),
        (PromptPolicy::Ask, Some(false)) => Err(Problem::Failed(Finding::SaidNo { question })),
        (PromptPolicy::Ask, None) if late => Err(Problem::Bench(Finding::NoAnswer { question })),
        (PromptPolicy::Ask, None) => Ok(false),
    }
}
