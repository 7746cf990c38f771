//! The streaming decoder: splits received bytes into frames at their flags, takes escapes out, and counts what is
//! outside of frames.

use alloc::vec::Vec;

use crate::frame::{
    ESCAPE_XOR, FLAG, Header, MAX_BODY, MAX_PENDING, Reject, Rejected, claimed_channel, is_special,
    open,
};

/// Finds frames in a stream of bytes, whatever else is in it.
#[derive(Debug)]
pub struct Decoder {
    pending: Vec<u8>,
    read: usize,
    body: [u8; MAX_BODY],
    len: usize,
    state: State,
    /// Bytes seen outside frames.
    pub garbage: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Outside any frame until the next flag.
    Hunt,
    /// After a flag: collecting a body.
    Body,
    /// The last byte was an escape.
    Escaped,
    /// The frame is lost; it is reported when it ends.
    Spoiled(Reject),
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder that waits for its first flag.
    pub const fn new() -> Self {
        Self {
            pending: Vec::new(),
            read: 0,
            body: [0; MAX_BODY],
            len: 0,
            state: State::Hunt,
            garbage: 0,
        }
    }

    /// Takes bytes as they arrived. Beyond [`MAX_PENDING`] the oldest are dropped as garbage: whoever reads too late is
    /// better served with new bytes.
    pub fn push(&mut self, bytes: &[u8]) {
        self.pending.drain(..self.read);
        self.read = 0;
        let newest = &bytes[bytes.len().saturating_sub(MAX_PENDING)..];
        let excess = (self.pending.len() + newest.len()).saturating_sub(MAX_PENDING);
        let dropped = excess + bytes.len() - newest.len();
        if dropped > 0 {
            self.garbage += (dropped + self.len) as u64;
            self.len = 0;
            self.state = State::Hunt;
            self.pending.drain(..excess);
        }
        self.pending.extend_from_slice(newest);
    }

    /// Drops an unfinished frame and bytes not yet looked at, as garbage: the bytes that follow do not continue them.
    pub fn restart(&mut self) {
        self.garbage += (self.pending_len() + self.len) as u64;
        self.pending.clear();
        self.read = 0;
        self.len = 0;
        self.state = State::Hunt;
    }

    /// The next whole frame, good or rejected, or `None` until more bytes arrive.
    ///
    /// A frame that is returned has a right FCS and known version, channel and addresses.
    pub fn next_frame(&mut self) -> Option<Result<(Header, &[u8]), Rejected>> {
        let ended = self.run_to_frame_end()?;
        let len = core::mem::take(&mut self.len);
        Some(ended.map_or_else(
            |reason| {
                Err(Rejected {
                    reason,
                    channel: claimed_channel(&self.body[..len]),
                })
            },
            |()| open(&self.body[..len]),
        ))
    }

    /// Bytes taken and not yet looked at, at most [`MAX_PENDING`].
    pub fn pending_len(&self) -> usize {
        self.pending.len() - self.read
    }

    /// Consumes pending bytes up to the flag that ends a frame.
    fn run_to_frame_end(&mut self) -> Option<Result<(), Reject>> {
        while let Some(rest) = self
            .pending
            .get(self.read..)
            .filter(|rest| !rest.is_empty())
        {
            let run = rest
                .iter()
                .position(|&byte| is_special(byte))
                .unwrap_or(rest.len());
            if run > 0 {
                self.take_run(run);
                continue;
            }
            let special = rest[0];
            self.read += 1;
            if special == FLAG {
                match core::mem::replace(&mut self.state, State::Body) {
                    // Flags may repeat and may be shared between frames.
                    State::Body if self.len == 0 => {}
                    State::Hunt => {}
                    State::Body => return Some(Ok(())),
                    State::Escaped => return Some(Err(Reject::Escape)),
                    State::Spoiled(reason) => return Some(Err(reason)),
                }
            } else {
                match self.state {
                    State::Body => self.state = State::Escaped,
                    State::Escaped => self.state = State::Spoiled(Reject::Escape),
                    State::Hunt | State::Spoiled(_) => self.garbage += 1,
                }
            }
        }
        None
    }

    /// Consumes `run` bytes, none of them a flag or an escape.
    fn take_run(&mut self, mut run: usize) {
        let mut bytes = &self.pending[self.read..self.read + run];
        self.read += run;
        if self.state == State::Escaped {
            let byte = bytes[0] ^ ESCAPE_XOR;
            bytes = &bytes[1..];
            run -= 1;
            // Any other escape would be a second spelling of the same frame.
            if !is_special(byte) {
                self.state = State::Spoiled(Reject::Escape);
            } else if self.len == MAX_BODY {
                self.state = State::Spoiled(Reject::TooLong);
            } else {
                self.body[self.len] = byte;
                self.len += 1;
                self.state = State::Body;
            }
        }
        if self.state == State::Body {
            let fits = run.min(MAX_BODY - self.len);
            self.body[self.len..self.len + fits].copy_from_slice(&bytes[..fits]);
            self.len += fits;
            run -= fits;
            if run > 0 {
                self.state = State::Spoiled(Reject::TooLong);
            }
        }
        self.garbage += run as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::ESCAPE;

    /// The tail of a frame whose head was dropped is garbage; the flag behind it ends no frame and
    /// aborts none.
    #[test]
    fn an_overrun_leaves_no_half_frame_behind() {
        let mut decoder = Decoder::new();
        decoder.push(&[FLAG, 1, 2, ESCAPE]);
        assert!(decoder.next_frame().is_none());
        let mut flood = alloc::vec![0; MAX_PENDING];
        flood[10] = FLAG;
        decoder.push(&flood[..20]);
        decoder.push(&flood);
        assert!(decoder.next_frame().is_none());
        assert_eq!(decoder.pending_len(), 0);
        // Garbage: two bytes of the body, twenty of the first push, ten before the flag, and what exceeds the longest
        // body of the frame that the flag began.
        let began = MAX_PENDING - 11;
        assert_eq!(decoder.garbage, (2 + 20 + 10 + began - MAX_BODY) as u64);
    }
}
