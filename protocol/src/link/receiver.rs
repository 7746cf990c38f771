//! Checks of sequence number and time stamp on one channel, against the last accepted frame.

use crate::frame::{Header, Reject};
use crate::{Duration, Instant};

/// Greatest distance of the next sequence number ahead of the last accepted one.
pub const MAX_AHEAD: u16 = 1000;
/// Time by which a frame may take longer than the fastest one so far.
pub const MAX_DELAY: Duration = Duration::from_ms(500);
/// A sender's clock that has fallen behind by this much since its last accepted frame stood still: the sender was
/// started again, and the frames refused since then are of the new start.
pub const STOOD: Duration = Duration::from_ms(100);
/// Silence after which a channel accepts any sequence number, as after a restart of its sender.
pub const RESYNC: Duration = Duration::from_ms(1000);
/// The shortest transit is taken to be one millisecond longer each time this has passed: 200 ppm, so that
/// two clocks that drift apart by 100 ppm never make a frame look late.
pub const RELAX: Duration = Duration::from_ms(5000);

/// State of the sender on one channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Receiver {
    pub(super) heard_at: Instant,
    seq: u16,
    stamp_ms: u32,
    /// Smallest difference between this clock and the sender's so far, ms, wrapping: the shortest transit.
    quickest_ms: u32,
    /// Time up to which `quickest_ms` is relaxed.
    relaxed_at: Instant,
    /// When the first frame since the last accepted one came too late.
    late_since: Option<Instant>,
    /// Frames rejected for sequence or stamp since the last accepted one.
    pub(super) out_of_place: u32,
}

/// Changes by an accepted frame: the new state, the sequence numbers it skipped, and the frames rejected
/// since the last accepted one.
pub(super) struct Acceptance {
    pub(super) receiver: Receiver,
    pub(super) gap: u16,
    pub(super) out_of_place: u32,
}

impl Receiver {
    /// Judges sequence number and time stamp of a frame.
    pub(super) fn judge(
        slot: &mut Option<Self>,
        now: Instant,
        header: &Header,
    ) -> Result<Acceptance, Reject> {
        let fresh = Acceptance {
            receiver: Self::first(now, header),
            gap: 0,
            out_of_place: 0,
        };
        let Some(last) = slot else { return Ok(fresh) };
        let silent = now.since(last.heard_at) >= RESYNC;
        let ahead = header.seq.wrapping_sub(last.seq);
        if !(1..=MAX_AHEAD).contains(&ahead) {
            return if silent {
                Ok(fresh)
            } else {
                Err(Reject::Sequence)
            };
        }
        if (header.stamp_ms.wrapping_sub(last.stamp_ms) as i32) < 0 {
            return if silent {
                Ok(fresh)
            } else {
                Err(Reject::Stamp)
            };
        }
        let transit_ms = now.stamp_ms().wrapping_sub(header.stamp_ms);
        let steps = now.since(last.relaxed_at).as_us() / RELAX.as_us();
        let quickest_ms = last.quickest_ms.wrapping_add(steps as u32);
        let delay_ms = transit_ms.wrapping_sub(quickest_ms) as i32;
        if delay_ms > MAX_DELAY.as_ms() as i32 {
            // After a blockage old frames arrive in one burst, followed by new ones: they stay rejected. A
            // sender whose clock had stopped stays late for good: it is accepted as a new start.
            let since = *last.late_since.get_or_insert(now);
            let restarted = silent && now.since(since) >= RESYNC;
            return if restarted {
                Ok(fresh)
            } else {
                Err(Reject::Stamp)
            };
        }
        let receiver = Self {
            heard_at: now,
            seq: header.seq,
            stamp_ms: header.stamp_ms,
            quickest_ms: if delay_ms < 0 {
                transit_ms
            } else {
                quickest_ms
            },
            relaxed_at: last.relaxed_at + Duration::from_us(steps * RELAX.as_us()),
            late_since: None,
            out_of_place: 0,
        };
        Ok(Acceptance {
            receiver,
            gap: ahead - 1,
            out_of_place: if delay_ms >= STOOD.as_ms() as i32 {
                0
            } else {
                last.out_of_place
            },
        })
    }

    fn first(now: Instant, header: &Header) -> Self {
        Self {
            heard_at: now,
            seq: header.seq,
            stamp_ms: header.stamp_ms,
            quickest_ms: now.stamp_ms().wrapping_sub(header.stamp_ms),
            relaxed_at: now,
            late_since: None,
            out_of_place: 0,
        }
    }
}
