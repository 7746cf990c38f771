//! The rate of a code: the strongest in the window, what it is exactly, and whether it goes on without a break. It is judged
//! in three halves that overlap.

use core::f32::consts::TAU;

use super::code::{CodeReceiver, OnCarrier, Tone};
use super::downmix::Phasor;
use super::window::{hann, mean_of, power_around, wrapped};

/// Least share of the keying's power that the rate's fundamental has in each half.
const LEAST_SHARE_OF_HALF: f32 = 0.4;
/// Least amplitude of a rate in the whole window and its middle half, over that in the other halves: less has a break.
const WHOLE: f32 = 0.88;
/// With fewer periods of a rate in half a window than this, its mean and its tone there are told apart in steps.
const FEW_PERIODS: f32 = 1.4;
const STEPS: usize = 3;
/// Greatest difference between the turns of the phase of a code that shifts, after and before the window's middle, rad.
const BENDS: f32 = 0.6;
/// Least amplitude of a rate in the newest half of the window over that in the oldest, and greatest deviation from the
/// rate of a code, Hz: beyond these the code has just ended.
const GOES_ON: f32 = 0.9;
const GOES_ON_HZ: f32 = 0.15;
/// Slowest and fastest rate that is looked for besides those of the table, and the step between them, Hz.
const RATES_HZ: (f32, f32) = (2.5, 42.0);
const RATE_STEP_HZ: f32 = 2.0;

impl CodeReceiver {
    /// The strongest rate of the table, or else of all others: its tone, what the rate is exactly, and whether it goes
    /// on through the window without a break, and at the window's end.
    pub(super) fn rate(
        &self,
        on: &OnCarrier,
        mean: f32,
        table_hz: &[f32],
    ) -> Option<(Tone, f32, [bool; 2])> {
        let strongest = |rates: &mut dyn Iterator<Item = f32>| {
            let tones = rates.map(|rate_hz| self.tone(on, mean, rate_hz, 0, self.window));
            tones.max_by(|a, b| a.amplitude.total_cmp(&b.amplitude))
        };
        let nearest = strongest(&mut table_hz.iter().copied())?;
        if let Some((offset_hz, lasts)) = self.offset_of_rate(on, nearest)
            && offset_hz.abs() < self.finer * RATE_STEP_HZ / 2.0
        {
            return Some((nearest, nearest.rate_hz + offset_hz, lasts));
        }
        let steps = ((RATES_HZ.1 - self.finer * RATES_HZ.0) / self.finer / RATE_STEP_HZ) as usize;
        let others = (0..steps).map(|step| self.finer * (RATES_HZ.0 + step as f32 * RATE_STEP_HZ));
        let nearest = strongest(&mut others.chain(table_hz.iter().copied()))?;
        let (offset_hz, lasts) = self.offset_of_rate(on, nearest)?;
        let rate_hz = nearest.rate_hz + offset_hz;
        let tone = self.tone(on, mean, rate_hz, 0, self.window);
        Some((tone, rate_hz, lasts))
    }

    /// By how much the code rate is above that of the tone, Hz, from how its phase goes on: judged in three halves that
    /// overlap, since a jump of the phase looks like another rate, and shows in the middle half.
    fn offset_of_rate(&self, on: &OnCarrier, whole: Tone) -> Option<(f32, [bool; 2])> {
        let half = self.window / 2;
        let half_s = half as f32 / self.downmix.envelope_hz;
        let few = whole.rate_hz * half_s < FEW_PERIODS;
        let steps = if few { STEPS } else { 0 };
        let mut halves = [whole; 3];
        for (place, of_half) in halves.iter_mut().enumerate() {
            let (from, to) = (place * half / 2, place * half / 2 + half);
            let mut mean = mean_of(&on.values[from..to], |value| value);
            *of_half = self.tone(on, mean, whole.rate_hz, from, to);
            for _ in 0..steps {
                mean = self.mean_beside(on, *of_half, from, to);
                *of_half = self.tone(on, mean, whole.rate_hz, from, to);
            }
            let power = power_around(&on.values[from..to], mean);
            if of_half.power() < LEAST_SHARE_OF_HALF * power {
                return None;
            }
        }
        // The phases are those at the middle of each half, against a clock of the nominal rate.
        let turned = wrapped(halves[2].angle - halves[0].angle);
        let offset_hz = turned / TAU / half_s;
        let least = whole.amplitude.min(halves[1].amplitude);
        let is_whole = least >= WHOLE * halves[0].amplitude.max(halves[2].amplitude);
        let as_strong = halves[2].amplitude >= GOES_ON * halves[0].amplitude;
        // Over the whole window, a rate that changes to its neighbour looks like the rate between them.
        let turns = [0, 1].map(|half| wrapped(halves[half + 1].angle - halves[half].angle));
        let bends = self.reception.shift_hz > 0.0 && wrapped(turns[1] - turns[0]).abs() > BENDS;
        let is_whole = is_whole && !bends;
        let goes_on = as_strong && offset_hz.abs() < self.finer * GOES_ON_HZ;
        Some((offset_hz, [is_whole, goes_on]))
    }

    /// Mean of a part of the window, the tone left out.
    fn mean_beside(&self, on: &OnCarrier, tone: Tone, from: usize, to: usize) -> f32 {
        let step = TAU * tone.rate_hz / self.downmix.envelope_hz;
        let (mut at, turn) = (
            Phasor::at(tone.angle + step * from as f32),
            Phasor::at(step),
        );
        let mut sum = 0.0;
        for (value, w) in on.values[from..to].iter().zip(hann(to - from)) {
            sum += (value - tone.amplitude * at.re) * w;
            at = at.times(turn);
        }
        sum * 2.0 / (to - from) as f32
    }

    /// Amplitude and phase of a rate in a part of the window.
    pub(super) fn tone(
        &self,
        on: &OnCarrier,
        mean: f32,
        rate_hz: f32,
        from: usize,
        to: usize,
    ) -> Tone {
        let step = TAU * rate_hz / self.downmix.envelope_hz;
        let (mut at, turn) = (Phasor::at(-step * from as f32), Phasor::at(-step));
        let mut sum = Phasor::default();
        for (value, w) in on.values[from..to].iter().zip(hann(to - from)) {
            let of = (value - mean) * w;
            sum.re += at.re * of;
            sum.im += at.im * of;
            at = at.times(turn);
        }
        Tone {
            rate_hz,
            amplitude: sum.abs() * 4.0 / (to - from) as f32,
            angle: sum.angle(),
        }
    }
}
