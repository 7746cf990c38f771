//! Says what is wrong with the connection to the unit, in words a technician can act on.
//!
//! Only channels that no fault of the unit can silence are watched: a unit that does not answer
//! TCMS or the wayside is a finding, not a bench error.

use std::net::{Ipv6Addr, SocketAddr};

use protocol::frame::Reject;
use protocol::link::{Counters, Link, RESYNC};
use protocol::message::{Channel, Taken};
use protocol::{Duration, Instant};

/// Time a unit has to be heard for the first time: it may be starting.
const FIRST_CONTACT: Duration = Duration::from_ms(3000);
/// Silence that is an error: longer than the link takes to hear a unit again that was started anew.
const SILENCE: Duration = Duration::from_us(RESYNC.as_us() + 500_000);

/// The watch.
#[derive(Debug, Default)]
pub struct LinkWatch {
    begun: Option<Instant>,
    bytes: u64,
    taken: Option<Taken>,
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
    pub fn turned_away(&self) -> Option<String> {
        let taken = self.taken?;
        let ip = Ipv6Addr::from(taken.address).to_canonical();
        let by = SocketAddr::new(ip, taken.port);
        let seconds = |ms: u32| Duration::from_ms(u64::from(ms)).as_secs();
        let silence = match seconds(taken.silent_ms) {
            silent_s if silent_s < SILENCE.as_secs() => String::new(),
            silent_s => format!(", which has been silent for {silent_s:.0} s"),
        };
        Some(format!(
            "the unit is taken by another tester, {by}, for {:.0} s{silence}",
            seconds(taken.for_ms)
        ))
    }

    /// Notes that the bench runs.
    pub fn step(&mut self, now: Instant) {
        self.begun.get_or_insert(now);
    }

    /// What is wrong, if anything; `asks_since` = since when the tester speaks.
    pub fn error(&self, now: Instant, link: &Link, asks_since: Option<Instant>) -> Option<String> {
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
        let silent = |channel, since: Instant, name| {
            let heard = link.last_heard(channel).unwrap_or(begun).max(since);
            let silence = now.since(heard);
            (silence > SILENCE).then(|| {
                let seconds = silence.as_secs();
                format!("unit silent for {seconds:.1} s on the {name} channel")
            })
        };
        silent(Channel::Io, begun, "I/O")
            .or_else(|| asks_since.and_then(|since| silent(Channel::Ptu, since, "PTU")))
    }

    fn no_contact(&self, waited: Duration, counters: &Counters) -> String {
        if self.bytes == 0 {
            return format!(
                "unit silent: not one byte in {:.1} s — check the cable, the port and the unit's power",
                waited.as_secs()
            );
        }
        let bytes = self.bytes;
        let most = Reject::ALL
            .into_iter()
            .map(|reason| (counters.rejected(reason), reason))
            .max_by_key(|&(count, _)| count)
            .filter(|&(count, _)| count > 0);
        match most {
            Some((count, Reject::Version)) => format!(
                "{count} frames of another version of the wire — unit and bench programs differ"
            ),
            Some((count, reason)) => format!(
                "garbage: {bytes} bytes, no valid frame, {count} refused for {} — wrong baud rate?",
                reason.label()
            ),
            None => format!("garbage: {bytes} bytes, no valid frame — wrong baud rate?"),
        }
    }
}
