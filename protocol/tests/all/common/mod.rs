//! Parts shared by the tests of the wire: the vector files, and a seeded generator.
#![allow(dead_code)]

use std::fs;
use std::path::PathBuf;

use protocol::frame::{Decoder, Header};
use protocol::link::End;
use protocol::message::{CATALOGUE, Channel, Message, MessageSpec};

/// The blocks of a vector file, each a list of lines; comments are gone.
pub fn blocks(file: &str) -> Vec<Vec<String>> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("vectors")
        .join(file);
    let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut blocks = vec![vec![]];
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        match line.trim() {
            "" => blocks.push(vec![]),
            line => blocks
                .last_mut()
                .expect("never empty")
                .push(line.to_owned()),
        }
    }
    blocks.retain(|block| !block.is_empty());
    blocks
}

/// Bytes written as pairs of digits.
pub fn bytes(hex: &str) -> Vec<u8> {
    hex.split_whitespace()
        .map(|pair| u8::from_str_radix(pair, 16).unwrap_or_else(|e| panic!("{pair}: {e}")))
        .collect()
}

/// Header and payload of the only frame in `stream`.
pub fn only_frame(stream: &[u8]) -> (Header, Vec<u8>) {
    let mut decoder = Decoder::new();
    decoder.push(stream);
    let (header, payload) = decoder
        .next_frame()
        .expect("a frame")
        .expect("a good frame");
    let payload = payload.to_vec();
    assert!(decoder.next_frame().is_none());
    assert_eq!(decoder.garbage, 0);
    (header, payload)
}

pub fn receiver(spec: &MessageSpec) -> End {
    if spec.sent_by_unit() {
        End::Bench
    } else {
        End::Unit
    }
}

/// The message of a catalogue entry with fields filled from `bytes`, again and again.
pub fn message_from(spec: &MessageSpec, bytes: &[u8]) -> Message {
    let mut payload = vec![spec.code];
    payload.extend(bytes.iter().cycle().take(spec.payload_len() - 1));
    Message::decode(spec.channel, &payload).expect("fields take any bytes")
}

/// Frames of every message, from the vector files.
pub fn corpus() -> Vec<(&'static MessageSpec, Vec<u8>)> {
    let files = ["ptu.hex", "io.hex", "tcms.hex", "twc.hex", "escapes.hex"];
    let blocks = files.iter().flat_map(|file| blocks(file));
    blocks
        .map(|block| {
            let name = block[0]
                .strip_prefix("message ")
                .expect("a block begins with its message");
            let frame = block.last().and_then(|line| line.strip_prefix("frame"));
            (
                spec(name),
                bytes(frame.expect("a block ends with its frame")),
            )
        })
        .collect()
}

/// The catalogue entry called `name`.
pub fn spec(name: &str) -> &'static MessageSpec {
    CATALOGUE
        .iter()
        .find(|spec| spec.name == name)
        .unwrap_or_else(|| panic!("no message {name}"))
}

/// All channels' sum of what `count` says.
pub fn over_channels(count: impl Fn(Channel) -> u64) -> u64 {
    Channel::ALL.into_iter().map(count).sum()
}
