//! The receiver of TWC: two tones, one for each bit value, and bytes with a start bit, even parity and a stop bit.

use core::f32::consts::TAU;

use protocol::config::TwcConfig;

use super::downmix::{Downmix, Phasor};

/// Nominal number of values of the complex envelope for each bit.
const VALUES_PER_BIT: f32 = 20.0;
/// Longest bit, values.
const MOST: usize = 32;
/// Length of the filter, over the length of a bit.
const FILTER: f32 = 0.4;
/// Least mean purity of a byte's bits: with [`FILTER`] noise has 0.41 (1 σ from byte to byte: 0.057); a signal at Eb/N0
/// of 8 dB has 0.74, and one byte of 14 less than this.
const LEAST_PURITY: f32 = 0.68;
/// Least level behind the filter, over the least level in the antenna: the filter weakens both tones a little.
const BEHIND_FILTER: f32 = 0.95;
/// Bits of a byte, with start, parity and stop bit.
const BITS: f32 = 11.0;
/// Share of a timing error that a change between bits corrects.
const NUDGE: f32 = 0.25;

/// The tones and the bit rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tones {
    /// Frequency midway between the two tones, Hz.
    pub middle_hz: f32,
    /// Distance of each tone from the middle, Hz; the upper tone is bit 1.
    pub apart_hz: f32,
    /// Bits per second.
    pub bit_rate: f32,
}

impl Tones {
    /// The tones of a unit configuration.
    pub fn of(twc: &TwcConfig) -> Self {
        Self {
            middle_hz: twc.middle_hz as f32,
            apart_hz: twc.apart_hz as f32,
            bit_rate: twc.bits_per_s as f32,
        }
    }
}

/// A byte that was received, or what was wrong with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received {
    /// A byte whose parity and stop bit are right.
    Byte(u8),
    /// A byte whose parity is wrong.
    Parity,
    /// A byte without its stop bit.
    Framing,
}

/// Tells the tones apart without their phase (non-coherent detection).
#[derive(Clone, Debug)]
pub struct Demodulator {
    downmix: Downmix,
    turn: Phasor,
    tone: Phasor,
    /// Each tone's part of the values of the last bit length.
    upper: [Phasor; MOST],
    lower: [Phasor; MOST],
    length: usize,
    place: usize,
}

impl Demodulator {
    /// Demodulator of samples at this rate, Hz.
    pub fn new(tones: Tones, sample_hz: f32) -> Self {
        let envelope_hz = (VALUES_PER_BIT * tones.bit_rate).min(sample_hz);
        let values = libm::roundf(FILTER * envelope_hz / tones.bit_rate) as usize;
        let downmix = Downmix::of_length(
            tones.middle_hz,
            sample_hz,
            envelope_hz,
            2.0 * tones.apart_hz + tones.bit_rate,
            values.max(3),
        );
        let value_hz = downmix.envelope_hz;
        let length = libm::roundf(value_hz / tones.bit_rate) as usize;
        Self {
            turn: Phasor::at(TAU * tones.apart_hz / value_hz),
            tone: Phasor { re: 1.0, im: 0.0 },
            downmix,
            upper: [Phasor::default(); MOST],
            lower: [Phasor::default(); MOST],
            length: length.clamp(1, MOST),
            place: 0,
        }
    }

    /// Values for each bit.
    pub fn values_per_bit(&self, bit_rate: f32) -> f32 {
        self.downmix.envelope_hz / bit_rate
    }

    /// Takes a sample, mV; returns what was heard over the last bit length, for each value of the envelope.
    pub fn take(&mut self, sample_mv: f32) -> Option<BitHeard> {
        let value = self.downmix.take(sample_mv)?;
        self.upper[self.place] = value.times_conj(self.tone);
        self.lower[self.place] = value.times(self.tone);
        self.place = (self.place + 1) % self.length;
        self.tone = self.tone.times(self.turn);
        let length = self.tone.abs();
        (self.tone.re, self.tone.im) = (self.tone.re / length, self.tone.im / length);
        let power = |line: &[Phasor; MOST]| {
            let mut sum = Phasor::default();
            for value in &line[..self.length] {
                sum.re += value.re;
                sum.im += value.im;
            }
            sum.re * sum.re + sum.im * sum.im
        };
        let (upper, lower) = (power(&self.upper), power(&self.lower));
        let both = upper + lower;
        let all: f32 = self.upper[..self.length]
            .iter()
            .map(|value| value.re * value.re + value.im * value.im)
            .sum();
        let part = |of: f32, whole: f32| if whole > 0.0 { of / whole } else { 0.0 };
        Some(BitHeard {
            lean: part(upper - lower, both),
            purity: part(both, all * self.length as f32),
            amplitude_mv: libm::sqrtf(all / self.length as f32),
        })
    }
}

/// What was heard over the last bit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BitHeard {
    /// By how much the upper tone was stronger, −1 to 1.
    pub lean: f32,
    /// Share of the power within the band that belongs to the tones: 1 for a tone, about 0.4 for noise.
    pub purity: f32,
    /// Amplitude of everything within the band, mV: that of the tones, also while one takes over from the other.
    pub amplitude_mv: f32,
}

/// Receives bytes.
#[derive(Clone, Debug)]
pub struct FskReceiver {
    demodulator: Demodulator,
    values_per_bit: f32,
    level_min_mv: f32,
    last: f32,
    /// Number of the bit being received, and values until its end; `None` between bytes.
    bit: Option<(u8, f32)>,
    byte: u8,
    ones: u8,
    /// Sum of the purity of the byte's bits.
    purity: f32,
}

impl FskReceiver {
    /// What is weaker than `level_min_mv`, rms, is silence.
    pub fn new(tones: Tones, sample_hz: f32, level_min_mv: f32) -> Self {
        let demodulator = Demodulator::new(tones, sample_hz);
        Self {
            values_per_bit: demodulator.values_per_bit(tones.bit_rate),
            demodulator,
            level_min_mv,
            last: 1.0,
            bit: None,
            byte: 0,
            ones: 0,
            purity: 0.0,
        }
    }

    /// Takes a sample, mV.
    pub fn take(&mut self, sample_mv: f32) -> Option<Received> {
        let BitHeard {
            lean,
            purity,
            amplitude_mv,
        } = self.demodulator.take(sample_mv)?;
        let last = core::mem::replace(&mut self.last, lean);
        if amplitude_mv < BEHIND_FILTER * self.level_min_mv * core::f32::consts::SQRT_2 {
            self.bit = None;
            self.last = 1.0;
            return None;
        }
        // A change of the tone is where the lean is zero: each tone has half of the last bit length there.
        let crossing = (last > 0.0) != (lean > 0.0);
        let since = lean / (lean - last);
        let Some((bit, left)) = &mut self.bit else {
            if crossing && lean < 0.0 {
                self.bit = Some((0, self.values_per_bit / 2.0 - since));
                (self.byte, self.ones, self.purity) = (0, 0, 0.0);
            }
            return None;
        };
        *left -= 1.0;
        if crossing {
            // At a change, half a bit is left until the end of the new one.
            let late = *left + since - self.values_per_bit / 2.0;
            *left -= NUDGE * late;
        }
        if *left > 0.0 {
            return None;
        }
        let (number, one) = (*bit, lean > 0.0);
        *left += self.values_per_bit;
        *bit += 1;
        self.purity += purity;
        match number {
            0 if one => self.bit = None,
            0 => {}
            1..=8 => {
                self.byte |= u8::from(one) << (number - 1);
                self.ones += u8::from(one);
            }
            9 => self.ones += u8::from(one),
            _ => {
                self.bit = None;
                if self.purity < LEAST_PURITY * BITS {
                    return None;
                }
                return Some(match (one, self.ones % 2) {
                    (false, _) => Received::Framing,
                    (true, 1) => Received::Parity,
                    (true, _) => Received::Byte(self.byte),
                });
            }
        }
        None
    }
}
