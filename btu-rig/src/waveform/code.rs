//! An ATP speed code: a carrier that is keyed on and off, or shifted up and down, at the code rate.

use super::{Phase, cosine};

/// Rise and fall of the keying, 10 to 90 %, as a share of the time that a keyed carrier is on.
const EDGE: f64 = 0.05;

/// The samples of a code, mV, without end.
#[derive(Clone, Debug)]
pub struct CodeWave {
    carrier: Phase,
    carrier_step: f64,
    keying: Phase,
    keying_step: f64,
    /// Cycles per sample by which the carrier is shifted up and down; 0 = the carrier is keyed.
    shift_step: f64,
    amplitude_mv: f64,
}

impl CodeWave {
    /// A carrier of this level, mV rms while it is on, keyed at `rate_hz`; at a rate of 0 the carrier stays on.
    pub fn new(carrier_hz: f64, rate_hz: f64, level_mv: f64, sample_hz: f64) -> Self {
        Self {
            carrier: Phase::default(),
            carrier_step: carrier_hz / sample_hz,
            keying: Phase::default(),
            keying_step: rate_hz / sample_hz,
            shift_step: 0.0,
            amplitude_mv: level_mv * std::f64::consts::SQRT_2,
        }
    }

    /// Shifts the carrier by `shift_hz` up and down at the code rate, with continuous phase; 0 = the carrier is keyed.
    #[must_use]
    pub fn shifted(self, shift_hz: f64, sample_hz: f64) -> Self {
        Self {
            shift_step: shift_hz / sample_hz,
            ..self
        }
    }

    /// Sets another carrier, rate and level from now on, without a jump of either phase; a code that was not there
    /// begins with its carrier on.
    pub fn set(&mut self, carrier_hz: f64, rate_hz: f64, level_mv: f64, sample_hz: f64) {
        if self.amplitude_mv == 0.0 {
            self.keying = Phase::default();
        }
        self.carrier_step = carrier_hz / sample_hz;
        self.keying_step = rate_hz / sample_hz;
        self.amplitude_mv = level_mv * std::f64::consts::SQRT_2;
    }

    /// Share of the carrier's amplitude at this phase of the keying: on for half of the time, with raised-cosine edges.
    fn keyed(cycles: f64) -> f64 {
        let edge = |from: f64| 0.5 - 0.5 * cosine(0.5 * (from / EDGE).clamp(0.0, 1.0));
        match cycles {
            on if on < 0.5 => edge(2.0 * on),
            off => 1.0 - edge(2.0 * off - 1.0),
        }
    }
}

impl Iterator for CodeWave {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        if self.amplitude_mv == 0.0 {
            return Some(0.0);
        }
        let (on, shift) = match self.keying_step > 0.0 {
            true if self.shift_step > 0.0 => {
                let up = self.keying.step(self.keying_step) < 0.5;
                (
                    1.0,
                    if up {
                        self.shift_step
                    } else {
                        -self.shift_step
                    },
                )
            }
            true => (Self::keyed(self.keying.step(self.keying_step)), 0.0),
            false => (1.0, 0.0),
        };
        let carrier = self.carrier.step(self.carrier_step + shift);
        Some(self.amplitude_mv * on * cosine(carrier))
    }
}
