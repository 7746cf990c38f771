//! TRA health: a test pulse at intervals must be answered.

use protocol::event::Event;
use protocol::{Duration, Instant};

use crate::kernel::EventLog;

/// Tests in a row that must fail before TRA counts as failed.
const FAILURES: u32 = 2;

#[derive(Debug)]
pub struct Tra {
    period: Duration,
    next_test: Instant,
    failures: u32,
}

impl Tra {
    pub fn new(period: Duration) -> Self {
        Self {
            period,
            next_test: Instant::ZERO,
            failures: 0,
        }
    }

    /// One cycle; `answers` is TRA's reply to the test pulse.
    pub fn step(&mut self, now: Instant, answers: bool, log: &mut EventLog) {
        if now < self.next_test {
            return;
        }
        self.next_test = now + self.period;
        let was_ok = self.ok();
        self.failures = if answers {
            0
        } else {
            (self.failures + 1).min(FAILURES)
        };
        if was_ok != self.ok() {
            let event = if was_ok {
                Event::TraFailed
            } else {
                Event::TraRestored
            };
            log.push(now, event, 0);
        }
    }

    pub fn ok(&self) -> bool {
        self.failures < FAILURES
    }
}
