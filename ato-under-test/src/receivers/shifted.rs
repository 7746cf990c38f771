//! Codes that shift their carrier up and down at the code rate: its frequency over time is judged as the envelope of a keyed
//! carrier is.

use core::f32::consts::{PI, TAU};

use super::code::{CodeReceiver, Heard, LEAST_SHARE, MOST, OnCarrier};
use super::downmix::Phasor;
use super::window::{mean_of, power_around};

/// Values over which a turn of the phase is measured: over fewer noise turns it, over more a fast code is lost.
const TURNS_OVER: usize = 6;
/// Most variation of the level, as a share of its square: another signal beats with the carrier, a keyed one has pauses.
const MOST_VARIATION: f32 = 0.2;
/// With less noise than this, over the power of the carrier, each break of a rate shows.
const CLEAR: f32 = 0.02;
/// Amplitude of the rate over that of a square wave of the whole shift, within which a signal is a code.
const DEPTH: core::ops::RangeInclusive<f32> = 0.7..=1.3;
/// A rate with fewer periods than this in the window is told by its edges.
const SLOW: f32 = 1.5;
/// A carrier whose frequency varies by less than this share of the shift has no code.
const FLAT: f32 = 0.25;

impl CodeReceiver {
    /// What the window holds, if it is one code that shifts its carrier, or a carrier without one.
    pub(super) fn heard_shifted(&self, rates_hz: &[f32]) -> Option<Heard> {
        let shift_hz = self.reception.shift_hz;
        let square = self.values().map(Phasor::power).sum::<f32>() / self.window as f32;
        let mean = self.values().map(Phasor::abs).sum::<f32>() / self.window as f32;
        // Half of the noise is along the carrier and varies the level.
        let varies = (square - mean * mean).max(0.0);
        let noise = 2.0 * varies;
        let level_mv = libm::sqrtf((square - noise).max(0.0) / 2.0);
        if level_mv < self.reception.level_min_mv || varies > MOST_VARIATION * square {
            return None;
        }
        let on = self.frequency();
        let values = &on.values[..self.window];
        let mean_hz = mean_of(values, |value| value);
        let power = power_around(values, mean_hz);
        let carrier_hz = self.reception.carrier_hz + on.offset_hz + mean_hz;
        let snr_db = Some(10.0 * libm::log10f(square / noise.max(1e-6)));
        let is_clear = noise < CLEAR * square;
        let heard = |rate_hz, validity, snr_db, goes_on| Heard {
            carrier_hz,
            rate_hz,
            level_mv,
            validity,
            snr_db,
            goes_on,
            is_clear,
            spell_s: None,
        };
        if libm::sqrtf(power) < FLAT * shift_hz {
            return Some(heard(0.0, 1.0, None, true));
        }
        let read = self.rate(&on, mean_hz, rates_hz);
        let code = read.and_then(|(tone, rate_hz, [is_whole, goes_on])| {
            let over_s = TURNS_OVER as f32 / self.downmix.envelope_hz;
            let angle = PI * rate_hz * over_s;
            let depth = tone.amplitude / (4.0 / PI * shift_hz * libm::sinf(angle) / angle);
            let share = tone.power() / power;
            let is_code = is_whole && share >= LEAST_SHARE && DEPTH.contains(&depth);
            is_code.then(|| heard(rate_hz, share.min(1.0), snr_db, goes_on))
        });
        code.or_else(|| {
            let rate_hz = self.slow_rate(values).filter(|_| is_clear)?;
            Some(heard(rate_hz, 0.0, snr_db, true))
        })
    }

    /// A rate that is too slow for the window, and so belongs to no code: from the times between its edges.
    fn slow_rate(&self, values: &[f32]) -> Option<f32> {
        let (low, high) = (values.iter()).fold((f32::MAX, f32::MIN), |(low, high), value| {
            (low.min(*value), high.max(*value))
        });
        let half = (high - low) / 2.0;
        if !DEPTH.contains(&(half / self.reception.shift_hz)) {
            return None;
        }
        let (mut is_up, mut edges) = (None, [0, 0]);
        for (place, value) in values.iter().enumerate() {
            let off = value - low - half;
            if off.abs() > half / 2.0
                && is_up
                    .replace(off > 0.0)
                    .is_some_and(|was| was != (off > 0.0))
            {
                edges = [edges[1], place];
            }
        }
        let [from, to] = edges;
        let rate_hz = self.downmix.envelope_hz / 2.0 / (to - from) as f32;
        (from > 0 && rate_hz < SLOW / self.window_s()).then_some(rate_hz)
    }

    /// The frequency of the carrier over the window, Hz from its mean.
    fn frequency(&self) -> OnCarrier {
        let value_hz = self.downmix.envelope_hz;
        let turned = |over: usize| {
            let pairs = self.values().zip(self.values().skip(over));
            pairs.map(|(before, value)| value.times_conj(before))
        };
        let coarse = turned(1).fold(Phasor::default(), Phasor::plus).angle();
        let over = TURNS_OVER as f32;
        let back = Phasor::at(-coarse * over);
        let mut on = OnCarrier {
            values: [0.0; MOST],
            noise: 0.0,
            beside: 0.0,
            offset_hz: coarse / TAU * value_hz,
        };
        for (slot, turn) in on.values[TURNS_OVER..].iter_mut().zip(turned(TURNS_OVER)) {
            *slot = turn.times(back).angle() / TAU / over * value_hz;
        }
        let first = on.values[TURNS_OVER];
        on.values[..TURNS_OVER].fill(first);
        on
    }
}
