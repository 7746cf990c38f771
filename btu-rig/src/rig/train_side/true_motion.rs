//! True motion and forces of the train, independent of what tachometers and unit measure.

/// The train's true state at a scan's end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrueMotion {
    /// Speed, m/s, forward positive.
    pub speed_mps: f64,
    /// Acceleration at the scan's end, m/s², forward positive.
    pub accel_mps2: f64,
    /// Position in the section laid along the way, or on the rig's own scale when none is, m.
    pub position_m: f64,
    /// Distance to the section's stop point, m, negative past it; none without a section.
    pub to_stop_m: Option<f64>,
    /// Traction power at the wheels, W; this and the forces are 0 while generators turn the wheels.
    pub tractive_power_w: f64,
    pub traction_n: f64,
    pub electric_brake_n: f64,
    pub air_brake_n: f64,
    /// A car slips or slides.
    pub sliding: bool,
}

/// Scans the mean acceleration is taken over: 50 ms.
const ACCEL_SCANS: usize = 5;
/// Scans the jerk is taken over: 200 ms.
const JERK_SCANS: usize = 20;
/// Speeds of the past that mean acceleration and jerk need.
const HISTORY: usize = ACCEL_SCANS + JERK_SCANS + 1;

/// Speeds of the last scans.
#[derive(Clone, Debug)]
pub struct SpeedHistory {
    speeds_mps: [f64; HISTORY],
    newest: usize,
}

impl Default for SpeedHistory {
    /// History of a train at rest for long.
    fn default() -> Self {
        Self {
            speeds_mps: [0.0; HISTORY],
            newest: 0,
        }
    }
}

impl SpeedHistory {
    /// Adds the speed at a scan's end, m/s, forward positive.
    pub fn push(&mut self, speed_mps: f64) {
        self.newest = (self.newest + 1) % HISTORY;
        self.speeds_mps[self.newest] = speed_mps;
    }

    /// Mean acceleration of the last 50 ms, m/s².
    pub fn accel_mps2(&self) -> f64 {
        self.accel_before(0)
    }

    /// Change of this mean acceleration over the last 200 ms, divided by that time, m/s³.
    pub fn jerk_mps3(&self) -> f64 {
        let scan_s = protocol::SCAN.as_secs();
        (self.accel_before(0) - self.accel_before(JERK_SCANS)) / (JERK_SCANS as f64 * scan_s)
    }

    fn accel_before(&self, scans: usize) -> f64 {
        let at = |back: usize| self.speeds_mps[(self.newest + HISTORY - back) % HISTORY];
        let seconds = ACCEL_SCANS as f64 * protocol::SCAN.as_secs();
        (at(scans) - at(scans + ACCEL_SCANS)) / seconds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// v = 0.4·t²: the mean acceleration of 50 ms is 0.8·(t − 25 ms), the jerk 0.8 m/s³.
    #[test]
    fn acceleration_and_jerk_of_a_parabola() {
        let mut history = SpeedHistory::default();
        for scan in 0..=100 {
            let t = f64::from(scan) * 0.01;
            history.push(0.4 * t * t);
        }
        assert!((history.accel_mps2() - 0.8 * 0.975).abs() < 1e-12);
        assert!((history.jerk_mps3() - 0.8).abs() < 1e-10);
    }
}
