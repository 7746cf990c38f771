//! The RS-485 link to TCMS: alive while frames come and their alive counter moves.

use protocol::message::{TcmsToAtc, TcmsToAtcBits};
use protocol::{Duration, Instant};

/// What TCMS last said.
#[derive(Debug)]
pub struct TcmsLink {
    last: TcmsToAtc,
    counter_moved: Option<Instant>,
    alive: bool,
    reported: Option<bool>,
    timeout: Duration,
}

impl TcmsLink {
    /// A link that is lost after `timeout` without a moving alive counter.
    pub fn new(timeout: Duration) -> Self {
        Self {
            last: TcmsToAtc::default(),
            counter_moved: None,
            alive: false,
            reported: None,
            timeout,
        }
    }

    /// Takes a frame.
    pub fn take(&mut self, now: Instant, frame: TcmsToAtc) {
        if self.counter_moved.is_none() || frame.alive != self.last.alive {
            self.counter_moved = Some(now);
        }
        self.last = frame;
    }

    /// Moves on to the present.
    pub fn step(&mut self, now: Instant) {
        self.alive = self
            .counter_moved
            .is_some_and(|at| now.since(at) < self.timeout);
    }

    /// The link is up.
    pub fn alive(&self) -> bool {
        self.alive
    }

    /// `Some(alive)` once after each change, the first coming up left out.
    pub fn takes_change(&mut self) -> Option<bool> {
        let before = self.reported;
        if before == Some(self.alive) || (before.is_none() && !self.alive) {
            return None;
        }
        self.reported = Some(self.alive);
        before.map(|_| self.alive)
    }

    /// Passenger load last reported, kg.
    pub fn load_kg(&self) -> f64 {
        f64::from(self.last.load_100kg) * 100.0
    }

    /// TCMS permits automatic operation.
    pub fn ready(&self) -> bool {
        self.alive
            && self.last.bits.contains(TcmsToAtcBits::ATO_ENABLE)
            && !self.last.bits.contains(TcmsToAtcBits::BRAKE_NOT_RELEASED)
    }
}
