//! The receiver of ATP speed codes: a carrier that is keyed on and off at the code rate, or shifted up and down at it
//! (`shifted.rs`).
//!
//! The window, the last values of the envelope, is turned to the phase of the carrier: two codes at once then add up,
//! and noise has a mean of zero. The window is judged as a whole and in three halves that overlap: a rate counts only
//! if each has it, with one phase, so that neither noise nor a change of the code passes for a code.

use core::f32::consts::{PI, SQRT_2, TAU};

use protocol::config::UnitConfig;

use super::downmix::{Downmix, Phasor};
use super::window::{mean_of, on_share, power_around};

/// Nominal rate of the envelope, Hz, fast enough for the third harmonic of the fastest code; and its pass band, Hz.
const ENVELOPE_HZ: f32 = 600.0;
const PASS_HZ: f32 = 160.0;
/// Code rate from which on these two hold, Hz; for a table whose fastest code is slower they are lower in proportion.
const FAST_HZ: f32 = 20.0;
/// Most values of a window.
pub(super) const MOST: usize = 400;
/// Share of the time until a code is decoded that the window holds. In the rest the code must stay what it is: longer than
/// a jump of the phase takes from the window's one end to where its other end no longer feels it.
const SHARE_OF_DETECTION: f32 = 0.75;
/// Shortest and longest window, s.
const SHORTEST_S: f32 = 0.2;
const LONGEST_S: f32 = 0.62;
/// A window holds at least this many periods of the slowest code, if they fit into this share of the time of detection.
const PERIODS: f32 = 1.98;
const SHARE_OF_SLOW: f32 = 0.88;
/// In noise alone, the weaker half of the values has this mean power, over the mean power of all values.
const WEAKER_HALF: f32 = 1.0 - core::f32::consts::LN_2;
/// Least share of the keying's power at the fundamental of the rate, over the whole window. A square wave has 0.81; two
/// codes spliced in the window, or noise, have less.
pub(super) const LEAST_SHARE: f32 = 0.55;
/// Share of a square wave's power at its fundamental, and how near to it a code must come: less is another shape, as of a
/// jump of the phase.
pub(super) const OF_SQUARE_WAVE: f32 = 8.0 / (PI * PI);
const NEARLY: f32 = 0.88;
/// Greatest power in quadrature to the carrier that one code alone has, over the power of its keying.
const BESIDE: f32 = 0.12;
/// Below this noise, over the power of the keying, each break of a rate shows.
const CLEAR: f32 = 0.04;
/// Least depth of keying: amplitude of the fundamental over the mean. A carrier on for half of the time has 1.27.
const LEAST_DEPTH: f32 = 0.6;
/// Shares of the time for which the carrier of a code may be on.
const SHARES_ON: core::ops::RangeInclusive<f32> = 0.25..=0.75;
/// Greatest depth: a code beside a weaker one in opposite phase. More is two sidebands without a carrier between them.
const MOST_DEPTH: f32 = 2.7;
/// An envelope with less depth than this is a carrier without a code.
const FLAT: f32 = 0.15;
/// What a receiver has to receive: its carrier, levels and code rates.
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
    /// By how much the code shifts the carrier, Hz; 0 = the code keys the carrier on and off.
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

/// Code that the receiver finds in its window, or carrier without a code.
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
    /// Level over the noise within 160 Hz of the carrier, dB; `None` for a carrier without a code.
    pub snr_db: Option<f32>,
    /// The newest half of the window has the code as strong as the oldest.
    pub goes_on: bool,
    /// There is too little noise to hide a break of the code.
    pub is_clear: bool,
    /// Of a slow code: time for which it has been there already, s, and time for which it may be over.
    pub spell_s: Option<[f32; 2]>,
}

/// Receives the codes of one carrier.
#[derive(Clone, Debug)]
pub struct CodeReceiver {
    pub(super) downmix: Downmix,
    pub(super) reception: Reception,
    /// Least ratio of the powers of two codes at which the stronger counts.
    pub(super) apart: f32,
    /// Step between the rates that are searched, over the step for a window of usual length; 1 or less.
    pub(super) finer: f32,
    pub(super) line: [Phasor; MOST],
    pub(super) window: usize,
    pub(super) place: usize,
    pub(super) filled: usize,
}

/// The window, turned to the frequency and phase of its carrier.
pub(super) struct OnCarrier {
    pub(super) values: [f32; MOST],
    /// Power of the noise in one phase, along or across the carrier, mV²: the lesser of what quadrature and pauses
    /// show, since a jump of the carrier's phase adds to the quadrature, too.
    pub(super) noise: f32,
    /// Power in quadrature beyond the noise, mV²: of a jump of the carrier's phase, or of another code.
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
    /// Receiver of samples at this rate, Hz.
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

    /// Length of the window, s: a code that is heard has been there for about so long.
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

    /// The table has codes so slow that the window is longer than usual.
    fn is_slow(&self) -> bool {
        self.finer < 1.0
    }

    /// The code of a keyed carrier; `mean` is that of the envelope, `power` is the power around this mean.
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
            // The mean is of both codes: the fundamental of the stronger one, on for half of the time, tells its level.
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
        // The rest of the carrier's offset turns the phase from one half of the window to the other.
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

    /// Power of the noise in the pauses, in one phase, mV²: half of the power in both. The weakest quarter of the
    /// window is the weaker half of the pauses.
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
