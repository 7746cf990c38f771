//! Counts frames between tester and unit that were lost or damaged on the line, in both directions.
//!
//! Only losses are counted that no part of a unit can cause. From the unit: gaps and frames out of place in the
//! sequences of the PTU and I/O channels, and frames refused on these channels in excess of those refused on TCMS and
//! TWC, whose modems may damage frames. To the unit: frames that the unit says it refused; it counts them at the end of
//! the line, before its own modems. A unit whose clock goes wrong refuses good frames as late: its refusals are then
//! not counted.

use std::collections::VecDeque;

use protocol::frame::Reject;
use protocol::link::{Counters, RESYNC};
use protocol::message::Channel;
use protocol::{CYCLE, Duration, Instant};

use crate::procedure::LineState;
use crate::procedure::link_trouble::LinkTrouble;

use super::clock_rate::ClockRate;
use super::lateness::Lateness;

/// Time over which losses are counted to judge the line; the unit counts over as long.
const SPAN: Duration = Duration::from_ms(10_000);
/// Interval at which counts are kept.
const EVERY: Duration = Duration::from_ms(500);
/// Time for which the unit may still report the effects of lost frames: its time-outs, and reading its log.
const LATELY: Duration = Duration::from_ms(12_000);
/// Time after first contact or a restart for which both ends may still refuse frames from before.
const SETTLES: Duration = Duration::from_ms(2_200);
/// A unit's clock that is off by more than this, and by more than one part in [`CLOCK_SHARE`], goes wrong.
const CLOCK_OFF: Duration = Duration::from_ms(60);
/// A crystal is off by less than 1 part in 10 000; an error beyond 1 part in this number is no delay of a frame,
/// either.
const CLOCK_SHARE: u64 = 100;
/// Channels whose frames no part of the unit damages.
const WHOLE: [Channel; 2] = [Channel::Ptu, Channel::Io];
/// When all channels of [`WHOLE`] are silent for longer, the line is lost or the unit starts again: longer than a link holds
/// bytes back, shorter than the time after which TCMS, the wayside or the unit misses the other.
const SILENT: Duration = Duration::from_ms(150);

/// Counts since the line has settled.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    taken: u64,
    /// Frames lost or damaged on the way from the unit.
    from_unit: u64,
    /// Frames that the unit refused.
    to_unit: u64,
    /// Frames lost in either direction shortly after this bench's computer stood still: no fault of the line, but a
    /// reason for what the unit and TCMS log.
    after_stall: u64,
}

impl Counts {
    /// Frames that count against the line.
    fn lost_or_damaged(self) -> u64 {
        self.from_unit + self.to_unit
    }

    fn of_any_cause(self) -> u64 {
        self.lost_or_damaged() + self.after_stall
    }
}

#[derive(Debug, Default)]
pub struct LineWatch {
    /// Frames lost within [`SPAN`] that make a line bad.
    bad_at: u64,
    settles_until: Option<Instant>,
    /// When this bench's own computer did not keep up last, since the unit was first heard or started again.
    stalled_at: Option<Instant>,
    /// The rig's own counters when the line had settled.
    before: Counters,
    /// Counts of this watch when the line had settled.
    base: Counts,
    counts: Counts,
    /// When the last frame came, and how many had come then.
    heard: (Instant, u64),
    /// Nothing has come for longer than [`SILENT`], or since this bench's own computer did not keep up.
    silent: bool,
    /// Count of rejected frames in the unit's last status.
    rejected_by_unit: Option<u16>,
    /// When the line had settled, and the unit's clock then, ms.
    clock: Option<(Instant, u32)>,
    /// The unit's clock does not go as the bench's does.
    clock_is_wrong: bool,
    pub rate: ClockRate,
    lateness: Lateness,
    /// When the last frame came, and how late that frame was.
    late: (Instant, Duration),
    /// Time until which the unit refuses what is damaged on purpose.
    on_purpose_until: Instant,
    /// Counts of the last seconds, oldest first.
    past: VecDeque<(Instant, Counts)>,
}

impl LineWatch {
    /// A line is bad that loses `bad_at` frames within ten seconds.
    pub fn new(bad_at: u32) -> Self {
        Self {
            bad_at: u64::from(bad_at.max(1)),
            ..Self::default()
        }
    }

    /// The bench damages frames on purpose.
    pub fn note_on_purpose(&mut self, now: Instant) {
        self.on_purpose_until = now + RESYNC + RESYNC;
    }

    /// The unit was started again.
    pub fn note_restart(&mut self, now: Instant) {
        self.settles_until = Some(now + SETTLES);
        self.stalled_at = None;
        self.silent = false;
        self.rejected_by_unit = None;
        self.clock = None;
        self.rate = ClockRate::default();
    }

    /// This bench's own computer did not keep up: its frames left late and the unit's frames waited or were
    /// lost here. Neither is counted against the line.
    pub fn note_stalled(&mut self, now: Instant) {
        if self.settles_until.is_some() {
            self.settles_until = Some(now + SETTLES);
            self.stalled_at = Some(now);
            self.silent = true;
        }
        self.heard.0 = now;
        self.clock = None;
        self.rate = ClockRate::default();
        self.past.push_back((now, self.counts));
    }

    /// Takes the time stamp of a frame that has come, ms. Channels on which a modem of the unit may hold bytes back are
    /// ignored.
    pub fn on_frame(&mut self, at: Instant, channel: Channel, stamp_ms: u32) {
        if WHOLE.contains(&channel) {
            let late = self.lateness.take(at, stamp_ms);
            let before = if self.late.0 == at {
                self.late.1
            } else {
                Duration::ZERO
            };
            self.late = (at, late.max(before));
        }
    }

    /// Takes when a frame of the unit came, and the unit's clock when it was made, ms.
    pub fn on_clock(&mut self, at: Instant, stamp_ms: u32) {
        if !self.settled(at) {
            return;
        }
        self.rate.take(at, stamp_ms);
        let (since, first_ms) = *self.clock.get_or_insert((at, stamp_ms));
        let by_bench = at.since(since).as_us();
        let by_unit = u64::from(stamp_ms.wrapping_sub(first_ms)) * 1_000;
        let off = by_bench.abs_diff(by_unit);
        let wrong = off > CLOCK_OFF.as_us() && off > by_bench / CLOCK_SHARE;
        // In a shorter time a share this small cannot show: what was found before a stall stands.
        if wrong || by_bench >= CLOCK_OFF.as_us() * CLOCK_SHARE {
            self.clock_is_wrong = wrong;
        }
    }

    /// Takes the unit's count of refused frames, which wraps.
    pub fn on_refused(&mut self, now: Instant, refused: u16) {
        let more = self
            .rejected_by_unit
            .replace(refused)
            .map_or(0, |before| refused.wrapping_sub(before));
        // A count that falls shows that the unit was started again.
        let fallen = more > u16::MAX / 2;
        if fallen || self.clock_is_wrong || now < self.on_purpose_until {
            return;
        }
        if self.settled(now) {
            self.counts.to_unit += u64::from(more);
        } else if self.stalled_at.is_some() {
            self.counts.after_stall += u64::from(more);
        }
    }

    /// Takes the counters of the rig's own end of the link; counts once a cycle.
    pub fn step(&mut self, now: Instant, counters: &Counters) {
        if !now.as_us().is_multiple_of(CYCLE.as_us()) {
            return;
        }
        let heard = of_whole(counters, Counters::accepted);
        if self.settles_until.is_none() && heard > 0 {
            self.settles_until = Some(now + SETTLES);
        }
        if heard != self.heard.1 {
            self.heard = (now, heard);
            self.silent = false;
        } else if self.settled(now) || self.stalled_at.is_some() {
            self.silent |= now.since(self.heard.0) > SILENT;
        }
        let settled = self.settled(now);
        if settled || self.stalled_at.is_some() {
            let sum = |count: fn(&Counters) -> u64| count(counters) - count(&self.before);
            let beyond_modems = sum(refused_whole).saturating_sub(sum(refused_of_modems));
            let whole = |count: CountOf| of_whole(counters, count) - of_whole(&self.before, count);
            let from_unit =
                whole(Counters::gaps).max(beyond_modems) + whole(Counters::out_of_place);
            let counts = &mut self.counts;
            if settled {
                // Refusals on the modem channels may come later and lower the sum: what was counted stays counted.
                counts.from_unit = counts.from_unit.max(self.base.from_unit + from_unit);
                counts.taken = self.base.taken + whole(Counters::accepted);
            } else {
                counts.after_stall += from_unit;
            }
        }
        if !settled {
            self.before = *counters;
            self.base = self.counts;
        }
        let due = |(at, _): &(Instant, Counts)| now.since(*at) >= EVERY;
        if self.past.back().is_none_or(due) {
            self.past.push_back((now, self.counts));
        }
        while self
            .past
            .front()
            .is_some_and(|(at, _)| now.since(*at) > LATELY)
        {
            self.past.pop_front();
        }
    }

    fn settled(&self, now: Instant) -> bool {
        self.settles_until.is_some_and(|until| now >= until)
    }

    /// What got lost until now, and in the last seconds.
    pub fn state(&self) -> LineState {
        let before = self
            .past
            .front()
            .map_or(0, |(_, counts)| counts.of_any_cause());
        LineState {
            lost_or_damaged: self.counts.lost_or_damaged(),
            lost_or_damaged_lately: self.counts.of_any_cause().saturating_sub(before),
            silent: self.silent,
            late: self.late.1,
        }
    }

    /// What is wrong with the line, if it is bad.
    pub fn error(&self, now: Instant) -> Option<LinkTrouble> {
        // What the line lost before a stall may have been lost by the stall.
        let within = |(at, _): &&(Instant, Counts)| {
            now.since(*at) <= SPAN && self.stalled_at.is_none_or(|stalled| *at >= stalled)
        };
        let before = self
            .past
            .iter()
            .find(within)
            .map_or(Counts::default(), |(_, counts)| *counts);
        let from_unit = self.counts.from_unit.saturating_sub(before.from_unit);
        let to_unit = self.counts.to_unit.saturating_sub(before.to_unit);
        let came = self.counts.taken.saturating_sub(before.taken) + from_unit;
        (from_unit + to_unit >= self.bad_at).then_some(LinkTrouble::BadLine {
            within: SPAN,
            from_unit,
            came,
            to_unit,
        })
    }
}

type CountOf = fn(&Counters, Channel) -> u64;

/// Sum of a count over the channels that no part of the unit damages.
fn of_whole(counters: &Counters, count: CountOf) -> u64 {
    WHOLE.iter().map(|&channel| count(counters, channel)).sum()
}

/// Frames refused as damaged or wrongly addressed, on a channel that no part of the unit damages or on no known
/// channel.
fn refused_whole(counters: &Counters) -> u64 {
    refused(counters, &[Some(Channel::Ptu), Some(Channel::Io), None])
}

fn refused_of_modems(counters: &Counters) -> u64 {
    refused(counters, &[Some(Channel::Tcms), Some(Channel::Twc)])
}

fn refused(counters: &Counters, channels: &[Option<Channel>]) -> u64 {
    let reasons = Reject::ALL.into_iter();
    reasons
        .filter(|reason| !matches!(reason, Reject::Sequence | Reject::Stamp))
        .flat_map(|reason| {
            channels
                .iter()
                .map(move |channel| counters.rejected_for(reason, *channel))
        })
        .sum()
}
