//! Frames on their way between rig and unit.

use protocol::frame::{Decoder, FLAG, Header, MAX_PENDING, encode};
use protocol::message::Message;

/// Frames that pass by; what is no frame, as one that is damaged on purpose, goes on as it came.
#[derive(Default)]
pub(super) struct Relay {
    decoder: Decoder,
    came: Vec<u8>,
}

impl Relay {
    pub fn push(&mut self, bytes: &[u8]) {
        self.decoder.push(bytes);
        self.came.extend_from_slice(bytes);
    }

    pub fn next(&mut self, out: &mut Vec<u8>) -> Option<(Header, Message)> {
        while let Some(read) = self.decoder.next_frame() {
            let read = read.ok().and_then(|(header, payload)| {
                Some((header, Message::decode(header.channel, payload).ok()?))
            });
            let seen = self.came.len() - self.decoder.pending_len();
            if read.is_some() {
                self.came.drain(..seen);
                return read;
            }
            out.push(FLAG);
            out.extend(self.came.drain(..seen));
        }
        if self.came.len() > MAX_PENDING {
            out.append(&mut self.came);
        }
        None
    }
}

/// Appends a frame.
pub(super) fn send(header: &Header, message: &Message, out: &mut Vec<u8>) {
    let mut payload = Vec::new();
    message.encode(&mut payload);
    encode(header, &payload, out);
}
