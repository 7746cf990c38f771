//! White noise.

use protocol::Random;

use crate::random::normal;

/// Normally distributed samples, mV, without end.
#[derive(Clone, Debug)]
pub struct Noise {
    random: Random,
    deviation_mv: f64,
}

impl Noise {
    /// Noise with which a signal of `level_mv`, rms, has the ratio `snr_db` to the noise within
    /// `band_hz`.
    pub fn new(level_mv: f64, snr_db: f64, band_hz: f64, sample_hz: f64, seed: u64) -> Self {
        let in_band = level_mv * level_mv / 10f64.powf(snr_db / 10.0);
        Self {
            random: Random::new(seed),
            deviation_mv: (in_band * sample_hz / 2.0 / band_hz).sqrt(),
        }
    }
}

impl Iterator for Noise {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        Some(self.deviation_mv * normal(&mut self.random))
    }
}
