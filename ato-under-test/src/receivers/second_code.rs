//! Two codes at once on one carrier: which of both counts, and the weaker one, which a receiver without selection hears.

use core::f32::consts::{PI, SQRT_2, TAU};

use super::code::{CodeReceiver, Heard, OF_SQUARE_WAVE, OnCarrier, Tone};
use super::downmix::Phasor;
use super::window::{mean_of, power_around};

/// Least share of the power that the stronger code leaves unexplained, which a weaker code at another rate must have.
const EXPLAINED: f32 = 0.7;
/// Least share of the keying's power that is left for a second code, which a receiver without selection then hears.
const SECOND: f32 = 0.05;
/// Power of a code's fundamental over its power on the carrier.
const OF_CARRIER: f32 = 4.0 / (PI * PI);

impl CodeReceiver {
    /// The weaker of two codes at rates of the table, which a receiver hears that has lost its selection.
    pub fn weaker(&self, rates_hz: &[f32]) -> Option<Heard> {
        if self.filled < self.window || self.reception.shift_hz > 0.0 {
            return None;
        }
        let on = self.on_carrier();
        // Whatever the phase between both carriers, the part along the carrier or the envelope shows the weaker code.
        let mut envelope = OnCarrier { ..on };
        for (slot, value) in envelope.values.iter_mut().zip(self.values()) {
            *slot = value.abs();
        }
        let mean = |on: &OnCarrier| mean_of(&on.values[..self.window], |value| value);
        let tone = |on: &OnCarrier, rate| self.tone(on, mean(on), rate, 0, self.window);
        let strongest = |a: &Tone, b: &Tone| a.amplitude.total_cmp(&b.amplitude);
        let rates = || rates_hz.iter().copied();
        let one = rates().map(|rate| tone(&on, rate)).max_by(strongest)?;
        let apart_hz = 2.0 / self.window_s();
        let others = rates().filter(|rate| (rate - one.rate_hz).abs() > apart_hz);
        let carrier_hz = self.reception.carrier_hz + on.offset_hz;
        let power = power_around(&on.values[..self.window], mean(&on));
        let unexplained = power - on.noise - one.power() / OF_SQUARE_WAVE + on.beside;
        // The third harmonic of the slower one may lie near the faster one.
        let step = TAU / self.downmix.envelope_hz;
        let without_third = |of: &OnCarrier, rate: f32| {
            let (mut rest, slow) = (OnCarrier { ..*of }, tone(of, rate));
            for (place, value) in rest.values[..self.window].iter_mut().enumerate() {
                let angle = 3.0 * (slow.angle + step * rate * place as f32);
                *value += slow.amplitude / 3.0 * Phasor::at(angle).re;
            }
            rest
        };
        let rests = [&on, &envelope].map(|of| without_third(of, one.rate_hz));
        let others = others.flat_map(|rate| [tone(&rests[0], rate), tone(&rests[1], rate)]);
        let other = others.max_by(strongest)?;
        let slow_hz = one.rate_hz.min(other.rate_hz);
        let fast_hz = one.rate_hz.max(other.rate_hz);
        let both = [&on, &envelope].map(|of| {
            [
                tone(of, slow_hz),
                tone(&without_third(of, slow_hz), fast_hz),
            ]
        });
        let codes = [0, 1].map(|code| both[0][code].amplitude.max(both[1][code].amplitude));
        let weaker = both[0][usize::from(codes[1] < codes[0])];
        let level_mv = codes[0].min(codes[1]) * (PI / 2.0) / SQRT_2;
        let is_code = unexplained > SECOND * power && level_mv >= self.reception.level_min_mv;
        is_code.then_some(Heard {
            carrier_hz,
            rate_hz: weaker.rate_hz,
            level_mv,
            validity: (weaker.power() / power).min(1.0),
            snr_db: None,
            goes_on: true,
            is_clear: true,
            spell_s: None,
        })
    }

    /// Whether the rest of the window that a code does not explain is a weaker code at another rate.
    pub(super) fn is_second_code(
        &self,
        on: &OnCarrier,
        mean: f32,
        tone: Tone,
        power: f32,
        table_hz: &[f32],
    ) -> bool {
        // Two rates nearer than this are one peak.
        let apart_hz = 2.0 / self.window_s();
        let second = (table_hz.iter())
            .filter(|rate| (*rate - tone.rate_hz).abs() > apart_hz)
            .map(|rate_hz| self.tone(on, mean, *rate_hz, 0, self.window).power())
            .fold(0.0, f32::max);
        let unexplained = power - on.noise - tone.power() / OF_SQUARE_WAVE;
        // The second code's carrier may be in quadrature.
        (second + OF_CARRIER * on.beside) * self.apart <= tone.power()
            && second / OF_SQUARE_WAVE >= EXPLAINED * unexplained
    }
}
