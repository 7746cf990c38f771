//! The tester's session: identity, arm exchange, stimuli, event log, run record, stored memory.
//!
//! Stimuli act only while armed. Arming needs the maintenance key, standstill, closed doors and applied brakes, and ends
//! when the tester falls silent or when test mode must end; the TEST board then removes every test signal.

mod reading;

use alloc::vec::Vec;

use protocol::event::Event;
use protocol::message::{
    Answer, ArmChallenge, ArmConfirm, ArmRefusal, ArmRequest, ArmState, Message, StimulusAnswer,
    StoreKind,
};
use protocol::{Duration, Instant, Random};

use crate::flash::{Memory, SetClockError};
use crate::kernel::EventLog;
use crate::test_board::TestBoard;

/// Most stored entries that a tester may ask for in a cycle without log entries and rows.
const STORED_PER_CYCLE: usize = 4;
/// Time in which a challenge must be answered.
const CHALLENGE_TIME: Duration = Duration::from_ms(1000);
/// Time for which a subscription holds.
const SUBSCRIPTION: Duration = Duration::from_ms(1000);
/// Time the train has to prove that its brakes are applied, once the challenge was answered: less than a tester waits
/// for an answer [default].
const BRAKE_TIME: Duration = Duration::from_ms(250);

#[derive(Clone, Copy, Debug, Default)]
pub struct ArmConditions {
    pub started: bool,
    pub key_on: bool,
    /// The train stands by its own tachometers.
    pub standing: bool,
    /// No door is open, by which people might be getting on.
    pub doors_closed: bool,
    /// The train proves that its brakes are applied.
    pub brakes_applied: bool,
}

#[derive(Debug)]
pub struct Maintenance {
    armed: Option<u32>,
    challenge: Option<(u32, u32, Instant)>,
    /// Session whose challenge was answered, and when; it waits for the brakes.
    answered: Option<(u32, Instant)>,
    heard: Option<Instant>,
    /// When `Subscribe` was heard, and whether it asked for changes at once.
    subscribed: Option<(Instant, bool)>,
    session_heard: Instant,
    timeout: Duration,
    random: Random,
    /// Index of the next log entry to send.
    reader: Option<u32>,
    /// Index of the next row of the run record to send.
    run_reader: Option<u32>,
    /// Store to send from, next sequence number, and entries in a cycle.
    stored_reader: Option<(StoreKind, u32, usize)>,
    /// Sequence number of a request for a self-test that has not begun.
    self_test: Option<u16>,
}

impl Maintenance {
    /// A session without a tester; silence of `timeout` ends arming.
    pub fn new(timeout: Duration, seed: u64) -> Self {
        Self {
            armed: None,
            challenge: None,
            answered: None,
            heard: None,
            subscribed: None,
            session_heard: Instant::ZERO,
            timeout,
            random: Random::new(seed),
            reader: None,
            run_reader: None,
            stored_reader: None,
            self_test: None,
        }
    }

    /// Draws challenges from another seed.
    pub fn draw_challenges(&mut self, seed: u64) {
        self.random = Random::new(seed);
    }

    pub fn armed(&self) -> bool {
        self.armed.is_some()
    }

    /// Whether the train's brake is held: the unit is armed, or arming is under way.
    pub fn holds_brake(&self, now: Instant) -> bool {
        let asked = self
            .challenge
            .is_some_and(|(_, _, at)| now.since(at) < CHALLENGE_TIME);
        asked || self.answered.is_some() || self.armed()
    }

    /// The request for a self-test, once.
    pub fn take_self_test(&mut self) -> Option<u16> {
        self.self_test.take()
    }

    /// A tester has been heard lately.
    pub fn listened_to(&self, now: Instant) -> bool {
        self.heard
            .is_some_and(|heard| now.since(heard) < self.timeout)
    }

    /// Whether a tester wants `TrainState`, and if so whether also at once in the scan of a change.
    pub fn subscribed(&self, now: Instant) -> Option<bool> {
        let (at, changes) = self.subscribed?;
        (now.since(at) < SUBSCRIPTION).then_some(changes)
    }

    /// One scan; returns the notice to send when arming succeeds, fails or lapses.
    pub fn step(
        &mut self,
        now: Instant,
        conditions: ArmConditions,
        board: &mut TestBoard,
        log: &mut EventLog,
    ) -> Option<Message> {
        if let Some(outcome) = self.finish_arming(now, conditions, log) {
            return Some(outcome);
        }
        if now.since(self.session_heard) >= self.timeout {
            return self.end(now, ArmRefusal::TesterSilent, board, log);
        }
        None
    }

    /// Ends arming, if there is any; returns the notice to send.
    pub fn end(
        &mut self,
        now: Instant,
        refusal: ArmRefusal,
        board: &mut TestBoard,
        log: &mut EventLog,
    ) -> Option<Message> {
        let session = self.armed.take()?;
        self.self_test = None;
        board.release_all();
        log.push(now, Event::ArmingLapsed, i32::from(refusal.code()));
        Some(arm_state(session, refusal))
    }

    /// Arms the session whose challenge was answered, as soon as the brakes are applied.
    fn finish_arming(
        &mut self,
        now: Instant,
        conditions: ArmConditions,
        log: &mut EventLog,
    ) -> Option<Message> {
        let (session, at) = self.answered?;
        let refusal = if !conditions.key_on {
            ArmRefusal::KeyOff
        } else if !conditions.standing {
            ArmRefusal::Moving
        } else if self.armed.is_none() && !conditions.doors_closed {
            ArmRefusal::DoorsOpen
        } else if conditions.brakes_applied {
            if self.armed.is_none() {
                log.push(now, Event::Armed, 0);
            }
            self.armed = Some(session);
            self.session_heard = now;
            ArmRefusal::None
        } else if now.since(at) >= BRAKE_TIME {
            ArmRefusal::BrakesReleased
        } else {
            return None;
        };
        self.answered = None;
        Some(arm_state(session, refusal))
    }

    /// Handles one request; answers go to `replies`.
    pub fn handle(
        &mut self,
        now: Instant,
        (seq, message): (u16, Message),
        conditions: ArmConditions,
        (board, log, memory): (&mut TestBoard, &mut EventLog, &mut Memory),
        replies: &mut Vec<Message>,
    ) {
        self.heard = Some(now);
        match message {
            Message::ArmRequest(request) => replies.push(self.request(now, request, conditions)),
            Message::ArmConfirm(confirm) => {
                replies.extend(self.confirm(now, confirm, conditions));
            }
            Message::Disarm(request) if self.armed == Some(request.session) => {
                replies.extend(self.end(now, ArmRefusal::Disarmed, board, log));
            }
            Message::Subscribe(request) => self.subscribed = Some((now, request.changes != 0)),
            Message::KeepAlive(alive) => self.on_session(now, alive.session),
            Message::ReadLog(request) => self.reader = Some(request.from_index),
            Message::ReadRun(request) => self.run_reader = Some(request.from_index),
            Message::SetClock(told) => {
                let answer = match memory.set_clock(now, told) {
                    Ok(()) => Answer::Accepted,
                    Err(SetClockError::OutOfRange) => Answer::OutOfRange,
                    Err(SetClockError::Failed) => Answer::BoardFailed,
                };
                replies.push(answer_to(seq, answer));
            }
            Message::ReadStored(request) if request.store.is_known() => {
                let per_cycle = usize::from(request.per_cycle).clamp(1, STORED_PER_CYCLE);
                self.stored_reader = Some((request.store, request.from_sequence, per_cycle));
            }
            other => {
                if let Some(answer) = self.stimulate(now, (seq, other), board, log) {
                    replies.push(answer_to(seq, answer));
                }
            }
        }
    }

    fn on_session(&mut self, now: Instant, session: u32) {
        if self.armed == Some(session) {
            self.session_heard = now;
        }
    }

    fn request(&mut self, now: Instant, request: ArmRequest, conditions: ArmConditions) -> Message {
        let session = request.session;
        let refusal = if !conditions.started {
            ArmRefusal::StartingUp
        } else if !conditions.key_on {
            ArmRefusal::KeyOff
        } else if self.armed.is_some_and(|held| held != session) {
            ArmRefusal::Busy
        } else if !conditions.standing {
            ArmRefusal::Moving
        } else if self.armed.is_none() && !conditions.doors_closed {
            ArmRefusal::DoorsOpen
        } else if session == 0 {
            ArmRefusal::BadAnswer
        } else {
            let challenge = self.random.bits() as u32;
            self.challenge = Some((session, challenge, now));
            return ArmChallenge { session, challenge }.into();
        };
        arm_state(session, refusal)
    }

    /// A wrong or late answer is refused at once, a right one waits for the brakes.
    fn confirm(
        &mut self,
        now: Instant,
        confirm: ArmConfirm,
        conditions: ArmConditions,
    ) -> Option<Message> {
        let session = confirm.session;
        let right = self.challenge.take().is_some_and(|(asked, challenge, at)| {
            asked == session
                && confirm.answer == !challenge ^ session
                && now.since(at) < CHALLENGE_TIME
        });
        if !right || !conditions.key_on {
            return Some(arm_state(session, ArmRefusal::BadAnswer));
        }
        self.answered = Some((session, now));
        None
    }

    /// Carries out a stimulus; `None` for a message that is not one.
    fn stimulate(
        &mut self,
        now: Instant,
        (seq, message): (u16, Message),
        board: &mut TestBoard,
        log: &mut EventLog,
    ) -> Option<Answer> {
        let session = match message {
            Message::TestCode(m) => m.session,
            Message::TestSpeed(m) => m.session,
            Message::TestMarker(m) => m.session,
            Message::TestTwc(m) => m.session,
            Message::TestRelease(m) => m.session,
            Message::RunSelfTest(m) => m.session,
            Message::ClearLog(m) => m.session,
            _ => return None,
        };
        if self.armed != Some(session) {
            return Some(Answer::NotArmed);
        }
        self.session_heard = now;
        Some(match message {
            Message::TestCode(request) => board.set_code(request),
            Message::TestSpeed(request) => board.set_speed(request),
            Message::TestMarker(request) => board.set_marker(request),
            Message::TestTwc(request) => board.set_twc(now, request),
            Message::TestRelease(request) => {
                board.release(request);
                Answer::Accepted
            }
            Message::RunSelfTest(_) => {
                self.self_test = Some(seq);
                Answer::Accepted
            }
            _ => {
                log.clear();
                log.push(now, Event::LogCleared, 0);
                Answer::Accepted
            }
        })
    }
}

/// Outcome of arming; `ArmRefusal::None` = armed.
fn arm_state(session: u32, refusal: ArmRefusal) -> Message {
    ArmState {
        session,
        armed: u8::from(refusal == ArmRefusal::None),
        refusal,
    }
    .into()
}

fn answer_to(request_seq: u16, answer: Answer) -> Message {
    StimulusAnswer {
        request_seq,
        answer,
    }
    .into()
}
