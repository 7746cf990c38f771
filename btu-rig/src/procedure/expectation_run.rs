//! One expectation while its step runs.

use protocol::Instant;
use protocol::event::Event;

use super::Driver;
use super::condition::{Answer, MissingData};
use super::describe::bits_seen;
use super::evidence::LogState;
use super::finding::Finding;
use super::plan::Expectation;
use super::problem::Problem;
use super::scan::Scan;

#[derive(Clone, Debug, Default)]
pub(super) struct ExpectationRun {
    decided: bool,
    missing_data: Option<MissingData>,
    problem: Option<Problem>,
}

impl ExpectationRun {
    /// Looks at one scan. `actions_end` is set as soon as the actions are done and the sample is
    /// newer than the last stimulus.
    pub(super) fn look(
        &mut self,
        expectation: &Expectation,
        scan: Scan<'_>,
        actions_end: Option<Instant>,
        (logged, log): (&[(Event, i32)], LogState),
    ) {
        if self.decided {
            return;
        }
        let since_end = actions_end.map(|end| scan.now.since(end));
        match expectation {
            Expectation::Becomes { condition, within } => {
                let Some(waited) = since_end else { return };
                match condition.truth(scan.sample, scan.captured) {
                    Answer::Yes => self.decided = true,
                    truth if waited >= *within => {
                        self.fail(truth, |missing| Finding::NeverBecame {
                            condition: condition.clone(),
                            within: *within,
                            seen: bits_seen(condition, scan.sample),
                            missing,
                            said: None,
                        });
                    }
                    Answer::No | Answer::NoData(_) => {}
                }
            }
            Expectation::Holds {
                condition,
                duration,
            } => {
                let Some(waited) = since_end else { return };
                match condition.truth(scan.sample, scan.captured) {
                    Answer::Yes => self.decided = waited >= *duration,
                    truth => self.fail(truth, |missing| Finding::HeldOnlyFor {
                        condition: condition.clone(),
                        held: waited,
                        missing,
                    }),
                }
            }
            Expectation::Never { condition } => match condition.truth(scan.sample, scan.captured) {
                truth @ Answer::Yes => {
                    let condition = condition.clone();
                    self.fail(truth, |_| Finding::CameTrue { condition });
                }
                Answer::NoData(missing_data) => self.missing_data = Some(missing_data),
                Answer::No => {}
            },
            Expectation::Logs {
                event,
                parameter: [low, high],
                within,
            } => {
                let said = |(of, parameter): &(Event, i32)| {
                    of == event && (low..=high).contains(&parameter)
                };
                if logged.iter().any(said) {
                    self.decided = true;
                } else if since_end.is_some_and(|waited| waited >= *within)
                    // The event may be among the entries that are not read yet.
                    && log == LogState::Read
                {
                    self.fail(Answer::No, |_| Finding::NotLogged {
                        event: *event,
                        parameter: [*low, *high],
                        within: *within,
                    });
                }
            }
            Expectation::NeverLogs { event } => {
                if logged.iter().any(|(of, _)| of == event) {
                    self.fail(Answer::Yes, |_| Finding::Logged { event: *event });
                }
            }
        }
    }

    /// Adds to a condition that did not come true the reason that one of its signals gives.
    pub(super) fn explain(&mut self, driver: &dyn Driver) {
        if let Some(Problem::Failed(Finding::NeverBecame {
            condition, said, ..
        })) = &mut self.problem
        {
            *said = condition.said(driver).map(str::to_owned);
        }
    }

    /// Whether the step must go on for this expectation.
    pub(super) fn is_open(&self, expectation: &Expectation) -> bool {
        !self.decided
            && !matches!(
                expectation,
                Expectation::Never { .. } | Expectation::NeverLogs { .. }
            )
    }

    /// Ends watching; the problem, if there is one.
    pub(super) fn finish(self, expectation: &Expectation) -> Option<Problem> {
        match (self.problem, self.missing_data, expectation) {
            (Some(problem), _, _) => Some(problem),
            // A condition that was unknown in a single scan may have been true in it.
            (None, Some(missing), Expectation::Never { condition }) => {
                let condition = condition.clone();
                Some(Problem::NoData(Finding::Unknown { condition, missing }))
            }
            _ => None,
        }
    }

    fn fail(&mut self, truth: Answer, found: impl FnOnce(Option<MissingData>) -> Finding) {
        self.decided = true;
        self.problem = Some(match truth {
            Answer::NoData(missing) => Problem::NoData(found(Some(missing))),
            Answer::Yes | Answer::No => Problem::Failed(found(None)),
        });
    }
}
