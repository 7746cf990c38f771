//! What a frame costs: `cargo bench -p protocol`.
//!
//! Goal: encoding and decoding one 64-byte frame takes at most 1 µs, both ends' checks included.

use divan::counter::BytesCount;
use divan::{Bencher, black_box};
use protocol::frame::{self, Decoder, Header};
use protocol::link::{End, Link};
use protocol::message::{Address, Channel, Identity, IoInput, Message, SelfTest};
use protocol::{Duration, Instant, SCAN};

fn main() {
    divan::main();
}

/// The message nearest to 64 bytes on the wire: 62, with its flags.
fn identity() -> Message {
    Identity {
        serial: *b"SG-0042\0\0\0\0\0\0\0\0\0",
        config: *b"sg100\0\0\0\0\0\0\0\0\0\0\0",
        config_crc: 0xDEAD_BEEF,
        tdb_crc: 0x0123_4567,
        software: [1, 2, 3],
        uptime_ms: 3_600_000,
        self_test: SelfTest::empty(),
    }
    .into()
}

/// A link pair and a clock that goes on by one scan for each message.
struct Line {
    sender: Link,
    receiver: Link,
    now: Instant,
    bytes: Vec<u8>,
}

impl Line {
    fn new(sender: End, receiver: End) -> Self {
        Self {
            sender: Link::new(sender),
            receiver: Link::new(receiver),
            now: Instant::ZERO,
            bytes: Vec::new(),
        }
    }

    fn carry(&mut self, message: &Message) -> Message {
        self.now += SCAN;
        self.bytes.clear();
        self.sender.send(self.now, message, &mut self.bytes);
        self.receiver.push(&self.bytes);
        let received = self.receiver.poll(self.now + Duration::from_ms(1));
        received.expect("a sound frame is accepted").message
    }
}

#[divan::bench]
fn frame_of_64_bytes_end_to_end(bencher: Bencher) {
    let (mut line, message) = (Line::new(End::Unit, End::Bench), identity());
    bencher.bench_local(|| line.carry(black_box(&message)));
}

#[divan::bench]
fn io_input_end_to_end(bencher: Bencher) {
    let mut line = Line::new(End::Bench, End::Unit);
    let message = IoInput {
        carrier_hz: 3000,
        level_mv: 500,
        ..IoInput::default()
    }
    .into();
    bencher.bench_local(|| line.carry(black_box(&message)));
}

const HEADER: Header = Header {
    channel: Channel::Ptu,
    source: Address::Tester,
    destination: Address::Unit,
    seq: 0x1234,
    stamp_ms: 0x0123_4567,
};

/// 48 bytes of payload make 62 of body and 64 with the flags.
const PAYLOAD: [u8; 48] = [0x55; 48];

#[divan::bench]
fn encode_64_bytes(bencher: Bencher) {
    let mut out = Vec::with_capacity(256);
    bencher.bench_local(|| {
        out.clear();
        frame::encode(black_box(&HEADER), black_box(&PAYLOAD), &mut out);
        out.len()
    });
}

#[divan::bench]
fn decode_64_bytes(bencher: Bencher) {
    let mut bytes = Vec::new();
    frame::encode(&HEADER, &PAYLOAD, &mut bytes);
    assert_eq!(bytes.len(), 64);
    let mut decoder = Decoder::new();
    bencher.bench_local(|| {
        decoder.push(black_box(&bytes));
        decoder.next_frame().is_some_and(|next| next.is_ok())
    });
}

/// The worst that stuffing can do: every payload byte is escaped.
#[divan::bench]
fn encode_and_decode_all_escaped(bencher: Bencher) {
    let (mut bytes, mut decoder) = (Vec::new(), Decoder::new());
    bencher.bench_local(|| {
        bytes.clear();
        frame::encode(&HEADER, black_box(&[0x7E; 48]), &mut bytes);
        decoder.push(&bytes);
        decoder.next_frame().is_some_and(|next| next.is_ok())
    });
}

/// How fast a receiver finds its way through garbage, with and without flags in it.
#[divan::bench(args = [false, true])]
fn resynchronise_over_64_kib(bencher: Bencher, flags: bool) {
    let mut state = 1_u32;
    let noise: Vec<u8> = std::iter::repeat_with(|| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    })
    .filter(|&byte| flags || byte != 0x7E)
    .take(64 * 1024)
    .collect();
    let mut decoder = Decoder::new();
    bencher
        .counter(BytesCount::of_slice(&noise))
        .bench_local(|| {
            decoder.push(&noise);
            while decoder.next_frame().is_some() {}
            decoder.garbage()
        });
}
