//! Frames of every message towards the unit, and what is done to them on the way.

use protocol::frame::{self, ESCAPE, ESCAPE_XOR, FCS_LEN, FLAG, HEADER_LEN, MAX_BODY, MAX_PAYLOAD};
use protocol::link::{Link, MAX_AHEAD};
use protocol::message::{CATALOGUE, Channel, Message, MessageSpec};
use protocol::{Instant, Random};

protocol::labelled! {
    /// Damage to a frame.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Kind: label {
        Bits = "1 to 8 bits flipped",
        Bytes = "1 to 8 bytes changed",
        Cut = "a piece cut out",
        Doubled = "a piece doubled, up to four times",
        Spliced = "a piece of another frame put in",
        Burst = "a burst of noise put in",
        Escaped = "a byte escaped without need",
        /// From here on the check sequence fits.
        Length = "FCS fits: payload too short or too long",
        Header = "FCS fits: version, channel or address changed",
        Number = "FCS fits: sequence number out of reach",
        Stamp = "FCS fits: time stamp of up to 60 s ago",
        Older = "a sound frame that was heard before",
    }
}

impl Kind {
    /// The check sequence is that of the damaged frame.
    const fn fits(self) -> bool {
        self as usize >= Self::Length as usize
    }
}

/// Makes frames and damages them, the same for the same seed.
pub struct Damager {
    random: Random,
    /// Session that most requests name.
    session: u32,
    specs: Vec<&'static MessageSpec>,
    /// Frames that were left as they were, and not sent.
    pub left_whole: u64,
}

impl Damager {
    pub fn new(seed: u64, session: u32) -> Self {
        let towards_unit = CATALOGUE.iter().filter(|spec| !spec.sent_by_unit());
        Self {
            random: Random::new(seed),
            session,
            specs: towards_unit.collect(),
            left_whole: 0,
        }
    }

    /// Appends a damaged frame, whose number and time stamp are the next of `link`; `older` were heard before.
    pub fn add(
        &mut self,
        link: &mut Link,
        now: Instant,
        older: &[Vec<u8>],
        out: &mut Vec<u8>,
    ) -> Kind {
        let kind = Kind::ALL[self.random.below(Kind::ALL.len())];
        loop {
            let mut frame = Vec::new();
            link.send(now, &self.message(), &mut frame);
            let damaged = self.damaged(kind, frame, older);
            // The end of the one before may complete it.
            let under_way = out.rsplit(|&byte| byte == FLAG).next().unwrap_or(&[]);
            let stream = [under_way, &damaged].concat();
            let is_older = |whole: &[u8]| older.iter().any(|old| old[1..old.len() - 1] == *whole);
            let mut whole = whole_frames(&stream).peekable();
            if kind.fits() || whole.peek().is_none() {
                out.extend(&damaged);
                return kind;
            }
            if whole.all(is_older) {
                out.extend(&damaged);
                return Kind::Older;
            }
            self.left_whole += 1;
        }
    }

    /// Any message towards the unit, with any fields.
    fn message(&mut self) -> Message {
        let spec = self.specs[self.random.below(self.specs.len())];
        let fields = (1..spec.payload_len()).map(|_| self.random.bits() as u8);
        let mut payload: Vec<u8> = std::iter::once(spec.code).chain(fields).collect();
        let first = spec.fields.first().map(|field| field.name);
        if first == Some("session") && self.random.chance(0.75) {
            payload[1..5].copy_from_slice(&self.session.to_be_bytes());
        }
        Message::decode(spec.channel, &payload).expect("fields take any value")
    }

    fn damaged(&mut self, kind: Kind, mut frame: Vec<u8>, older: &[Vec<u8>]) -> Vec<u8> {
        let (from, to) = self.piece(frame.len());
        match kind {
            Kind::Bits => {
                for _ in 0..=self.random.below(8) {
                    let at = self.random.below(frame.len());
                    frame[at] ^= 1 << self.random.below(8);
                }
            }
            Kind::Bytes => {
                for _ in 0..=self.random.below(8) {
                    let at = self.random.below(frame.len());
                    frame[at] = self.random.bits() as u8;
                }
            }
            Kind::Cut => drop(frame.drain(from..to)),
            Kind::Doubled => {
                let copies = frame[from..to].repeat(1 + self.random.below(3));
                frame.splice(from..from, copies);
            }
            Kind::Spliced => {
                let donor = &older[self.random.below(older.len())];
                let (first, end) = self.piece(donor.len());
                frame.splice(from..to, donor[first..end].iter().copied());
            }
            Kind::Burst => {
                let length = 1 + self.random.below(MAX_BODY);
                let noise: Vec<u8> = (0..length).map(|_| self.random.bits() as u8).collect();
                frame.splice(from..to, noise);
            }
            Kind::Escaped => {
                let at = 1 + self.random.below(frame.len() - 2);
                let escaped = [ESCAPE, frame[at] ^ ESCAPE_XOR];
                frame.splice(at..=at, escaped);
            }
            Kind::Older => frame.clone_from(&older[self.random.below(older.len())]),
            _ => {
                let mut body = opened(&frame[1..frame.len() - 1]).expect("a sound frame");
                self.change(kind, &mut body);
                frame = closed(&body);
            }
        }
        frame
    }

    /// A piece of something so long, not empty.
    fn piece(&mut self, length: usize) -> (usize, usize) {
        let from = self.random.below(length);
        (from, from + 1 + self.random.below(length - from))
    }

    /// Changes the body in a way that its check sequence does not tell.
    fn change(&mut self, kind: Kind, body: &mut Vec<u8>) {
        match kind {
            Kind::Length => {
                let (sound, any) = (body.len(), self.random.below(MAX_PAYLOAD + 1));
                let other = if HEADER_LEN + any == sound {
                    sound - 1
                } else {
                    HEADER_LEN + any
                };
                body.resize_with(other, || self.random.bits() as u8);
            }
            Kind::Header => body[self.random.below(4)] ^= 1 + self.random.below(255) as u8,
            Kind::Number => {
                // The number is at most so far ahead of the last accepted one, or the frames between are too many.
                let ahead = usize::from(MAX_AHEAD);
                let by = ahead + 1 + self.random.below(0x1_0000 - 2 * ahead - 1);
                let seq = u16::from_be_bytes([body[4], body[5]]).wrapping_add(by as u16);
                body[4..6].copy_from_slice(&seq.to_be_bytes());
            }
            _ => {
                let stamp = body[6..10].try_into().expect("four bytes");
                // Not late, but earlier than the frame that each scan begins with.
                let each_scan = [Channel::Ptu, Channel::Io].map(Channel::code);
                let by = match each_scan.contains(&body[1]) && self.random.chance(0.5) {
                    true => 200 + self.random.below(280),
                    false => 1000 + self.random.below(59_000),
                };
                let stamp = u32::from_be_bytes(stamp).wrapping_sub(by as u32);
                body[6..10].copy_from_slice(&stamp.to_be_bytes());
            }
        }
    }
}

/// Bytes between flags whose check sequence fits.
fn whole_frames(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let between = bytes.split(|&byte| byte == FLAG);
    between.filter(|stuffed| opened(stuffed).is_some())
}

/// A body without its check sequence, if that fits and every escape is one that a sender may use.
fn opened(stuffed: &[u8]) -> Option<Vec<u8>> {
    let mut body = Vec::with_capacity(stuffed.len());
    let mut bytes = stuffed.iter();
    while let Some(&byte) = bytes.next() {
        if byte == ESCAPE {
            let plain = bytes.next()? ^ ESCAPE_XOR;
            body.push(plain);
            if plain != FLAG && plain != ESCAPE {
                return None;
            }
        } else {
            body.push(byte);
        }
    }
    let fcs = body.split_off(body.len().checked_sub(FCS_LEN)?);
    (body.len() >= HEADER_LEN && fcs == frame::fcs(&body).to_le_bytes()).then_some(body)
}

/// A body as a frame with its check sequence.
fn closed(body: &[u8]) -> Vec<u8> {
    let fcs = frame::fcs(body).to_le_bytes();
    let mut frame = vec![FLAG];
    for &byte in body.iter().chain(&fcs) {
        match byte {
            FLAG | ESCAPE => frame.extend([ESCAPE, byte ^ ESCAPE_XOR]),
            _ => frame.push(byte),
        }
    }
    frame.push(FLAG);
    frame
}
