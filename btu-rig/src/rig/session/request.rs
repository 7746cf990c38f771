//! What is asked of the unit, and one request that is under way.

use protocol::Instant;
use protocol::message::Message;

/// Times a request is sent before it is given up.
const MAX_ATTEMPTS: usize = 3;

/// Something asked of the unit.
#[derive(Clone, Copy, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "one request is under way at a time"
)]
pub enum Request {
    Arm {
        /// `true` = a refusal is a failure, `false` = it is an outcome.
        refusal_fails: bool,
    },
    /// The end of the session.
    Disarm,
    /// A message that is answered by `StimulusAnswer`.
    Stimulus {
        message: Message,
        what: &'static str,
        /// Doing it twice is the same as doing it once.
        repeatable: bool,
    },
}

#[derive(Debug)]
pub struct Current {
    pub request: Request,
    pub begun: Instant,
    /// When the request is sent again or given up.
    pub due: Instant,
    pub attempts: usize,
    /// Sequence numbers of all tries: a late answer to an earlier try is an answer.
    pub seqs: [u16; MAX_ATTEMPTS],
    /// Challenge to be answered.
    pub challenge: Option<u32>,
    /// A self-test that the unit accepted: its results are awaited.
    pub tests_itself: bool,
}

impl Current {
    pub fn new(request: Request, now: Instant) -> Self {
        Self {
            request,
            begun: now,
            due: now,
            attempts: 0,
            seqs: [0; MAX_ATTEMPTS],
            challenge: None,
            tests_itself: false,
        }
    }

    /// A stimulus that was sent with this sequence number.
    pub fn asked(&self, seq: u16) -> bool {
        matches!(self.request, Request::Stimulus { .. })
            && self.seqs[..self.attempts].contains(&seq)
    }

    pub fn is_self_test(&self) -> bool {
        matches!(
            self.request,
            Request::Stimulus {
                message: Message::RunSelfTest(_),
                ..
            }
        )
    }

    /// Sentence that says why the request is given up.
    pub fn gives_up(&self, now: Instant) -> String {
        let (what, ms) = (self.what(), now.since(self.begun).as_ms());
        if self.tests_itself {
            return format!("the unit did not end its self-test within {ms} ms");
        }
        let older = if self.is_self_test() {
            ": units of older versions do not know it"
        } else {
            ""
        };
        format!("the unit did not answer {what} within {ms} ms{older}")
    }

    pub fn most_attempts(&self) -> usize {
        match self.request {
            Request::Stimulus {
                repeatable: false, ..
            } => 1,
            _ => MAX_ATTEMPTS,
        }
    }

    pub fn what(&self) -> &'static str {
        match self.request {
            Request::Arm { .. } => "the arm request",
            Request::Disarm => "the disarm request",
            Request::Stimulus { what, .. } => what,
        }
    }
}
