//! From samples at the coil to the complex envelope of one carrier, at a rate that carries a code.

use alloc::vec::Vec;

use libm::{cosf, sinf};

/// Length of the filter, in values of the envelope.
const LENGTH: usize = 8;
/// Most taps of the filter: at 96 000 samples a second a slow code's envelope needs 5 688.
const MOST_TAPS: usize = 8_192;

/// A point of the complex envelope.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Phasor {
    /// In phase with the local oscillator, mV.
    pub re: f32,
    /// A quarter turn ahead of the local oscillator, mV.
    pub im: f32,
}

impl Phasor {
    /// Amplitude, mV.
    pub fn abs(self) -> f32 {
        libm::sqrtf(self.power())
    }

    /// Square of the amplitude, mV².
    pub fn power(self) -> f32 {
        self.re * self.re + self.im * self.im
    }

    /// Product with the conjugate of another phasor: its angle is the angle between both.
    pub fn times_conj(self, other: Self) -> Self {
        Self {
            re: self.re * other.re + self.im * other.im,
            im: self.im * other.re - self.re * other.im,
        }
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            re: self.re + other.re,
            im: self.im + other.im,
        }
    }

    pub(crate) fn angle(self) -> f32 {
        libm::atan2f(self.im, self.re)
    }

    pub(crate) fn times(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }

    /// Phasor of unit length at this angle.
    pub fn at(angle: f32) -> Self {
        Self {
            re: cosf(angle),
            im: sinf(angle),
        }
    }
}

/// Mixes the carrier down to zero, filters and decimates.
#[derive(Clone, Debug)]
pub struct Downmix {
    oscillator: Phasor,
    turn: Phasor,
    /// Samples for each value.
    by: usize,
    /// Samples until the next value.
    left: usize,
    line: Vec<Phasor>,
    place: usize,
    taps: Vec<f32>,
    /// Rate of the values it gives, Hz.
    pub envelope_hz: f32,
}

impl Downmix {
    /// For a carrier in samples of this rate: values at about `envelope_hz`, of all within `pass_hz` of the carrier.
    pub fn new(carrier_hz: f32, sample_hz: f32, envelope_hz: f32, pass_hz: f32) -> Self {
        Self::of_length(carrier_hz, sample_hz, envelope_hz, pass_hz, LENGTH)
    }

    /// Like [`Self::new`], with a filter that is `length` values of the envelope long.
    pub fn of_length(
        carrier_hz: f32,
        sample_hz: f32,
        envelope_hz: f32,
        pass_hz: f32,
        values: usize,
    ) -> Self {
        let by = (libm::roundf(sample_hz / envelope_hz) as usize).clamp(1, MOST_TAPS / LENGTH);
        let length = values * by;
        Self {
            oscillator: Phasor { re: 1.0, im: 0.0 },
            turn: Phasor::at(-core::f32::consts::TAU * carrier_hz / sample_hz),
            by,
            left: by,
            line: alloc::vec![Phasor::default(); length],
            place: 0,
            taps: low_pass(pass_hz / sample_hz, length),
            envelope_hz: sample_hz / by as f32,
        }
    }

    /// Takes a sample, mV; gives the complex amplitude of the carrier from time to time.
    pub fn take(&mut self, sample_mv: f32) -> Option<Phasor> {
        self.line[self.place] = Phasor {
            re: sample_mv * self.oscillator.re,
            im: sample_mv * self.oscillator.im,
        };
        // A division would be the dearest part.
        self.place += 1;
        if self.place == self.line.len() {
            self.place = 0;
        }
        self.oscillator = self.oscillator.times(self.turn);
        self.left -= 1;
        if self.left > 0 {
            return None;
        }
        self.left = self.by;
        // Rounding errors change the length of a rotated phasor.
        let length = self.oscillator.abs();
        self.oscillator.re /= length;
        self.oscillator.im /= length;
        let mut sum = Phasor::default();
        let (late, early) = self.line.split_at(self.place);
        for (value, tap) in early.iter().chain(late).zip(&self.taps) {
            sum.re += value.re * tap;
            sum.im += value.im * tap;
        }
        Some(sum)
    }
}

/// A Hann-windowed low pass; its edge in cycles per sample. Its gain is 2: half of a real carrier is at the negative
/// frequency.
fn low_pass(edge: f32, length: usize) -> Vec<f32> {
    let mut taps = alloc::vec![0.0; length];
    let middle = (length - 1) as f32 / 2.0;
    for (place, tap) in taps.iter_mut().enumerate() {
        let from_middle = place as f32 - middle;
        let turn = core::f32::consts::TAU * (place as f32 + 0.5) / length as f32;
        let angle = core::f32::consts::TAU * edge * from_middle;
        let sinc = match from_middle {
            0.0 => 1.0,
            _ => sinf(angle) / angle,
        };
        *tap = (0.5 - 0.5 * cosf(turn)) * sinc;
    }
    let sum: f32 = taps.iter().sum();
    taps.iter_mut().for_each(|tap| *tap *= 2.0 / sum);
    taps
}
