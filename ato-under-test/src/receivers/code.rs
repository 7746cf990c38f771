//! The receiver of ATP speed codes: a carrier that is keyed on and off at the code rate, or shifted up and down at it
//! (`shifted.rs`).
//!
//! The last values of the envelope, a window, are brought to the phase of the carrier, so that two codes at once add up and
//! noise has no mean. They are judged as a whole and in three halves that overlap: a rate counts only if each has it, with
//! one phase, so that neither noise nor a change of the code is taken for a code that was not sent.

use core::f32::consts::{PI, SQRT_2, TAU};

use protocol::config::UnitConfig;

use super::downmix::{Downmix, Phasor};
use super::window::{mean_of, on_share, power_around};

/// Rate of the envelope, about, Hz: fast enough for the third harmonic of the fastest code rate; and its pass band.
const ENVELOPE_HZ: f32 = 600.0;
const PASS_HZ: f32 = 160.0;
/// Both are those of codes from this rate on, Hz; a table whose fastest code is slower has as much less.
const FAST_HZ: f32 = 20.0;
/// Most values of a window.
pub(super) const MOST: usize = 400;
/// Share of the time until a code is decoded that the window holds. In the rest the code must stay what it is: longer than
/// a jump of the phase takes from the window's one end to where its other end no longer feels it.
const SHARE_OF_DETECTION: f32 = 0.75;
/// Shortest and longest window, s.
const SHORTEST_S: f32 = 0.2;
const LONGEST_S: f32 = 0.62;
/// Periods of the slowest code that a window holds at least, if that is within this share of the time of detection.
const PERIODS: f32 = 1.98;
const SHARE_OF_SLOW: f32 = 0.88;
/// Of noise alone, the weaker half of all values has this share of the mean power.
const WEAKER_HALF: f32 = 1.0 - core::f32::consts::LN_2;
/// Least share of the keying's power that the rate's fundamental has, of the window and of each half. A square wave has
/// 0.81; two codes spliced in the window, or noise, have less.
pub(super) const LEAST_SHARE: f32 = 0.55;
/// Share of a square wave's power at its fundamental, and how near to it a code must come: less is another shape, as of a
/// jump of the phase.
pub(super) const OF_SQUARE_WAVE: f32 = 8.0 / (PI * PI);
const NEARLY: f32 = 0.88;
/// Most power in quadrature of one code alone, over that of the keying.
const BESIDE: f32 = 0.12;
/// With less noise than this, over the power of the keying, each break of a rate shows.
const CLEAR: f32 = 0.04;
/// Least depth of keying: amplitude of the fundamental over the mean. On and off by half has 1.27.
const LEAST_DEPTH: f32 = 0.6;
/// Share of the time that a carrier of a code is on.
const SHARES_ON: core::ops::RangeInclusive<f32> = 0.25..=0.75;
/// Most depth, beside a weaker code in opposite phase; more is no carrier between its sidebands.
const MOST_DEPTH: f32 = 2.7;
/// An envelope with less depth than this is a carrier without a code.
const FLAT: f32 = 0.15;
/// What is received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reception {
    /// Carrier, Hz.
    pub carrier_hz: f32,
    /// Weakest level that is heard, mV rms.
    pub level_min_mv: f32,
    /// By how much a second code must be weaker, dB.
    pub apart_db: f32,
    /// Time for which a code must be there until it is decoded, s.
    pub detect_s: f32,
    /// By how much the code shifts the carrier, Hz; 0 = it keys it.
    pub shift_hz: f32,
    /// Slowest and fastest rate of the table, Hz.
    pub rates_hz: (f32, f32),
}

impl Reception {
    /// A carrier as a unit of this configuration receives it.
    pub fn of(config: &UnitConfig, carrier_hz: f64) -> Self {
        let receiver = &config.receiver;
        let rates = config.codes.iter().map(|code| code.rate_hz as f32);
        Self {
            carrier_hz: carrier_hz as f32,
            level_min_mv: receiver.level_min_mv as f32,
            apart_db: receiver.apart_db as f32,
            detect_s: receiver.detect_ms as f32 / 1000.0,
            shift_hz: receiver.shift_hz as f32,
            rates_hz: rates.fold((f32::MAX, 0.0), |(low, high), rate| {
                (low.min(rate), high.max(rate))
            }),
        }
    }

    /// Longest window, s: with enough periods of the slowest code.
    fn longest_s(&self) -> f32 {
        LONGEST_S.max(PERIODS / self.rates_hz.0)
    }

    /// Shortest time of detection in which the window holds the slowest code, s.
    pub fn least_detect_s(&self) -> f32 {
        PERIODS / self.rates_hz.0 / SHARE_OF_SLOW
    }
}

/// What the receiver makes of its window.
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
    /// Level over the noise within 160 Hz of the carrier, dB; of a carrier without a code it is not known.
    pub snr_db: Option<f32>,
    /// The newest half of the window has the code as strong as the oldest.
    pub goes_on: bool,
    /// There is too little noise to hide a break.
    pub is_clear: bool,
    /// Of a slow code: time that the window shows it to be there already, s, and time for which it may be over.
    pub spell_s: Option<[f32; 2]>,
}

/// Receives the codes of one carrier.
#[derive(Clone, Debug)]
pub struct CodeReceiver {
    pub(super) downmix: Downmix,
    pub(super) reception: Reception,
    /// Ratio of the powers of two codes of which the stronger counts.
    pub(super) apart: f32,
    /// Share of the steps of rates that fit a usual window.
    pub(super) finer: f32,
    pub(super) line: [Phasor; MOST],
    pub(super) window: usize,
    pub(super) place: usize,
    pub(super) filled: usize,
}

/// The window on the carrier's phase.
pub(super) struct OnCarrier {
    pub(super) values: [f32; MOST],
    /// Power of the noise on either side of that phase, mV²: the least that quadrature and pauses tell, since a jump of the
    /// carrier's phase is in the quadrature, too.
    pub(super) noise: f32,
    /// Power in quadrature beyond that noise, mV²: of a jump of the carrier's phase, or of another code.
    pub(super) beside: f32,
    pub(super) offset_hz: f32,
}

/// A rate in a part of the window.
#[derive(Clone, Copy)]
pub(super) struct Tone {
    pub(super) rate_hz: f32,
    pub(super) amplitude: f32,
    pub(super) angle: f32,
}

impl Tone {
    pub(super) fn power(self) -> f32 {
        self.amplitude * self.amplitude / 2.0
    }
}

impl CodeReceiver {
    /// For samples of this rate, Hz.
    pub fn new(reception: Reception, sample_hz: f32) -> Self {
        let slow = (reception.rates_hz.1 / FAST_HZ).min(1.0);
        let (envelope_hz, pass_hz) = (slow * ENVELOPE_HZ, slow * PASS_HZ);
        let downmix = Downmix::new(reception.carrier_hz, sample_hz, envelope_hz, pass_hz);
        let longest_s = reception.longest_s();
        let slowest_s = (PERIODS / reception.rates_hz.0).min(SHARE_OF_SLOW * reception.detect_s);
        let window_s = (SHARE_OF_DETECTION * reception.detect_s).clamp(SHORTEST_S, longest_s);
        let window_s = window_s.max(slowest_s);
        let window = libm::roundf(window_s * downmix.envelope_hz) as usize / 4 * 4;
        Self {
            downmix,
            // A longer window tells rates apart that are nearer to each other.
            finer: LONGEST_S / longest_s,
            apart: libm::powf(10.0, reception.apart_db / 10.0),
            reception,
            line: [Phasor::default(); MOST],
            window: window.min(MOST),
            place: 0,
            filled: 0,
        }
    }

    /// Time that the window holds, s: whoever hears a code has had it for about so long.
    pub fn window_s(&self) -> f32 {
        self.window as f32 / self.downmix.envelope_hz
    }

    /// Takes a sample, mV.
    pub fn take(&mut self, sample_mv: f32) {
        if let Some(value) = self.downmix.take(sample_mv) {
            self.line[self.place] = value;
            self.place = (self.place + 1) % self.window;
            self.filled = (self.filled + 1).min(self.window);
        }
    }

    /// What the window holds, if it is one code, at one of these rates or another, or a carrier without one.
    pub fn heard(&self, rates_hz: &[f32]) -> Option<Heard> {
        if self.filled < self.window || self.loudest() < self.reception.level_min_mv {
            return None;
        }
        if self.reception.shift_hz > 0.0 {
            return self.heard_shifted(rates_hz);
        }
        let on = self.on_carrier();
        let mean = mean_of(&on.values[..self.window], |value| value);
        let power = power_around(&on.values[..self.window], mean);
        let flat = libm::sqrtf(2.0 * (power - on.noise).max(0.0)) < FLAT * mean;
        let heard = match flat && on.beside < BESIDE * mean * mean {
            true => Heard {
                carrier_hz: self.reception.carrier_hz + on.offset_hz,
                rate_hz: 0.0,
                level_mv: mean / SQRT_2,
                validity: 1.0,
                snr_db: None,
                goes_on: true,
                is_clear: true,
                // The window's ends count for little.
                spell_s: self.is_slow().then(|| [NEARLY * self.window_s(), 0.0]),
            },
            false => self.keyed(&on, (mean, power), rates_hz)?,
        };
        (heard.level_mv >= self.reception.level_min_mv).then_some(heard)
    }

    /// The window holds codes that need a long one.
    fn is_slow(&self) -> bool {
        self.finer < 1.0
    }

    /// The code of a carrier that is not flat, with its mean and its power around that.
    fn keyed(&self, on: &OnCarrier, (mean, power): (f32, f32), rates_hz: &[f32]) -> Option<Heard> {
        let (tone, rate_hz, [is_whole, goes_on]) = self.rate(on, mean, rates_hz)?;
        let share = tone.power() / power;
        if share < LEAST_SHARE || tone.amplitude < LEAST_DEPTH * mean {
            return None;
        }
        let keying = power - on.noise;
        let is_clear = on.noise < CLEAR * keying;
        let code_alone = tone.power() >= NEARLY * OF_SQUARE_WAVE * keying
            && on.beside < BESIDE * keying
            && (is_whole || !is_clear);
        let share_on = on_share(tone.amplitude / mean);
        let spell_s = match self.is_slow() {
            true => Some(self.spell_s(on, (tone, rate_hz), share_on)?),
            false => None,
        };
        let signal = match SHARES_ON.contains(&share_on) {
            true if code_alone => {
                let square = mean_of(&on.values[..self.window], |value| value * value);
                (square - on.noise).max(0.0) / share_on
            }
            // The mean is of both codes: of one that is on for half of the time the fundamental tells.
            _ if is_whole
                && tone.amplitude < MOST_DEPTH * mean
                && self.is_second_code(on, mean, tone, power, rates_hz) =>
            {
                tone.amplitude * tone.amplitude * (PI / 2.0) * (PI / 2.0)
            }
            _ => return None,
        };
        Some(Heard {
            carrier_hz: self.reception.carrier_hz + on.offset_hz,
            rate_hz,
            level_mv: libm::sqrtf(signal / 2.0),
            validity: share.min(1.0),
            snr_db: Some(10.0 * libm::log10f(signal / (2.0 * on.noise).max(1e-6))),
            goes_on,
            is_clear,
            spell_s,
        })
    }

    /// Level of a carrier that is on for half of the window, mV rms.
    fn loudest(&self) -> f32 {
        let values = &self.line[..self.window];
        let mean = values.iter().map(|value| value.power()).sum::<f32>() / self.window as f32;
        // A carrier that is keyed is on for half of the time.
        libm::sqrtf(mean)
    }

    /// Values of the window from the oldest on.
    pub(super) fn values(&self) -> impl Iterator<Item = Phasor> + '_ {
        let (late, early) = self.line[..self.window].split_at(self.place);
        early.iter().chain(late).copied()
    }

    /// Brings the window to the frequency and the phase of its carrier.
    pub(super) fn on_carrier(&self) -> OnCarrier {
        let value_hz = self.downmix.envelope_hz;
        let mut turned = Phasor::default();
        for (before, value) in self.values().zip(self.values().skip(1)) {
            turned = turned.plus(value.times_conj(before));
        }
        let coarse = turned.angle();
        // What is left of the offset is seen from one half of the window to the other.
        let mut halves = [Phasor::default(); 2];
        let (mut at, turn) = (Phasor::at(0.0), Phasor::at(-coarse));
        for (place, value) in self.values().enumerate() {
            let half = &mut halves[place * 2 / self.window];
            *half = half.plus(value.times(at));
            at = at.times(turn);
        }
        let half = (self.window / 2) as f32;
        let fine = halves[1].times_conj(halves[0]).angle() / half;
        let turn = Phasor::at(-coarse - fine);
        // The phase in the middle of the window, where both halves meet.
        let middle = halves[0].angle() - fine * (half - 1.0) / 2.0;
        let mut at = Phasor::at(-middle);
        let mut on = OnCarrier {
            values: [0.0; MOST],
            noise: 0.0,
            beside: 0.0,
            offset_hz: (coarse + fine) / TAU * value_hz,
        };
        for (slot, value) in on.values.iter_mut().zip(self.values()) {
            let value = value.times(at);
            *slot = value.re;
            on.noise += value.im * value.im;
            at = at.times(turn);
        }
        let quadrature = on.noise / self.window as f32;
        on.noise = quadrature.min(self.noise_of_pauses());
        on.beside = quadrature - on.noise;
        on
    }

    /// Power of what the pauses hold, half of it on either side of a phase, mV²: the quarter of the window with the least is
    /// their weaker half.
    fn noise_of_pauses(&self) -> f32 {
        let mut powers = [0.0f32; MOST];
        for (power, value) in powers.iter_mut().zip(&self.line[..self.window]) {
            *power = value.power();
        }
        let quarter = self.window / 4;
        let powers = &mut powers[..self.window];
        let (weakest, _, _) = powers.select_nth_unstable_by(quarter, f32::total_cmp);
        weakest.iter().sum::<f32>() / quarter as f32 / WEAKER_HALF / 2.0
    }
}
