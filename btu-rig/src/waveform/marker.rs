//! A marker in the antenna: its tone, which swells and fades as the train passes over it.

use super::{Phase, cosine};

/// Share of its strongest level below which a marker counts as not heard.
const NOTHING: f64 = 1e-4;

/// The samples of the tone of one marker, mV.
#[derive(Clone, Debug)]
pub struct MarkerWave {
    tone: Phase,
    step: f64,
    amplitude_mv: f64,
    reach_m: f64,
}

impl MarkerWave {
    /// A tone of this level, mV rms, over the middle of the marker; `reach_m` away from the middle 61 % of the level
    /// are left (a bell curve, 1σ).
    pub fn new(tone_hz: f64, level_mv: f64, reach_m: f64, sample_hz: f64) -> Self {
        Self {
            tone: Phase::default(),
            step: tone_hz / sample_hz,
            amplitude_mv: level_mv * std::f64::consts::SQRT_2,
            reach_m,
        }
    }

    /// The next sample, `away_m` from the middle of the marker; `None` where the marker is not heard any more.
    pub fn at(&mut self, away_m: f64) -> Option<f64> {
        let tone = cosine(self.tone.step(self.step));
        let bell = (-0.5 * (away_m / self.reach_m).powi(2)).exp();
        (bell > NOTHING).then_some(self.amplitude_mv * bell * tone)
    }

    /// Greatest distance from the marker's middle at which the marker is heard, m.
    pub fn heard_within_m(&self) -> f64 {
        self.reach_m * (-2.0 * NOTHING.ln()).sqrt()
    }
}
