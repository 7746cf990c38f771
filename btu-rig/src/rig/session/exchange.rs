//! Requests of the tester that the unit must answer: arming, disarming, test signals.
//!
//! One request is under way at a time, and one begins in a cycle at most: the wire has a budget. A request is repeated
//! when no answer comes, and then given up with a text that names it; requests waiting behind it are dropped then,
//! because they may depend on it.

use std::collections::VecDeque;

use protocol::link::Link;
use protocol::message::{
    Answer, ArmChallenge, ArmConfirm, ArmRefusal, ArmRequest, ArmState, Disarm, SelfTestEnd,
    SelfTestItem, StimulusAnswer,
};
use protocol::{CYCLE, Duration, Instant};

use super::request::{Current, Request};
use crate::procedure::Refusal;

/// Requests that may wait.
const MAX_QUEUE: usize = 32;
/// Time the unit has to answer; a unit at 115 200 baud answers within two cycles.
const ANSWER_TIME: Duration = Duration::from_ms(300);
/// Pause before arming is tried again while the unit starts up or another session lapses.
const ARM_PAUSE: Duration = Duration::from_ms(200);
/// Time for which arming is tried: shorter than a procedure waits, so that the unit's reason is
/// reported.
const ARM_PATIENCE: Duration = Duration::from_ms(4000);

/// Time a self-test may take once it is accepted.
const SELF_TEST_TIME: Duration = Duration::from_ms(3000);

/// Requests and their outcome.
#[derive(Debug, Default)]
pub struct Exchange {
    session: u32,
    queue: VecDeque<Request>,
    current: Option<Current>,
    /// Earliest time of the next request.
    may_send: Instant,
    armed_at: Option<Instant>,
    /// Why the unit refused or ended arming, as it said last.
    pub refusal: ArmRefusal,
    pub failure: Option<Refusal>,
    /// Why the unit ended the session without being asked to.
    pub ended: Option<ArmRefusal>,
    /// Results of the last self-test asked for, as far as they came.
    pub self_test: Vec<SelfTestItem>,
    /// Failures are not reported: the bench is being made safe.
    quiet: bool,
}

impl Exchange {
    /// An exchange without requests, not armed; `session` must not be 0.
    pub fn new(session: u32) -> Self {
        Self {
            session,
            ..Self::default()
        }
    }

    /// Puts a request at the end.
    ///
    /// # Errors
    /// When too many wait.
    pub fn push(&mut self, request: Request) -> Result<(), Refusal> {
        if self.queue.len() >= MAX_QUEUE {
            return Err(Refusal(format!(
                "{MAX_QUEUE} requests to the unit wait for an answer already"
            )));
        }
        self.quiet = false;
        if matches!(request, Request::Disarm) && self.idle() && !self.armed() {
            // A unit that is not armed for this session does not answer a disarm request.
            return Ok(());
        }
        self.queue.push_back(request);
        Ok(())
    }

    /// Drops everything under way and asks for `requests` instead, whose failure is not reported.
    pub fn replace(&mut self, requests: impl IntoIterator<Item = Request>) {
        self.queue.clear();
        self.current = None;
        self.failure = None;
        self.queue.extend(requests);
        self.quiet = true;
    }

    pub fn idle(&self) -> bool {
        self.current.is_none() && self.queue.is_empty()
    }

    /// Armed for this session, as far as is known.
    pub fn armed(&self) -> bool {
        self.armed_at.is_some()
    }

    /// Arming is under way or done: there is something to disarm.
    pub fn may_be_armed(&self) -> bool {
        let current = self.current.as_ref().map(|current| &current.request);
        self.armed() || matches!(current, Some(Request::Arm { .. }))
    }

    /// The end of the session is asked for, and nothing that may fail comes before it.
    pub fn disarming(&self) -> bool {
        let current = self.current.as_ref().map(|current| &current.request);
        let next = current.or(self.queue.front());
        matches!(next, Some(Request::Disarm))
    }

    /// Sends what is due.
    pub fn step(&mut self, now: Instant, link: &mut Link, out: &mut Vec<u8>) {
        if self.current.is_none()
            && now >= self.may_send
            && let Some(request) = self.queue.pop_front()
        {
            self.current = Some(Current::new(request, now));
        }
        let session = self.session;
        let Some(current) = &mut self.current else {
            return;
        };
        if let Some(challenge) = current.challenge.take() {
            let answer = !challenge ^ session;
            link.send(now, &ArmConfirm { session, answer }.into(), out);
            current.due = now + ANSWER_TIME;
            return;
        }
        if now < current.due {
            return;
        }
        if current.tests_itself || current.attempts == current.most_attempts() {
            let text = current.gives_up(now);
            self.fail(text);
            return;
        }
        let message = match current.request {
            Request::Arm { .. } => ArmRequest { session }.into(),
            Request::Disarm => Disarm { session }.into(),
            Request::Stimulus { message, .. } => message,
        };
        current.seqs[current.attempts] = link.send(now, &message, out);
        current.attempts += 1;
        current.due = now + ANSWER_TIME;
        self.may_send = now + CYCLE;
    }

    /// Takes the unit's challenge; the next step answers it.
    pub fn on_challenge(&mut self, heard: &ArmChallenge) {
        if let Some(current) = &mut self.current
            && matches!(current.request, Request::Arm { .. })
            && heard.session == self.session
        {
            current.challenge = Some(heard.challenge);
        }
    }

    /// Takes the outcome of arming, or the notice that it lapsed.
    pub fn on_arm_state(&mut self, now: Instant, state: &ArmState) {
        if state.session != self.session {
            return;
        }
        let armed = state.armed == 1;
        let current = self.current.as_ref().map(|current| &current.request);
        let asked = matches!(current, Some(Request::Arm { .. } | Request::Disarm));
        if !armed && self.armed() && !asked && !self.quiet {
            self.ended = Some(state.refusal);
        }
        self.armed_at = armed.then_some(now);
        self.refusal = state.refusal;
        let Some(current) = &mut self.current else {
            return;
        };
        let patient = now.since(current.begun) < ARM_PATIENCE;
        match (current.request, armed) {
            (Request::Arm { .. }, true) | (Request::Disarm, false) => self.current = None,
            (Request::Arm { refusal_fails }, false) => match state.refusal {
                // The unit reports the end of the session before, not of this one.
                ArmRefusal::TesterSilent | ArmRefusal::Disarmed => {}
                ArmRefusal::StartingUp | ArmRefusal::Busy if patient => {
                    current.attempts = 0;
                    current.due = now + ARM_PAUSE;
                }
                refusal if refusal_fails => {
                    self.fail(format!("the unit refused to arm: {}", refusal.label()));
                }
                _ => self.current = None,
            },
            (Request::Stimulus { .. }, false) if current.tests_itself => {
                let reason = state.refusal.label();
                self.fail(format!("the unit disarmed during its self-test: {reason}"));
            }
            _ => {}
        }
    }

    /// Takes the answer to a stimulus.
    pub fn on_answer(&mut self, now: Instant, heard: &StimulusAnswer) {
        let Some(current) = &mut self.current else {
            return;
        };
        if !current.asked(heard.request_seq) {
            return;
        }
        let what = current.what();
        match heard.answer {
            Answer::Accepted if current.is_self_test() => {
                if !current.tests_itself {
                    self.self_test.clear();
                    current.tests_itself = true;
                    current.due = now + SELF_TEST_TIME;
                }
            }
            Answer::Accepted => self.current = None,
            answer => self.fail(format!("unit refused {what}: {}", answer.label())),
        }
    }

    /// Takes the result of an item of the self-test asked for.
    pub fn on_self_test_item(&mut self, heard: &SelfTestItem) {
        if self.awaits_self_test(heard.request_seq) {
            self.self_test.push(*heard);
        }
    }

    /// Takes the end of the self-test asked for.
    pub fn on_self_test_end(&mut self, heard: &SelfTestEnd) {
        if self.awaits_self_test(heard.request_seq) {
            self.current = None;
        }
    }

    /// Whether the self-test that was asked for with this sequence number has not yet given all its results.
    fn awaits_self_test(&self, seq: u16) -> bool {
        let current = self.current.as_ref();
        current.is_some_and(|current| current.tests_itself && current.asked(seq))
    }

    /// Takes the armed bit of the unit's status.
    pub fn on_armed_bit(&mut self, now: Instant, armed: bool) {
        // A status made just before arming may still be on its way.
        if !armed && self.armed_at.is_some_and(|at| now.since(at) >= ANSWER_TIME) {
            self.armed_at = None;
        }
    }

    /// The unit was started again: nothing it agreed to holds.
    pub fn on_restart(&mut self) {
        self.armed_at = None;
        if !self.idle() {
            self.fail("the unit restarted before it answered".to_owned());
        }
    }

    fn fail(&mut self, text: String) {
        let failed = self.current.take();
        if failed.is_some_and(|current| matches!(current.request, Request::Disarm)) {
            // From here on the keep-alive names no session, and arming lapses by itself.
            self.armed_at = None;
        }
        if self.quiet {
            // Making safe goes on with the next request, whatever became of this one.
            return;
        }
        self.queue.clear();
        self.failure.get_or_insert(Refusal(text));
    }
}
