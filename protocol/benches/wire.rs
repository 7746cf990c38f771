//! Time for a frame: `cargo bench -p protocol`.
//!
//! Goal: encoding and decoding one 64-byte frame takes at most 1 µs, both ends' checks included.

use divan::{Bencher, black_box};
use protocol::link::{End, Link};
use protocol::message::{Identity, Message, SelfTest};
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
