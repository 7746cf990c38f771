//! The tester's subscription to `TrainState`, and the time at which the unit was in the state that the latest one
//! shows.
//!
//! A unit that does not know the request refuses it and goes on with `Status` alone: it is asked a few times and
//! then no more, because it counts each refused frame.

use protocol::link::{Counters, Link};
use protocol::message::{Channel, Subscribe, TrainState};
use protocol::{Duration, Instant, SCAN};

use crate::procedure::{UnitTime, UnitTimeBounds};

/// Period in which the request is repeated: the unit forgets it after 1 s.
const AGAIN: Duration = Duration::from_ms(400);
/// Times a unit is asked that does not answer.
const ATTEMPTS: u32 = 4;

/// State of the request and of the frames that answer it.
#[derive(Debug, Default)]
pub struct Subscription {
    /// The unit is to tell each change in its scan, because nothing else shows the change.
    changes: bool,
    due: Instant,
    asked: u32,
    heard: bool,
    /// Frames of the maintenance channel that had been lost when the last state came.
    gaps: u64,
    times: Option<UnitTime>,
    /// Stamp of the last `Status`, and of the one before.
    cycles: [Option<u32>; 2],
    /// Stamp of the last answer to a request.
    answered: Option<u32>,
}

impl Subscription {
    /// Asks when it is due, once `Status` has come.
    pub fn step(&mut self, now: Instant, changes: bool, link: &mut Link, out: &mut Vec<u8>) {
        let status_comes = self.cycles[0].is_some();
        if !status_comes || now < self.due || self.refused() {
            return;
        }
        self.changes = changes;
        self.due = now + AGAIN;
        self.asked += 1;
        let changes = u8::from(changes);
        link.send(now, &Subscribe { changes }.into(), out);
    }

    /// The unit was asked and does not know the request.
    pub fn refused(&self) -> bool {
        !self.heard && self.asked >= ATTEMPTS
    }

    /// Whether it is known that the unit answers the subscription or does not.
    pub fn settled(&self) -> bool {
        self.heard || self.refused()
    }

    /// Starts over: another unit, or the same after a restart, may answer the subscription or not.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Takes the stamp of a `Status`.
    pub fn on_status(&mut self, stamp_ms: u32) {
        self.cycles = [Some(stamp_ms), self.cycles[0]];
    }

    /// Takes the stamp of an answer to a request.
    pub fn on_answer(&mut self, stamp_ms: u32) {
        self.answered = Some(stamp_ms);
        if let Some(times) = &mut self.times {
            times.answered_ms = self.answered;
        }
    }

    /// Takes the stamp of a state.
    pub fn on_state(&mut self, stamp_ms: u32, state: &TrainState, counters: &Counters) {
        let gaps = counters.gaps(Channel::Ptu);
        let before = self.times.map_or(stamp_ms, |times| times.stamp_ms);
        // A lost frame may have shown first what seems new here.
        let whole = self.heard && gaps == self.gaps && state.held == 0;
        self.gaps = gaps;
        self.heard = true;
        self.times = Some(UnitTime {
            stamp_ms,
            answered_ms: self.answered,
            after: UnitTimeBounds {
                scan_ms: match whole {
                    true => stamp_ms.wrapping_sub(SCAN.as_ms() as u32),
                    false => before,
                },
                frame_ms: before,
                cycle_ms: match self.cycles {
                    [Some(newest), Some(older)] if newest == stamp_ms => older,
                    [Some(newest), _] => newest,
                    _ => before,
                },
            },
        });
    }

    /// The unit's clock, where only the unit's own stamps date what is seen.
    pub fn unit_time(&self) -> Option<UnitTime> {
        self.times.filter(|_| self.changes)
    }
}
