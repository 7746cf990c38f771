//! Known answers: the files of `vectors/`, made without this crate, tested both ways.

use protocol::frame::{self, Header, VERSION};
use protocol::link::{End, Link};
use protocol::message::{Address, CATALOGUE, Channel, Message};
use protocol::{Instant, frame::Reject};

use crate::common::{blocks, bytes, only_frame, over_channels};

const FILES: [&str; 5] = ["ptu.hex", "io.hex", "tcms.hex", "twc.hex", "escapes.hex"];

/// A block of a message file, split into its columns.
struct Vector {
    name: String,
    header: Vec<[String; 3]>,
    code: u8,
    fields: Vec<[String; 3]>,
    fcs: Vec<u8>,
    frame: Vec<u8>,
}

impl Vector {
    fn read(block: &[String]) -> Self {
        let mut vector = Self {
            name: String::new(),
            header: vec![],
            code: 0,
            fields: vec![],
            fcs: vec![],
            frame: vec![],
        };
        for line in block {
            let (part, rest) = line.split_once(' ').expect("a part and its contents");
            let mut columns = rest.split_whitespace();
            let mut next = || columns.next().unwrap_or_default().to_owned();
            match part {
                "message" => vector.name = next(),
                "code" => vector.code = bytes(&next()[2..])[0],
                "fcs" => vector.fcs = bytes(&columns.skip(1).collect::<Vec<_>>().join(" ")),
                "frame" => vector.frame = bytes(rest),
                "header" | "field" => {
                    let (name, value) = (next(), next());
                    let row = [name, value, columns.collect::<Vec<_>>().join(" ")];
                    if part == "header" {
                        &mut vector.header
                    } else {
                        &mut vector.fields
                    }
                    .push(row);
                }
                other => panic!("a vector has no part {other}"),
            }
        }
        vector
    }

    fn header(&self, name: &str) -> u32 {
        let [_, value, _] = self
            .header
            .iter()
            .find(|row| row[0] == name)
            .unwrap_or_else(|| panic!("{name}"));
        let parsed = match value.strip_prefix("0x") {
            Some(digits) => u32::from_str_radix(digits, 16),
            None => value.parse(),
        };
        parsed.unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn expected_header(&self) -> Header {
        assert_eq!(self.header("version"), u32::from(VERSION));
        let address = |name| Address::from_code(self.header(name) as u8).expect("an address");
        Header {
            channel: Channel::from_code(self.header("channel") as u8).expect("a channel"),
            source: address("source"),
            destination: address("destination"),
            seq: self.header("seq") as u16,
            stamp_ms: self.header("stamp_ms"),
        }
    }
}

fn vectors() -> Vec<Vector> {
    FILES
        .iter()
        .flat_map(|file| blocks(file))
        .map(|block| Vector::read(&block))
        .collect()
}

#[test]
fn every_message_has_a_vector() {
    let vectors = vectors();
    for spec in CATALOGUE {
        assert!(
            vectors.iter().any(|v| v.name == spec.name),
            "{}, run protocol/regenerate",
            spec.name
        );
    }
}

#[test]
fn decoding_gives_exactly_the_fields_and_encoding_the_bytes() {
    for vector in vectors() {
        let (header, payload) = only_frame(&vector.frame);
        assert_eq!(header, vector.expected_header(), "{}", vector.name);
        let message = Message::decode(header.channel, &payload).expect(&vector.name);
        assert_eq!(message.name(), vector.name);
        assert_eq!(payload[0], vector.code, "{}", vector.name);
        let shown: Vec<_> = message
            .show()
            .into_iter()
            .map(|(field, value)| [field.name.to_owned(), value])
            .collect();
        let written: Vec<_> = vector
            .fields
            .iter()
            .map(|row| [row[0].clone(), row[1].clone()])
            .collect();
        assert_eq!(shown, written, "{}", vector.name);
        let mut encoded = Vec::new();
        message.encode(&mut encoded);
        assert_eq!(encoded, payload, "{}", vector.name);
        let mut sent = Vec::new();
        frame::encode(&header, &encoded, &mut sent);
        assert_eq!(sent, vector.frame, "{}", vector.name);
    }
}

/// The parts written out in a vector make up its frame, so that a person who reads one can trust it.
#[test]
fn vectors_are_what_they_say() {
    for vector in vectors() {
        let mut body: Vec<u8> = vector
            .header
            .iter()
            .flat_map(|row| bytes(&row[2]))
            .collect();
        body.push(vector.code);
        body.extend(vector.fields.iter().flat_map(|row| bytes(&row[2])));
        body.extend(&vector.fcs);
        let mut stuffed = vec![0x7E];
        for byte in body {
            match byte {
                0x7E => stuffed.extend([0x7D, 0x5E]),
                0x7D => stuffed.extend([0x7D, 0x5D]),
                other => stuffed.push(other),
            }
        }
        stuffed.push(0x7E);
        assert_eq!(stuffed, vector.frame, "{}", vector.name);
    }
}

#[test]
fn check_sequences() {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let lines = blocks("fcs.hex").concat();
    assert!(lines.contains(&String::from("0xcbf43926  31 32 33 34 35 36 37 38 39")));
    for line in lines {
        let (number, text) = line.split_once("  ").expect("a number and bytes");
        let text = if text == "-" { vec![] } else { bytes(text) };
        assert_eq!(format!("0x{:08x}", crc.checksum(&text)), number);
        assert_eq!(format!("0x{:08x}", bit_by_bit(&text)), number);
    }
}

/// The algorithm as `WIRE.md` writes it down.
fn bit_by_bit(body: &[u8]) -> u32 {
    let mut crc = 0xFFFF_FFFF_u32;
    for &byte in body {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 {
                crc >> 1 ^ 0xEDB8_8320
            } else {
                crc >> 1
            };
        }
    }
    crc ^ 0xFFFF_FFFF
}

/// Feeds a case to a new receiver, `chunk` bytes at a time, and gives what came of each line.
fn outcomes(block: &[String], chunk: usize) -> (Vec<String>, Vec<String>) {
    let end = if block.iter().any(|line| line == "end bench") {
        End::Bench
    } else {
        End::Unit
    };
    let mut link = Link::new(end);
    let (mut wanted, mut seen) = (vec![], vec![]);
    for line in block
        .iter()
        .filter(|line| line.as_bytes()[0].is_ascii_digit())
    {
        let (at_ms, rest) = line.split_once(' ').expect("a time");
        let (outcome, hex) = rest
            .trim()
            .split_once("  ")
            .expect("an outcome, then bytes");
        let now = Instant::from_ms(at_ms.parse().expect("a time in ms"));
        let mut came = vec![];
        for piece in bytes(hex).chunks(chunk) {
            link.push(piece);
            feed(&mut link, now, &mut came);
        }
        wanted.push(outcome.to_owned());
        seen.push(if came.is_empty() {
            "nothing".to_owned()
        } else {
            came.join(",")
        });
    }
    for line in block {
        match line.split_once(' ') {
            Some(("garbage", count)) => {
                wanted.push(format!("garbage {count}"));
                seen.push(format!("garbage {}", link.counters().garbage()));
            }
            Some(("gaps", count)) => {
                wanted.push(format!("gaps {count}"));
                seen.push(format!(
                    "gaps {}",
                    over_channels(|c| link.counters().gaps(c))
                ));
            }
            _ => {}
        }
    }
    (wanted, seen)
}

/// Polls until nothing comes, and notes every acceptance and every count of a refusal. Refusals
/// are noted before the acceptance they stood in front of.
fn feed(link: &mut Link, now: Instant, came: &mut Vec<String>) {
    loop {
        let before = *link.counters();
        let received = link.poll(now);
        let after = link.counters();
        for reason in Reject::ALL {
            for _ in before.rejected(reason)..after.rejected(reason) {
                came.push(format!("reject {}", reason.label()));
            }
        }
        match received {
            Some(received) => came.push(format!("accept {}", received.message.name())),
            None => return,
        }
    }
}

#[test]
fn bad_frames_are_refused_for_the_right_reason() {
    for block in blocks("bad.hex") {
        for chunk in [1, 7, usize::MAX] {
            let (wanted, seen) = outcomes(&block, chunk);
            assert_eq!(seen, wanted, "{} ({chunk} bytes at a time)", block[0]);
        }
    }
}

#[test]
fn every_reason_has_a_bad_frame() {
    let text = blocks("bad.hex").concat().concat();
    for reason in Reject::ALL {
        assert!(
            text.contains(&format!("reject {}", reason.label())),
            "{}",
            reason.label()
        );
    }
}

#[test]
fn the_worked_session_works() {
    let (mut unit, mut bench) = (Link::new(End::Unit), Link::new(End::Bench));
    let mut challenge = None;
    for line in blocks("session.hex").concat() {
        let columns: Vec<&str> = line.split_whitespace().collect();
        let [at_ms, way, name, ref hex @ ..] = columns[..] else {
            panic!("{line}")
        };
        let now = Instant::from_ms(at_ms.parse().expect("a time in ms"));
        let link = if way == ">" { &mut unit } else { &mut bench };
        link.push(&bytes(&hex.join(" ")));
        let received = link
            .poll(now)
            .unwrap_or_else(|| panic!("{line}: {:?}", link.counters()));
        assert_eq!(received.message.name(), name, "{line}");
        match received.message {
            Message::ArmChallenge(asked) => challenge = Some(asked),
            Message::ArmConfirm(confirm) => {
                let asked = challenge.expect("a challenge comes first");
                assert_eq!(confirm.answer, !asked.challenge ^ asked.session);
            }
            _ => {}
        }
    }
    assert!(challenge.is_some());
    for link in [unit, bench] {
        assert_eq!(link.counters().rejected_total(), 0);
        assert_eq!(over_channels(|channel| link.counters().gaps(channel)), 0);
    }
}
