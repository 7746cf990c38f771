//! One end of the wire: addresses, sequence numbers, time stamps and time-outs of each channel.
//!
//! The checks are the defences that EN 50159 names for a closed transmission system. A frame that fails one is counted
//! by reason and changes nothing else.

mod counters;
mod receiver;

use alloc::vec::Vec;

use crate::Instant;
use crate::frame::{self, Decoder, Header, Reject, Rejected};
use crate::message::{Address, Channel, Message};

pub use counters::Counters;
pub use receiver::{MAX_AHEAD, MAX_DELAY, RELAX, RESYNC};

use counters::CHANNELS;
use receiver::Receiver;

/// The end of the wire at which a link is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The unit under test: receives from its partner on each channel.
    Unit,
    /// Tester, I/O rack, TCMS and wayside together: receive from the unit.
    Bench,
}

/// An accepted frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Received {
    /// Addresses, sequence number and time stamp, checked.
    pub header: Header,
    /// Decoded payload.
    pub message: Message,
}

/// One end of the wire.
#[derive(Debug)]
pub struct Link {
    end: End,
    /// Channels that are heard here.
    hears: [bool; CHANNELS],
    decoder: Decoder,
    receivers: [Option<Receiver>; CHANNELS],
    next_seq: [u16; CHANNELS],
    payload: Vec<u8>,
    counters: Counters,
}

impl Link {
    /// Counts of accepted and rejected frames so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// An end that hears every channel, and has received nothing yet.
    pub const fn new(end: End) -> Self {
        Self::with_channels(end, &Channel::ALL)
    }

    /// An end that hears these channels alone: frames of any other are rejected as [`Reject::Channel`].
    pub const fn with_channels(end: End, channels: &[Channel]) -> Self {
        let mut hears = [false; CHANNELS];
        let mut i = 0;
        while i < channels.len() {
            hears[channels[i] as usize] = true;
            i += 1;
        }
        Self {
            end,
            hears,
            decoder: Decoder::new(),
            receivers: [None; CHANNELS],
            next_seq: [0; CHANNELS],
            payload: Vec::new(),
            counters: Counters {
                accepted: [0; CHANNELS],
                gaps: [0; CHANNELS],
                out_of_place: [0; CHANNELS],
                rejected: [[0; CHANNELS + 1]; Reject::ALL.len()],
                garbage: 0,
            },
        }
    }

    /// Appends the frame that carries `message` to `out`; gives its sequence number.
    pub fn send(&mut self, now: Instant, message: &Message, out: &mut Vec<u8>) -> u16 {
        let channel = message.channel();
        let (own, partner) = addresses(self.end, channel);
        let seq = self.next_seq[channel as usize];
        self.next_seq[channel as usize] = seq.wrapping_add(1);
        let header = Header {
            channel,
            source: own,
            destination: partner,
            seq,
            stamp_ms: now.stamp_ms(),
        };
        self.payload.clear();
        message.encode(&mut self.payload);
        frame::encode(&header, &self.payload, out);
        seq
    }

    /// Takes bytes as they arrived. [`Self::poll`] judges stamps by the time of its own call, so call it in the same
    /// step.
    pub fn push(&mut self, bytes: &[u8]) {
        self.decoder.push(bytes);
        self.counters.garbage = self.decoder.garbage;
    }

    /// Starts a new connection: drops the unfinished frame and the state of every channel. Counters stay.
    pub fn reset_connection(&mut self) {
        self.decoder.restart();
        self.counters.garbage = self.decoder.garbage;
        self.receivers = [None; CHANNELS];
    }

    /// The next accepted frame. Frames rejected before it are counted.
    pub fn poll(&mut self, now: Instant) -> Option<Received> {
        let accepted = loop {
            let Some(next) = self.decoder.next_frame() else {
                break None;
            };
            let checked = next.and_then(|(header, payload)| {
                let rejected = |reason| Rejected {
                    reason,
                    channel: Some(header.channel),
                };
                if !self.hears[header.channel as usize] {
                    return Err(rejected(Reject::Channel));
                }
                let (own, partner) = addresses(self.end, header.channel);
                if (header.source, header.destination) != (partner, own) {
                    return Err(rejected(Reject::Address));
                }
                let receiver = &mut self.receivers[header.channel as usize];
                let acceptance = match Receiver::judge(receiver, now, &header) {
                    Ok(acceptance) => acceptance,
                    Err(reason) => {
                        if let Some(receiver) = receiver {
                            receiver.out_of_place = receiver.out_of_place.saturating_add(1);
                        }
                        return Err(rejected(reason));
                    }
                };
                let message = Message::decode(header.channel, payload)
                    .map_err(|_| rejected(Reject::Layout))?;
                // A message that only this end may send: an echo of its own frame, or a wrong sender.
                if message.spec().sent_by_unit() == (self.end == End::Unit) {
                    return Err(rejected(Reject::Layout));
                }
                *receiver = Some(acceptance.receiver);
                self.counters.gaps[header.channel as usize] += u64::from(acceptance.gap);
                self.counters.out_of_place[header.channel as usize] +=
                    u64::from(acceptance.out_of_place);
                Ok(Received { header, message })
            });
            match checked {
                Ok(received) => break Some(received),
                Err(mut rejected) => {
                    // A channel that is not heard here is counted like one that does not exist.
                    rejected.channel = rejected.channel.filter(|c| self.hears[*c as usize]);
                    self.counters.reject(rejected);
                }
            }
        };
        self.counters.garbage = self.decoder.garbage;
        if let Some(received) = &accepted {
            self.counters.accepted[received.header.channel as usize] += 1;
        }
        accepted
    }

    /// When the last frame was accepted on a channel.
    pub fn last_heard(&self, channel: Channel) -> Option<Instant> {
        self.receivers[channel as usize].map(|receiver| receiver.heard_at)
    }
}

/// Own address and partner's on a channel.
const fn addresses(end: End, channel: Channel) -> (Address, Address) {
    match end {
        End::Unit => (Address::Unit, Address::partner(channel)),
        End::Bench => (Address::partner(channel), Address::Unit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Duration;
    use crate::message::{Identify, IoInput, KeepAlive, Status, TcmsToAtc, TwcWayside};

    /// A tester whose numbers and clock begin again is heard at once on a new connection, and half a frame left by the
    /// tester before spoils none of its frames.
    #[test]
    fn after_a_reset_connection_every_channel_starts_fresh() {
        let keep_alive = Message::from(KeepAlive { session: 0 });
        let (mut unit, mut before) = (Link::new(End::Unit), Link::new(End::Bench));
        let mut frames = Vec::new();
        for ms in [60_000, 60_200] {
            before.send(Instant::from_ms(ms), &keep_alive, &mut frames);
        }
        let now = Instant::from_ms(70_000);
        unit.push(&frames[..frames.len() - 5]);
        assert!(unit.poll(now).is_some() && unit.poll(now).is_none());
        let mut frame = Vec::new();
        Link::new(End::Bench).send(Instant::from_ms(10), &keep_alive, &mut frame);
        unit.reset_connection();
        unit.push(&frame);
        assert_eq!(unit.poll(now).map(|r| r.message), Some(keep_alive));
        let counters = &unit.counters;
        assert_eq!(
            (counters.accepted_total(), counters.rejected_total()),
            (2, 0)
        );
        assert_eq!(counters.garbage(), frame.len() as u64 - 6);
    }

    /// Time from a tester's last frame to the first accepted frame of its successor, ms. The successor begins
    /// `after_ms` later with number `seq` and speaks every 10 ms by a clock that is `behind_ms` behind.
    fn refused_ms(after_ms: u64, seq: u16, behind_ms: u64) -> u64 {
        const LAST_MS: u64 = 10_000;
        let (mut unit, mut before) = (Link::new(End::Unit), Link::new(End::Bench));
        let mut say = |sender: &mut Link, at_ms, stamp_ms| {
            let mut frame = Vec::new();
            sender.send(Instant::from_ms(stamp_ms), &Identify {}.into(), &mut frame);
            unit.push(&frame);
            unit.poll(Instant::from_ms(at_ms)).is_some()
        };
        for ms in (0..=LAST_MS).step_by(10) {
            assert!(say(&mut before, ms, ms));
        }
        let mut successor = Link::new(End::Bench);
        successor.next_seq[Channel::Ptu as usize] = seq;
        let begins_ms = LAST_MS + after_ms;
        let mut said = (begins_ms..).step_by(10);
        let heard = said.find(|&ms| say(&mut successor, ms, ms - behind_ms.min(ms)));
        heard.expect("it is heard in the end") - LAST_MS
    }

    /// Goal: a successor on the same line is refused for as long as `WIRE.md` says, and no longer. Method: successors
    /// that begin at any time, by any clock, with numbers that continue the predecessor's or do not.
    #[test]
    fn a_successor_is_refused_for_two_seconds_at_most() {
        let last_seq = 1000;
        let longest = |seq| {
            let clocks = (0..4000).step_by(50);
            let all =
                clocks.flat_map(|behind| (10..1500).step_by(70).map(move |after| (after, behind)));
            let beside =
                all.map(|(after, behind)| refused_ms(after, seq, behind).max(after) - after);
            beside.max().expect("some")
        };
        let fits = longest(last_seq + 100);
        let other = longest(last_seq + 5000);
        assert!((1500..=2000).contains(&fits), "{fits} ms");
        assert!((900..=1000).contains(&other), "{other} ms");
        // Silence first, and numbers far away: heard at once.
        for behind in (0..4000).step_by(50) {
            assert_eq!(refused_ms(1100, last_seq + 5000, behind), 1100);
        }
    }

    #[test]
    fn both_ends_hear_each_other() {
        let (mut unit, mut bench) = (Link::new(End::Unit), Link::new(End::Bench));
        let now = Instant::from_ms(70_000);
        let (mut there, mut back) = (Vec::new(), Vec::new());
        assert_eq!(bench.send(now, &Identify {}.into(), &mut there), 0);
        assert_eq!(bench.send(now, &Identify {}.into(), &mut there), 1);
        unit.push(&there);
        assert_eq!(unit.poll(now).map(|r| r.message), Some(Identify {}.into()));
        assert_eq!(unit.poll(now).map(|r| r.header.seq), Some(1));
        assert_eq!(unit.poll(now), None);
        unit.send(now, &Status::default().into(), &mut back);
        bench.push(&back);
        assert_eq!(
            bench.poll(now).map(|r| r.message),
            Some(Status::default().into())
        );
        assert_eq!(bench.last_heard(Channel::Ptu), Some(now));
        assert_eq!(unit.counters.accepted(Channel::Ptu), 2);
        assert_eq!(unit.counters.rejected_total(), 0);
    }

    /// Goal: a frame of a channel that an end does not hear has no effect and no answer, and is counted under no
    /// channel. Method: a unit's end for the tester alone gets a frame of each channel, and a damaged one of the I/O
    /// channel.
    #[test]
    fn an_end_with_one_channel_rejects_frames_of_the_others() {
        let mut unit = Link::with_channels(End::Unit, &[Channel::Ptu]);
        let mut bench = Link::new(End::Bench);
        let mut frames = Vec::new();
        for message in [
            IoInput::default().into(),
            Message::from(TcmsToAtc::default()),
            TwcWayside::default().into(),
            Identify {}.into(),
            IoInput::default().into(),
        ] {
            bench.send(Instant::ZERO, &message, &mut frames);
        }
        let last = frames.len() - 2;
        frames[last] ^= 1;
        unit.push(&frames);
        let heard: Vec<_> = core::iter::from_fn(|| unit.poll(Instant::ZERO)).collect();
        assert!(
            matches!(
                heard[..],
                [Received {
                    message: Message::Identify(_),
                    ..
                }]
            ),
            "{heard:?}"
        );
        let counters = &unit.counters;
        assert_eq!(counters.rejected_for(Reject::Channel, None), 3);
        assert_eq!(counters.rejected_for(Reject::Checksum, None), 1);
        assert_eq!(counters.rejected_total(), 4);
    }

    /// Goal: a line that gives frames twice is distinguished from a sender that was started again. Method: each
    /// frame twice, then another sender with the numbers and the clock of a fresh start.
    #[test]
    fn repeated_frames_are_out_of_place_and_those_of_a_new_start_are_not() {
        let mut unit = Link::new(End::Unit);
        let mut feed = |bench: &mut Link, now: Instant, times: usize| {
            let mut frame = Vec::new();
            bench.send(
                now.back(Duration::from_ms(1)),
                &Identify {}.into(),
                &mut frame,
            );
            for _ in 0..times {
                unit.push(&frame);
                while unit.poll(now).is_some() {}
            }
            unit.counters.out_of_place(Channel::Ptu)
        };
        let (mut first, mut second) = (Link::new(End::Bench), Link::new(End::Bench));
        let mut now = Instant::from_ms(70_000);
        for _ in 0..10 {
            now += Duration::from_ms(200);
            feed(&mut first, now, 2);
        }
        now += Duration::from_ms(200);
        assert_eq!(feed(&mut first, now, 1), 10);
        for _ in 0..10 {
            now += Duration::from_ms(200);
            assert_eq!(feed(&mut second, now, 1), 10);
        }
        assert!(unit.counters.rejected(Reject::Sequence) > 12);
    }

    /// Method: a unit that lives for 300 ms, and again 100 ms later, with numbers and clock from the beginning.
    #[test]
    fn a_sender_that_is_started_again_soon_is_not_out_of_place() {
        let mut bench = Link::new(End::Bench);
        let mut now = Instant::from_ms(10_000);
        for frames in [30, 60] {
            let mut unit = Link::new(End::Unit);
            for i in 0..frames {
                now += Duration::from_ms(10);
                let mut frame = Vec::new();
                let status = crate::message::Status::default();
                unit.send(Instant::from_ms(10 * i), &status.into(), &mut frame);
                bench.push(&frame);
                while bench.poll(now).is_some() {}
            }
            now += Duration::from_ms(100);
        }
        let counters = &bench.counters;
        assert!(counters.rejected(Reject::Sequence) > 20);
        assert!(
            counters.accepted(Channel::Ptu) > 50,
            "the second is heard, too"
        );
        assert_eq!(counters.out_of_place(Channel::Ptu), 0);
    }
}
