//! Counts frames that each channel loses, on whichever port, and logs when they are too many.

use protocol::event::Event;
use protocol::message::Channel;
use protocol::{Duration, Instant};

use super::Ports;
use crate::kernel::EventLog;

/// Span over which losses are counted.
const SPAN: Duration = Duration::from_ms(10_000);

/// Counts losses and reports a bad channel once a span.
#[derive(Debug, Default)]
pub struct RejectWatch {
    threshold: u64,
    span_began: Instant,
    at_begin: [u64; 4],
    lost: [u64; 4],
    reported: [bool; 4],
}

impl RejectWatch {
    /// Reports a channel that loses `threshold` frames within ten seconds.
    pub fn new(threshold: u32) -> Self {
        Self {
            threshold: u64::from(threshold),
            ..Self::default()
        }
    }

    /// Counts a frame that a modem or line driver lost before it could be rejected, or whose content is impossible.
    pub fn count_lost(&mut self, channel: Channel) {
        self.lost[channel as usize] += 1;
    }

    pub fn step(&mut self, now: Instant, ports: &Ports, log: &mut EventLog) {
        for channel in Channel::ALL {
            let i = channel as usize;
            let total = ports.rejected_on(channel) + self.lost[i];
            if !self.reported[i] && total - self.at_begin[i] >= self.threshold {
                self.reported[i] = true;
                log.push(now, Event::FramesRejected, i32::from(channel.code()));
            }
            if now.since(self.span_began) >= SPAN {
                self.at_begin[i] = total;
                self.reported[i] = false;
            }
        }
        if now.since(self.span_began) >= SPAN {
            self.span_began = now;
        }
    }
}
