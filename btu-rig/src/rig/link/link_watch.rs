//! Finds what is wrong with the connection to the unit.
//!
//! Only channels that no fault of the unit can silence are watched: a unit that does not answer
//! TCMS or the wayside is a finding, not a bench error.

use std::net::{Ipv6Addr, SocketAddr};

use protocol::frame::Reject;
use protocol::link::{Counters, Link, RESYNC};
use protocol::message::{Channel, Taken};
use protocol::{Duration, Instant};

use crate::procedure::link_trouble::{GarbageCause, LinkTrouble, Refused};

/// Time a unit has to be heard for the first time: it may be starting.
const FIRST_CONTACT: Duration = Duration::from_ms(3000);
/// Silence that is an error: longer than the link takes to hear a unit that was started again.
const SILENCE: Duration = Duration::from_us(RESYNC.as_us() + 500_000);

/// Silence that is an error while most refused frames have a wrong sequence number or stamp: the unit starts again, and
/// may start once more just before it would be heard.
const STARTING: Duration = Duration::from_ms(10_000);

const WATCHED: [Channel; 2] = [Channel::Io, Channel::Ptu];

#[derive(Debug, Default)]
pub struct LinkWatch {
    begun: Option<Instant>,
    bytes: u64,
    taken: Option<Taken>,
    /// The tester's own computer stood still until then.
    stalled_until: Instant,
    /// Frames refused until each of the watched channels was last heard.
    refused: [RefusedCounts; WATCHED.len()],
}

/// Frames refused: in total, and for their sequence number or stamp (`restarted`), as after a restart of the unit.
#[derive(Clone, Copy, Debug, Default)]
struct RefusedCounts {
    total: u64,
    restarted: u64,
}

impl RefusedCounts {
    fn until_now(counters: &Counters) -> Self {
        Self {
            total: counters.rejected_total(),
            restarted: counters.rejected(Reject::Sequence) + counters.rejected(Reject::Stamp),
        }
    }

    fn since(self, before: Self) -> Self {
        Self {
            total: self.total - before.total,
            restarted: self.restarted - before.restarted,
        }
    }

    /// Most of the refused frames come from a unit that was started again.
    fn of_a_start(self) -> bool {
        2 * self.restarted > self.total
    }

    fn told(self) -> Option<Refused> {
        match self.total {
            0 => None,
            _ if self.of_a_start() => Some(Refused::OfStarts(self.restarted)),
            total => Some(Refused::Frames(total)),
        }
    }
}

impl LinkWatch {
    /// Notes what arrived.
    pub fn note(&mut self, bytes: usize) {
        self.bytes += bytes as u64;
    }

    /// Notes that another client has the unit.
    pub fn note_taken(&mut self, taken: Taken) {
        self.taken = Some(taken);
    }

    /// Why the unit turned this client away, if it did.
    pub fn turned_away(&self) -> Option<LinkTrouble> {
        let taken = self.taken?;
        let ip = Ipv6Addr::from(taken.address).to_canonical();
        let silent = Duration::from_ms(u64::from(taken.silent_ms));
        Some(LinkTrouble::Taken {
            by: SocketAddr::new(ip, taken.port),
            held: Duration::from_ms(u64::from(taken.for_ms)),
            silent: Some(silent).filter(|silent| *silent >= SILENCE),
        })
    }

    /// Notes that the bench runs.
    pub fn step(&mut self, now: Instant) {
        self.begun.get_or_insert(now);
    }

    /// The tester's own computer stood still until now. Frames that came meanwhile may have been lost here, so silence counts
    /// from now on.
    pub fn note_stalled(&mut self, now: Instant) {
        self.stalled_until = now;
    }

    /// Notes that a frame of a channel was taken.
    pub fn note_frame(&mut self, channel: Channel, counters: &Counters) {
        let place = WATCHED.iter().position(|watched| *watched == channel);
        if let Some(refused) = place.and_then(|place| self.refused.get_mut(place)) {
            *refused = RefusedCounts::until_now(counters);
        }
    }

    /// Trouble of the link, if any; `asks_since` = since when the tester speaks. The I/O channel is watched only
    /// with a `harness`.
    pub fn error(
        &self,
        now: Instant,
        link: &Link,
        asks_since: Option<Instant>,
        harness: bool,
    ) -> Option<LinkTrouble> {
        if let Some(why) = self.turned_away() {
            return Some(why);
        }
        let begun = self.begun?;
        if now.since(begun) < FIRST_CONTACT {
            return None;
        }
        let heard_any = Channel::ALL.iter().any(|&c| link.last_heard(c).is_some());
        if !heard_any {
            return Some(self.no_contact(now.since(begun), link.counters()));
        }
        let since = [harness.then_some(begun), asks_since];
        let mut watched = WATCHED.iter().zip(since).zip(self.refused);
        watched.find_map(|((&channel, since), refused_before)| {
            let heard = link.last_heard(channel).unwrap_or(begun).max(since?);
            let silence = now.since(heard.max(self.stalled_until));
            let refused = RefusedCounts::until_now(link.counters()).since(refused_before);
            let at_most = if refused.of_a_start() {
                STARTING
            } else {
                SILENCE
            };
            (silence > at_most).then(|| LinkTrouble::Silent {
                channel,
                silence,
                refused: refused.told(),
            })
        })
    }

    fn no_contact(&self, waited: Duration, counters: &Counters) -> LinkTrouble {
        if self.bytes == 0 {
            return LinkTrouble::NotOneByte { within: waited };
        }
        let refused = |reason: &Reject| counters.rejected(*reason);
        let most_of = |reasons: &mut dyn Iterator<Item = Reject>| {
            let most = reasons.max_by_key(refused);
            most.filter(|reason| refused(reason) > 0)
        };
        // A frame whose check sequence fits was read at the right baud rate.
        let fitting = |reason: &Reject| !before_checksum(*reason);
        let cause = match most_of(&mut Reject::ALL.into_iter().filter(fitting)) {
            Some(Reject::Version) => {
                let frames = counters.rejected(Reject::Version);
                return LinkTrouble::OtherVersion { frames };
            }
            Some(Reject::Address) => GarbageCause::Echo,
            Some(_) => GarbageCause::OtherDevice,
            None => GarbageCause::BaudRate,
        };
        let most = most_of(&mut Reject::ALL.into_iter());
        LinkTrouble::Garbage {
            bytes: self.bytes,
            refused: most.map(|reason| (refused(&reason), reason)),
            cause,
        }
    }
}

/// Whether a frame refused for `reason` may have had a wrong check sequence.
fn before_checksum(reason: Reject) -> bool {
    matches!(
        reason,
        Reject::TooShort | Reject::TooLong | Reject::Escape | Reject::Checksum
    )
}
