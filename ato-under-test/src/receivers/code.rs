//! The receiver of ATP speed codes: a carrier that is keyed on and off at the code rate.
//!
//! The window of the last half second is judged as a whole and in three halves that overlap: a rate counts only if each
//! has it, with one phase, so that neither noise nor a change of the code is taken for a code that was not sent.

use core::f32::consts::{PI, SQRT_2, TAU};

use super::downmix::{Downmix, Phasor};

/// Rate of the envelope, about, Hz: fast enough for the third harmonic of the fastest code rate; and its pass band.
const ENVELOPE_HZ: f32 = 600.0;
const PASS_HZ: f32 = 160.0;
/// Longest window, values of the envelope.
const MOST: usize = 512;
/// Length of the window, s.
const WINDOW_S: f32 = 0.5;
/// A code is heard no later than this after it has begun, s: the window, and the filters' delay.
pub const HEARD_WITHIN_S: f32 = WINDOW_S + 0.02;
/// Of noise alone, the weaker half of all values has this share of the mean power.
const WEAKER_HALF: f32 = 1.0 - core::f32::consts::LN_2;
/// Least share of the keying's power that the rate's fundamental has, of the window and of each half. A square wave has
/// 0.81; two codes spliced in the window, or noise, have less.
const LEAST_SHARE: f32 = 0.55;
const LEAST_SHARE_OF_HALF: f32 = 0.45;
/// Share of a square wave's power at its fundamental, and how near to it a code must come.
const OF_SQUARE_WAVE: f32 = 8.0 / (PI * PI);
const NEARLY: f32 = 0.88;
/// Variance of the envelope that noise of this power makes: half of it while the carrier is on, 1 − π/4 in the pauses.
const NOISE_OF_ENVELOPE: f32 = 0.36;
/// Least depth of keying: amplitude of the fundamental over the mean. On and off by half has 1.27.
const LEAST_DEPTH: f32 = 0.6;
/// An envelope with less depth than this is a carrier without a code.
const FLAT: f32 = 0.15;

/// What the receiver makes of the last half second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heard {
    /// Frequency of the carrier, Hz.
    pub carrier_hz: f32,
    /// Code rate, Hz; 0 is a carrier without a code.
    pub rate_hz: f32,
    /// Level while the carrier is on, mV rms.
    pub level_mv: f32,
    /// Share of the keying's power at the fundamental of the rate, 0 to 1.
    pub validity: f32,
    /// Level over the noise within 160 Hz of the carrier, dB, as far as the pauses of the keying tell; of a carrier without
    /// a code it is not known.
    pub snr_db: Option<f32>,
}

/// Receives the codes of one carrier.
#[derive(Clone, Debug)]
pub struct CodeReceiver {
    downmix: Downmix,
    carrier_hz: f32,
    level_min_mv: f32,
    line: [Phasor; MOST],
    window: usize,
    place: usize,
    filled: usize,
}

impl CodeReceiver {
    /// For a carrier in samples of this rate, Hz. What is weaker than `level_min_mv` is not heard.
    pub fn new(carrier_hz: f32, sample_hz: f32, level_min_mv: f32) -> Self {
        let downmix = Downmix::new(carrier_hz, sample_hz, ENVELOPE_HZ, PASS_HZ);
        let window = (libm::roundf(WINDOW_S * downmix.envelope_hz()) as usize / 2 * 2).min(MOST);
        Self {
            downmix,
            carrier_hz,
            level_min_mv,
            line: [Phasor::default(); MOST],
            window,
            place: 0,
            filled: 0,
        }
    }

    /// Takes a sample, mV.
    pub fn take(&mut self, sample_mv: f32) {
        if let Some(value) = self.downmix.take(sample_mv) {
            self.line[self.place] = value;
            self.place = (self.place + 1) % self.window;
            self.filled = (self.filled + 1).min(self.window);
        }
    }

    /// What was heard in the last half second, if it is one code at one of these rates, or a carrier without one.
    pub fn heard(&self, rates_hz: &[f32]) -> Option<Heard> {
        if self.filled < self.window {
            return None;
        }
        let mean = self.mean(0, self.window);
        let on: (f32, u32) = (self.values(0, self.window)).fold((0.0, 0), |(sum, count), value| {
            match value.abs() > mean {
                true => (sum + value.abs(), count + 1),
                false => (sum, count),
            }
        });
        let level_mv = on.0 / on.1.max(1) as f32 / SQRT_2;
        if level_mv < self.level_min_mv {
            return None;
        }
        let heard = |rate_hz, level_mv, validity, snr_db| Heard {
            carrier_hz: self.carrier_hz + self.offset_hz(),
            rate_hz,
            level_mv,
            validity,
            snr_db,
        };
        let power = self.keying_power(0, self.window, mean);
        if libm::sqrtf(2.0 * power) < FLAT * mean {
            return Some(heard(0.0, mean / SQRT_2, 1.0, None));
        }
        let strongest = rates_hz
            .iter()
            .map(|rate| (*rate, self.tone(*rate, 0, self.window, mean)))
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let (rate, whole) = strongest;
        let amplitude = whole.abs();
        let share = amplitude * amplitude / 2.0 / power;
        if share < LEAST_SHARE || amplitude < LEAST_DEPTH * mean {
            return None;
        }
        // What the pauses hold is noise. It is in the mean, too, by the mean of its amplitude (Rayleigh).
        let noise = self.noise_power();
        let floor = libm::sqrtf(PI / 4.0 * noise);
        let share_on = on_share(amplitude / (mean - floor).max(amplitude / 2.0));
        let square = self.mean_of(0, self.window, |amplitude| amplitude * amplitude);
        let signal = (square - noise).max(0.0) / share_on;
        // Of a square wave in that noise the fundamental has so much; less is another shape, as of a jump of the phase.
        let keying = signal * share_on * (1.0 - share_on);
        if share < NEARLY * OF_SQUARE_WAVE * keying / (keying + NOISE_OF_ENVELOPE * noise) {
            return None;
        }
        let offset = self.offset_of_rate(rate)?;
        let level_mv = libm::sqrtf(signal / 2.0);
        let snr_db = Some(10.0 * libm::log10f(signal / noise.max(1e-9)));
        Some(heard(rate + offset, level_mv, share.min(1.0), snr_db))
    }

    /// By how much the code rate is above this one, Hz, from how its phase goes on: judged in three halves that overlap,
    /// since a jump of the phase looks like another rate, and shows in the middle half.
    fn offset_of_rate(&self, rate_hz: f32) -> Option<f32> {
        let half = self.window / 2;
        let mut phases = [0.0; 3];
        for (place, phase) in phases.iter_mut().enumerate() {
            let (from, to) = (place * half / 2, place * half / 2 + half);
            let mean = self.mean(from, to);
            let tone = self.tone(rate_hz, from, to, mean);
            let power = self.keying_power(from, to, mean);
            if tone.abs() * tone.abs() / 2.0 < LEAST_SHARE_OF_HALF * power {
                return None;
            }
            *phase = libm::atan2f(tone.im, tone.re);
        }
        // The phases are those at the middle of each half, of the nominal rate's own clock.
        let turned = wrapped(phases[2] - phases[0]);
        Some(turned / TAU / (half as f32 / self.downmix.envelope_hz()))
    }

    /// Values of the window from the oldest on.
    fn values(&self, from: usize, to: usize) -> impl Iterator<Item = Phasor> + '_ {
        (from..to).map(|place| self.line[(self.place + place) % self.window])
    }

    /// Mean, over a Hann window, of what `of` makes of the amplitude.
    fn mean_of(&self, from: usize, to: usize, of: impl Fn(f32) -> f32) -> f32 {
        let sum: f32 = (self.values(from, to).zip(hann(to - from)))
            .map(|(value, w)| of(value.abs()) * w)
            .sum();
        sum * 2.0 / (to - from) as f32
    }

    fn mean(&self, from: usize, to: usize) -> f32 {
        self.mean_of(from, to, |amplitude| amplitude)
    }

    /// Power of what varies, mV².
    fn keying_power(&self, from: usize, to: usize, mean: f32) -> f32 {
        self.mean_of(from, to, |amplitude| {
            (amplitude - mean) * (amplitude - mean)
        })
    }

    /// Amplitude and phase of the envelope at a rate.
    fn tone(&self, rate_hz: f32, from: usize, to: usize, mean: f32) -> Phasor {
        let step = TAU * rate_hz / self.downmix.envelope_hz();
        let mut sum = Phasor::default();
        for ((place, value), w) in (from..).zip(self.values(from, to)).zip(hann(to - from)) {
            let at = Phasor::at(-step * place as f32);
            let of = (value.abs() - mean) * w;
            sum.re += at.re * of;
            sum.im += at.im * of;
        }
        let scale = 4.0 / (to - from) as f32;
        Phasor {
            re: sum.re * scale,
            im: sum.im * scale,
        }
    }

    /// Square of the amplitude in the pauses, mV²: the quarter of the window with the least is their weaker half.
    fn noise_power(&self) -> f32 {
        let mut powers = [0.0f32; MOST];
        for (power, value) in powers.iter_mut().zip(self.values(0, self.window)) {
            *power = value.abs() * value.abs();
        }
        let powers = &mut powers[..self.window];
        powers.sort_unstable_by(f32::total_cmp);
        let weakest = &powers[..self.window / 4];
        weakest.iter().sum::<f32>() / weakest.len() as f32 / WEAKER_HALF
    }

    /// By how much the carrier is above its nominal frequency, Hz.
    fn offset_hz(&self) -> f32 {
        let mut sum = Phasor::default();
        let later = self.values(1, self.window);
        for (before, value) in self.values(0, self.window - 1).zip(later) {
            let turned = value.times_conj(before);
            sum.re += turned.re;
            sum.im += turned.im;
        }
        libm::atan2f(sum.im, sum.re) / TAU * self.downmix.envelope_hz()
    }
}

/// The share of the time that a keyed carrier is on, from the amplitude of the fundamental over the mean: that is
/// 2 sin(πd) / πd, which falls from 2 to 0. The mean and the fundamental pass the filter whole, the edges do not.
fn on_share(fundamental: f32) -> f32 {
    let (mut low, mut high) = (0.05, 0.95);
    for _ in 0..16 {
        let middle = 0.5 * (low + high);
        match 2.0 * libm::sinf(PI * middle) / (PI * middle) > fundamental {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

fn hann(length: usize) -> impl Iterator<Item = f32> {
    let turn = Phasor::at(TAU / length as f32);
    let mut at = Phasor::at(PI / length as f32);
    (0..length).map(move |_| {
        let value = 0.5 - 0.5 * at.re;
        at = at.times(turn);
        value
    })
}

fn wrapped(angle: f32) -> f32 {
    angle - TAU * libm::roundf(angle / TAU)
}
