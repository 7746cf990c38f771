//! The receiver of TWC on a channel, and the bytes that belong together.

use ato_under_test::receivers::{FskReceiver, Received, Tones};
use protocol::config::UnitConfig;

use super::reading::{Clock, MOST, Source};

/// Bytes of TWC that are farther apart are two messages, s.
const APART_S: f64 = 0.2;
/// Bytes after which a message that does not end is told as the next one.
const LONGEST: usize = 4_096;

/// The receiver of TWC, and the bytes that belong together.
pub(super) struct Twc {
    receiver: FskReceiver,
    tones: Tones,
    pub(super) under_way: Option<Source>,
    pub(super) done: Vec<Source>,
    /// Whether a message was being received at each asking of the codes in the last block.
    pub(super) understood: Vec<bool>,
}

impl Twc {
    pub(super) fn new(unit: &UnitConfig, sample_hz: f64) -> Self {
        let level_min = unit.receiver.level_min_mv as f32;
        Self {
            receiver: FskReceiver::new(Tones::of(&unit.twc), sample_hz as f32, level_min),
            tones: Tones::of(&unit.twc),
            under_way: None,
            done: Vec::new(),
            understood: Vec::new(),
        }
    }

    pub(super) fn take_block(&mut self, samples: &[f32], clock: Clock, channel: usize) {
        self.understood.clear();
        for (place, sample) in samples.iter().enumerate() {
            if let Some(received) = self.receiver.take(*sample) {
                self.receive(received, clock.at_s(place), channel);
            }
            if (place + 1) % clock.asked_every == 0 {
                self.understood.push(self.is_in_message(clock.at_s(place)));
            }
        }
    }

    fn is_in_message(&self, at_s: f64) -> bool {
        (self.under_way.as_ref()).is_some_and(|source| at_s - source.to_s < APART_S)
    }

    fn receive(&mut self, received: Received, at_s: f64, channel: usize) {
        let goes_on = self.is_in_message(at_s)
            && (self.under_way.as_ref()).is_some_and(|source| source.what.len() < 3 * LONGEST);
        if !goes_on {
            self.done.extend(self.under_way.take());
            self.done.truncate(MOST);
        }
        let tones = self.tones;
        let byte_s = 11.0 / f64::from(tones.bit_rate);
        let source = self.under_way.get_or_insert_with(|| Source {
            kind: "twc",
            channel,
            from_s: at_s - byte_s,
            carrier_hz: f64::from(tones.middle_hz),
            rate_hz: f64::from(tones.bit_rate),
            bad_bytes: Some(0),
            ..Source::default()
        });
        source.to_s = at_s;
        match received {
            Received::Byte(byte) => {
                let blank = if source.what.is_empty() { "" } else { " " };
                source.what.push_str(&format!("{blank}{byte:02x}"));
            }
            Received::Parity | Received::Framing => {
                source.bad_bytes = source.bad_bytes.map(|bad| bad + 1);
            }
        }
    }
}
