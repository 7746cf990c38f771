//! One expectation while its step runs.

use protocol::Instant;
use protocol::event::Event;

use super::action_run::{Problem, Scan};
use super::condition::{Answer, MissingData};
use super::describe::{bits_seen, logged_text};
use super::evidence::LogState;
use super::plan::Expectation;
use super::{Driver, EventSource};

/// What is known about an expectation so far.
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
                        self.fail(truth, || {
                            let seen = bits_seen(condition, scan.sample);
                            format!("{condition} did not come within {within}{seen}")
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
                    truth => self.fail(truth, || format!("{condition} held only for {waited}")),
                }
            }
            Expectation::Never { condition } => match condition.truth(scan.sample, scan.captured) {
                truth @ Answer::Yes => self.fail(truth, || format!("{condition} came true")),
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
                    // It may be among those that are not read yet.
                    && log == LogState::Read
                {
                    let who = EventSource::of(*event).who();
                    let entry = logged_text(*event, [*low, *high]);
                    self.fail(Answer::No, || {
                        format!("{who} did not log {entry} within {within}")
                    });
                }
            }
            Expectation::NeverLogs { event } => {
                let who = EventSource::of(*event).who();
                let name = event.definition().name;
                if logged.iter().any(|(of, _)| of == event) {
                    self.fail(Answer::Yes, || format!("{who} logged {name}"));
                }
            }
        }
    }

    /// Adds what is behind the signals that did not come.
    pub(super) fn explain(&mut self, expectation: &Expectation, driver: &dyn Driver) {
        let Expectation::Becomes { condition, .. } = expectation else {
            return;
        };
        if let Some(Problem::Failed(text)) = &mut self.problem
            && let Some(said) = condition.said(driver)
            && !text.ends_with(said)
        {
            text.push_str(": ");
            text.push_str(said);
        }
    }

    /// Whether the step must go on for it.
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
            (None, Some(missing_data), Expectation::Never { condition }) => Some(Problem::NoData(
                format!("{missing_data}, so never {condition} cannot be told"),
            )),
            _ => None,
        }
    }

    fn fail(&mut self, truth: Answer, text: impl FnOnce() -> String) {
        self.decided = true;
        self.problem = Some(match truth {
            Answer::NoData(missing_data) => Problem::NoData(format!("{}: {missing_data}", text())),
            Answer::Yes | Answer::No => Problem::Failed(text()),
        });
    }
}
