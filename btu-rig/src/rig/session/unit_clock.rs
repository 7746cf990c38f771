//! Sends the unit the time once, so that what it logs in this power-up can be dated later.

use protocol::link::Link;
use protocol::message::{SetClock, StimulusAnswer};
use protocol::{Duration, Instant};

/// Time in which the unit answers.
const ANSWER_TIME: Duration = Duration::from_ms(1_000);
/// Times that the time is sent without an answer: an older unit does not answer.
const TRIES: usize = 2;

/// A time of day at a time of the bench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeOfDay {
    /// Time of the bench.
    pub at: Instant,
    /// Time since 1970 then, UTC, µs.
    pub utc_us: i64,
    /// Greatest error of the time, ms; the way to the unit included.
    pub uncertainty_ms: u16,
}

#[derive(Debug, Default)]
pub struct UnitClock {
    time: Option<TimeOfDay>,
    told: Vec<u16>,
    told_at: Instant,
    settled: bool,
}

impl UnitClock {
    pub fn tell(&mut self, time: TimeOfDay) {
        *self = Self {
            time: Some(time),
            ..Self::default()
        };
    }

    /// Bench and unit both stood still for `pause`: the time of day went on, and is sent again.
    pub fn put_off(&mut self, pause: Duration) {
        if let Some(time) = self.time {
            self.tell(TimeOfDay {
                utc_us: time.utc_us.saturating_add(pause.as_us() as i64),
                ..time
            });
        }
    }

    /// The unit was started again and has lost the time: it is sent again.
    pub fn restart(&mut self) {
        self.told.clear();
        self.settled = false;
    }

    pub fn step(&mut self, now: Instant, link: &mut Link, out: &mut Vec<u8>) {
        let Some(time) = self.time.filter(|_| !self.settled) else {
            return;
        };
        if !self.told.is_empty() && now.since(self.told_at) < ANSWER_TIME {
            return;
        }
        if self.told.len() >= TRIES {
            self.settled = true;
            return;
        }
        let passed_us = now.since(time.at).as_us() as i64;
        let utc_ms = time.utc_us.saturating_add(passed_us) / 1000;
        let message = SetClock {
            utc_ms: u64::try_from(utc_ms).unwrap_or(0),
            uncertainty_ms: time.uncertainty_ms,
        };
        self.told.push(link.send(now, &message.into(), out));
        self.told_at = now;
    }

    pub fn on_answer(&mut self, answer: &StimulusAnswer) {
        self.settled |= self.told.contains(&answer.request_seq);
    }

    pub fn settled(&self) -> bool {
        self.settled || self.time.is_none()
    }
}
