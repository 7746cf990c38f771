//! Speed code in the ATP antenna: carrier, code rate and level, steady or drifting.

use protocol::SCAN;

use super::ranges::U16_MAX;

/// Highest code rate, Hz: the catalogue's range, just below what 0.01 Hz in 16 bits can say.
pub const MAX_RATE_HZ: f64 = 655.0;

/// The signal in the antenna; all 0 = none.
#[derive(Debug, Default)]
pub struct Antenna {
    carrier_hz: f64,
    rate_hz: f64,
    level_mv: f64,
    rate_hz_per_s: f64,
    level_mv_per_s: f64,
}

impl Antenna {
    /// Puts a steady signal into the antenna.
    pub fn set(&mut self, carrier_hz: f64, rate_hz: f64, level_mv: f64) {
        *self = Self {
            carrier_hz,
            rate_hz,
            level_mv,
            ..Self::default()
        };
    }

    /// Lets rate and level drift from where they are.
    pub fn drift(&mut self, rate_hz_per_s: f64, level_mv_per_s: f64) {
        self.rate_hz_per_s = rate_hz_per_s;
        self.level_mv_per_s = level_mv_per_s;
    }

    /// Takes the signal away.
    pub fn off(&mut self) {
        *self = Self::default();
    }

    /// One scan of drift.
    pub fn step(&mut self) {
        let seconds = SCAN.as_secs();
        self.rate_hz = (self.rate_hz + self.rate_hz_per_s * seconds).clamp(0.0, MAX_RATE_HZ);
        self.level_mv = (self.level_mv + self.level_mv_per_s * seconds).clamp(0.0, U16_MAX);
    }

    /// Carrier as sent, Hz.
    pub fn carrier_hz(&self) -> u16 {
        self.carrier_hz.round() as u16
    }

    /// Code rate as sent, 0.01 Hz.
    pub fn rate_chz(&self) -> u16 {
        (self.rate_hz * 100.0).round() as u16
    }

    /// Level as sent, mV.
    pub fn level_mv(&self) -> u16 {
        self.level_mv.round() as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drift_is_linear_and_stops_at_nothing() {
        let mut antenna = Antenna::default();
        antenna.set(3000.0, 15.0, 500.0);
        antenna.drift(-0.5, -100.0);
        for _ in 0..200 {
            antenna.step();
        }
        assert_eq!((antenna.rate_chz(), antenna.level_mv()), (1400, 300));
        for _ in 0..10_000 {
            antenna.step();
        }
        assert_eq!((antenna.rate_chz(), antenna.level_mv()), (0, 0));
        assert_eq!(antenna.carrier_hz(), 3000);
        antenna.off();
        assert_eq!(antenna.carrier_hz(), 0);
    }
}
