//! Station stop by distance [S2 §3.2]: a square root with constant brake rate, then a line.

use protocol::config::PssConfig;

/// The curve. Both parts meet in value and slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopCurve {
    rate_mps2: f64,
    offset_m: f64,
    slope_per_s: f64,
    /// Where the parts meet, m before the stop point.
    join_m: f64,
    /// Speed at the stop point, m/s.
    stop_mps: f64,
}

impl StopCurve {
    /// The curve of a configuration.
    pub fn new(config: &PssConfig) -> Self {
        let (rate, slope) = (config.brake_rate_mps2, config.slope_per_s);
        Self {
            rate_mps2: rate,
            offset_m: config.offset_m,
            slope_per_s: slope,
            join_m: config.offset_m + rate / (2.0 * slope * slope),
            stop_mps: rate / (2.0 * slope) - slope * config.offset_m,
        }
    }

    /// Target speed, m/s, and its rate of change when followed, m/s².
    pub fn at(&self, to_stop_m: f64) -> (f64, f64) {
        if to_stop_m > self.join_m {
            let speed = libm::sqrt(2.0 * self.rate_mps2 * (to_stop_m - self.offset_m));
            (speed, -self.rate_mps2)
        } else {
            let speed = (self.slope_per_s * to_stop_m + self.stop_mps).max(0.0);
            (speed, -self.slope_per_s * speed)
        }
    }
}
