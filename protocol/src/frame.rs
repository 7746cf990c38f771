//! Frames: async-HDLC as in RFC 1662 with FCS-32. A [`Decoder`] finds them in a stream of bytes.
//!
//! A frame is `7E`, the stuffed body, `7E`. The body is version, channel, source, destination,
//! sequence number, time stamp, payload and FCS. Inside the body `7E` is sent as `7D 5E` and `7D`
//! as `7D 5D`; nothing else is escaped, so each frame has exactly one encoding.

use alloc::vec::Vec;

use crc::{CRC_32_ISO_HDLC, Crc, Table};

pub use crate::decoder::Decoder;
use serde::{Deserialize, Serialize};

use crate::message::{Address, CATALOGUE, Channel};

/// Version of the wire, first byte of every frame.
pub const VERSION: u8 = 1;
/// Bytes before the payload.
pub const HEADER_LEN: usize = 10;
/// Bytes of the frame check sequence.
pub const FCS_LEN: usize = 4;
/// Longest payload, bytes; every message of the catalogue is shorter or as long.
pub const MAX_PAYLOAD: usize = 240;
/// Longest body, before stuffing.
pub const MAX_BODY: usize = HEADER_LEN + MAX_PAYLOAD + FCS_LEN;
/// Received bytes a [`Decoder`] keeps at most until they are asked for: about eight seconds of
/// the wire, so that only a reader that has stopped reading ever meets it.
pub const MAX_PENDING: usize = 64 * 1024;

const _: () = {
    let mut i = 0;
    while i < CATALOGUE.len() {
        assert!(CATALOGUE[i].payload_len() <= MAX_PAYLOAD);
        i += 1;
    }
};

/// Ends one frame and begins the next.
pub const FLAG: u8 = 0x7E;
/// Ends the bytes of one scan where both ends move on in lock step: frames have no more than two flags in
/// a row, and a decoder passes over empty ones.
pub const SCAN_END: [u8; 3] = [FLAG; 3];
/// Announces that the next byte is exclusive-ored with [`ESCAPE_XOR`].
pub const ESCAPE: u8 = 0x7D;
/// Number with which an escaped byte is exclusive-ored.
pub const ESCAPE_XOR: u8 = 0x20;

/// Sixteen bytes a step: at one byte a step the check sequence would be the slowest part of a frame.
static FCS: Crc<u32, Table<16>> = Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC);

/// Frame check sequence over `bytes`: the CRC of Ethernet, zlib and zip.
pub fn fcs(bytes: &[u8]) -> u32 {
    FCS.checksum(bytes)
}

/// Fields of a frame before the payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// Kind of traffic; each has its own sequence numbers.
    pub channel: Channel,
    /// Address of the sender.
    pub source: Address,
    /// Address of the receiver.
    pub destination: Address,
    /// Sequence number, one up for each frame the sender sends on the channel, wrapping.
    pub seq: u16,
    /// Sender's clock when the frame was made, ms, wrapping.
    pub stamp_ms: u32,
}

crate::labelled! {
    /// Reason for rejecting a frame. Each frame is counted under the first reason that applies, in the order of `ALL`; the
    /// [`label`](Reject::label) is shown and stored.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum Reject: label {
        /// Fewer bytes between two flags than header and FCS take.
        TooShort = "too_short",
        /// More bytes between two flags than the longest frame has.
        TooLong = "too_long",
        /// The FCS does not fit.
        Checksum = "checksum",
        /// Another version of the wire.
        Version = "version",
        /// No channel has this number, or this end does not hear the channel.
        Channel = "channel",
        /// An address is nobody's, or sender or receiver is not the one that this end expects on the channel.
        Address = "address",
        /// Aborted by its sender, or an escape that no sender may use.
        Escape = "escape",
        /// Old, repeated, out of order, or too far ahead.
        Sequence = "sequence",
        /// The time stamp goes backward, or the frame is late.
        Stamp = "stamp",
        /// The payload is no message of its channel.
        Layout = "layout",
    }
}

/// A rejected frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rejected {
    /// First reason that applies.
    pub reason: Reject,
    /// Channel that the frame claims, if it got that far. With a wrong FCS this is a hint for whoever counts, not a
    /// fact.
    pub channel: Option<Channel>,
}

/// Appends one frame, with its opening and its closing flag.
///
/// # Panics
/// If the payload is longer than [`MAX_PAYLOAD`], which no [`crate::message::Message`] is.
pub fn encode(header: &Header, payload: &[u8], out: &mut Vec<u8>) {
    assert!(
        payload.len() <= MAX_PAYLOAD,
        "payload of {} bytes",
        payload.len()
    );
    let mut body = [0; MAX_BODY];
    let end = HEADER_LEN + payload.len();
    body[0] = VERSION;
    body[1] = header.channel.code();
    body[2] = header.source.code();
    body[3] = header.destination.code();
    body[4..6].copy_from_slice(&header.seq.to_be_bytes());
    body[6..10].copy_from_slice(&header.stamp_ms.to_be_bytes());
    body[HEADER_LEN..end].copy_from_slice(payload);
    let sequence = fcs(&body[..end]);
    // RFC 1662 sends the coefficient of the highest power first, which in this reflected form is
    // the least significant octet.
    body[end..end + FCS_LEN].copy_from_slice(&sequence.to_le_bytes());

    out.reserve(end + FCS_LEN + 8);
    out.push(FLAG);
    stuff(&body[..end + FCS_LEN], out);
    out.push(FLAG);
}

/// Appends `body` with its flags and escapes escaped.
fn stuff(mut body: &[u8], out: &mut Vec<u8>) {
    while let Some(at) = body.iter().position(|&byte| is_special(byte)) {
        out.extend_from_slice(&body[..at]);
        out.extend_from_slice(&[ESCAPE, body[at] ^ ESCAPE_XOR]);
        body = &body[at + 1..];
    }
    out.extend_from_slice(body);
}

/// Whether a byte is [`ESCAPE`] or [`FLAG`], which are neighbours: one comparison for both.
pub(crate) const fn is_special(byte: u8) -> bool {
    byte.wrapping_sub(ESCAPE) < 2
}

/// Checks and takes apart a body.
pub(crate) fn open(body: &[u8]) -> Result<(Header, &[u8]), Rejected> {
    let channel = claimed_channel(body);
    let rejected = |reason| Rejected { reason, channel };
    let (covered, fcs) = body.split_last_chunk().ok_or(rejected(Reject::TooShort))?;
    let (head, payload) = covered
        .split_first_chunk::<HEADER_LEN>()
        .ok_or(rejected(Reject::TooShort))?;
    if FCS.checksum(covered) != u32::from_le_bytes(*fcs) {
        return Err(rejected(Reject::Checksum));
    }
    let [version, _, source, destination, s1, s0, t3, t2, t1, t0] = *head;
    if version != VERSION {
        return Err(rejected(Reject::Version));
    }
    let address = |code| Address::from_code(code).ok_or(rejected(Reject::Address));
    let header = Header {
        channel: channel.ok_or(rejected(Reject::Channel))?,
        source: address(source)?,
        destination: address(destination)?,
        seq: u16::from_be_bytes([s1, s0]),
        stamp_ms: u32::from_be_bytes([t3, t2, t1, t0]),
    };
    Ok((header, payload))
}

pub(crate) fn claimed_channel(body: &[u8]) -> Option<Channel> {
    body.get(1).and_then(|&code| Channel::from_code(code))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worked_example() {
        let header = Header {
            channel: Channel::Ptu,
            source: Address::Tester,
            destination: Address::Unit,
            seq: 0,
            stamp_ms: 4660,
        };
        // The check sequence 0xC3F2914A was worked out bit by bit, as WIRE.md shows.
        let frame = [
            0x7E, 1, 1, 0x10, 0x20, 0, 0, 0, 0, 0x12, 0x34, 1, 0x4A, 0x91, 0xF2, 0xC3, 0x7E,
        ];
        let mut out = Vec::new();
        encode(&header, &[1], &mut out);
        assert_eq!(out, frame);
        let mut decoder = Decoder::new();
        decoder.push(&frame);
        assert_eq!(decoder.next_frame(), Some(Ok((header, &[1][..]))));
    }
}
