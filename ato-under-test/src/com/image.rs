//! Input image: the last I/O frame, and whether I/O frames still arrive.

use protocol::message::{Crosstalk, IoInput};
use protocol::{Duration, Instant};

use crate::receivers::Sampled;
use crate::timer::at_rate;

/// Time without a `Crosstalk` frame after which the second code counts as gone: two of these frames, which come every
/// 50 ms, are lost.
const CROSSTALK_LASTS: Duration = Duration::from_ms(150);

/// Latched I/O inputs.
#[derive(Debug, Default)]
pub struct IoImage {
    latest: Option<IoInput>,
    stamp_ms: u32,
    sampled_at: Instant,
    heard: Option<Instant>,
    pub alive: bool,
    timeout: Duration,
    /// Rate of the unit's clock; an injected fault makes it other than 1.
    pub clock_rate: f64,
    crosstalk: Option<(Crosstalk, Instant)>,
    pub sampled: Option<Sampled>,
}

impl IoImage {
    /// An image that dies after `timeout` without a frame.
    pub fn new(timeout: Duration) -> Self {
        Self {
            timeout,
            clock_rate: 1.0,
            ..Self::default()
        }
    }

    /// Takes a frame sampled at the sender's `stamp_ms`, and what the receivers made of the waveforms that came with it.
    pub fn latch(&mut self, now: Instant, stamp_ms: u32, input: IoInput, sampled: Option<Sampled>) {
        let input = sampled.map_or(input, |sampled| sampled.input);
        self.sampled = sampled;
        // The sender's clock is unwrapped here, so that pulse times do not feel the wire's jitter.
        let elapsed = if self.alive {
            stamp_ms.wrapping_sub(self.stamp_ms)
        } else {
            0
        };
        self.sampled_at += at_rate(Duration::from_ms(u64::from(elapsed)), self.clock_rate);
        self.stamp_ms = stamp_ms;
        self.latest = Some(input);
        self.heard = Some(now);
        self.alive = true;
    }

    /// Takes the second code in the ATP antenna.
    pub fn latch_crosstalk(&mut self, now: Instant, signal: Crosstalk) {
        self.crosstalk = Some((signal, now));
    }

    /// The second code in the ATP antenna, while it is there.
    pub fn crosstalk(&self) -> Option<&Crosstalk> {
        self.crosstalk.as_ref().map(|(signal, _)| signal)
    }

    /// Moves on to the present; a silent harness dies, and with it all its inputs.
    pub fn step(&mut self, now: Instant) {
        self.alive = self
            .heard
            .is_some_and(|heard| now.since(heard) < self.timeout);
        if !self.alive {
            self.latest = None;
            self.sampled_at = now;
        }
        self.crosstalk = self
            .crosstalk
            .filter(|(_, heard)| self.alive && now.since(*heard) < CROSSTALK_LASTS);
    }

    /// The last frame and its sampling time, while the harness is alive.
    pub fn input(&self) -> Option<(&IoInput, Instant)> {
        self.latest.as_ref().map(|input| (input, self.sampled_at))
    }

    /// Frames have come at least once since power-up.
    pub fn ever_heard(&self) -> bool {
        self.heard.is_some()
    }
}
