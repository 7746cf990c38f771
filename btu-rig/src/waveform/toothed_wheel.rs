//! A toothed wheel before a speed sensor, as it may be worn or mounted: teeth of any width, one that is missing, lines
//! that are not a quarter of a period apart.

/// Time in which a line goes from low to high, samples.
const RISE: f64 = 2.5;

/// The wheel and how the sensor sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Teeth {
    /// Teeth of a turn.
    pub per_turn: u32,
    /// One tooth is missing.
    pub lacks_one: bool,
    /// How far line B is behind line A, as a share of a period; negative when the wheel turns backward.
    pub phase: f64,
    /// Share of a period for which a line is high.
    pub duty: f64,
}

/// The samples of both lines at a constant speed, mV, without end.
#[derive(Clone, Debug)]
pub struct ToothedWheel {
    teeth: Teeth,
    /// Teeth passed so far, and (`step`) teeth that pass in each sample.
    at: f64,
    step: f64,
    amplitude_mv: f64,
}

impl ToothedWheel {
    /// A wheel with `per_s` teeth a second; a line is `amplitude_mv` above or below the middle.
    pub fn new(teeth: Teeth, per_s: f64, amplitude_mv: f64, sample_hz: f64) -> Self {
        Self {
            teeth,
            at: 0.5,
            step: per_s / sample_hz,
            amplitude_mv,
        }
    }

    fn line_mv(&self, at: f64) -> f64 {
        let Teeth { per_turn, duty, .. } = self.teeth;
        let is_gap = self.teeth.lacks_one && at.floor().rem_euclid(f64::from(per_turn)) == 1.0;
        let within = at.rem_euclid(1.0);
        let way = |from: f64| ((within - from) / self.step / RISE).min(1.0);
        let high = match within < duty {
            _ if is_gap => 0.0,
            true => way(0.0),
            false => 1.0 - way(duty),
        };
        self.amplitude_mv * (2.0 * high - 1.0)
    }
}

impl Iterator for ToothedWheel {
    type Item = [f64; 2];

    fn next(&mut self) -> Option<[f64; 2]> {
        let lines = [0.0, self.teeth.phase].map(|behind| self.line_mv(self.at - behind));
        self.at = (self.at + self.step) % f64::from(self.teeth.per_turn);
        Some(lines)
    }
}
