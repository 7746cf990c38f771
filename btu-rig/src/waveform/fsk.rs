//! TWC: bytes as two tones of one continuous phase.

use std::collections::VecDeque;

use super::{Phase, cosine};

/// Bits of rest before the first byte and after the last.
const REST: usize = 30;

/// The samples of some bytes, mV.
#[derive(Clone, Debug)]
pub struct FskWave {
    carrier: Phase,
    /// Cycles for each sample of bit 0 and of bit 1.
    steps: [f64; 2],
    bits: VecDeque<bool>,
    bit: Phase,
    bit_step: f64,
    amplitude_mv: f64,
}

impl FskWave {
    /// Bytes with a start bit, the lowest bit first, even parity and a stop bit, at this level, mV rms. Bit 0 is
    /// `middle_hz - apart_hz`.
    pub fn new(
        bytes: &[u8],
        (middle_hz, apart_hz): (f64, f64),
        bit_rate: f64,
        level_mv: f64,
        sample_hz: f64,
    ) -> Self {
        let mut wave = Self {
            carrier: Phase::default(),
            steps: [middle_hz - apart_hz, middle_hz + apart_hz].map(|tone| tone / sample_hz),
            bits: VecDeque::new(),
            bit: Phase::default(),
            bit_step: bit_rate / sample_hz,
            amplitude_mv: level_mv * std::f64::consts::SQRT_2,
        };
        wave.send(bytes);
        wave
    }

    /// Sends bytes behind those that are not sent yet; after silence a rest comes first.
    pub fn send(&mut self, bytes: &[u8]) {
        match self.bits.len().checked_sub(REST) {
            // The rest that the earlier bytes end with comes after the new bytes instead.
            Some(left) => self.bits.truncate(left),
            None => self.bits.extend(std::iter::repeat_n(true, REST)),
        }
        for byte in bytes {
            self.bits.push_back(false);
            self.bits.extend((0..8).map(|bit| byte >> bit & 1 == 1));
            self.bits.extend([byte.count_ones() % 2 == 1, true]);
        }
        self.bits.extend(std::iter::repeat_n(true, REST));
    }
}

impl Iterator for FskWave {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        let one = *self.bits.front()?;
        if self.bit.step(self.bit_step) + self.bit_step >= 1.0 {
            self.bits.pop_front();
        }
        Some(self.amplitude_mv * cosine(self.carrier.step(self.steps[usize::from(one)])))
    }
}
