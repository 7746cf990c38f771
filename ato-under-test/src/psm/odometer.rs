//! Distance run, interpolated between tachometer pulses: a pulse is several centimetres, but the stop
//! position is to be known to one.
//!
//! The way to the last pulse edge is counted; what has been run since follows from the speed and its
//! change. So does where the train was when a marker's edge came, some milliseconds ago.

use protocol::SCAN;

/// Scans over which the change of speed is taken.
const SCANS: usize = 20;

/// Motion of the train in this scan.
#[derive(Clone, Copy, Debug, Default)]
pub struct Movement {
    /// Distance counted since the last scan, m, backward negative.
    pub moved_m: f64,
    /// Age of the last pulse edge when the inputs were sampled, s.
    pub edge_age_s: f64,
    /// Speed by the tachometer that counts, mean over its window, m/s.
    pub speed_mps: f64,
    pub standstill: bool,
    /// ATO drives: the position is needed, a marker that does not come matters.
    pub driven: bool,
}

#[derive(Clone, Debug)]
pub struct Odometer {
    pulse_m: f64,
    window_s: f64,
    counted_m: f64,
    beyond_m: f64,
    direction: f64,
    /// Speed at the last edge, m/s, and its change, m/s².
    speed_mps: f64,
    accel_mps2: f64,
    edge_age_s: f64,
    speeds_mps: [f64; SCANS],
    at: usize,
}

impl Odometer {
    /// Sets the way that a pulse stands for, m, from the next one on.
    pub fn set_pulse(&mut self, pulse_m: f64) {
        self.pulse_m = pulse_m;
    }

    /// An odometer whose pulses stand for `pulse_m`, with speeds averaged over `window_s`.
    pub fn new(pulse_m: f64, window_s: f64) -> Self {
        Self {
            pulse_m,
            window_s,
            counted_m: 0.0,
            beyond_m: 0.0,
            direction: 1.0,
            speed_mps: 0.0,
            accel_mps2: 0.0,
            edge_age_s: 0.0,
            speeds_mps: [0.0; SCANS],
            at: 0,
        }
    }

    pub fn step(&mut self, movement: &Movement) {
        let before = core::mem::replace(&mut self.speeds_mps[self.at], movement.speed_mps);
        self.at = (self.at + 1) % SCANS;
        self.edge_age_s = movement.edge_age_s;
        if movement.moved_m != 0.0 {
            self.counted_m += movement.moved_m;
            self.direction = movement.moved_m.signum();
            self.accel_mps2 = (movement.speed_mps - before) / (SCANS as f64 * SCAN.as_secs());
            let period_s = self.pulse_m / movement.speed_mps.max(1e-3);
            // A mean over the window is the speed at its middle.
            let middle_s = self.window_s.max(period_s).min(1.0) / 2.0;
            self.speed_mps = (movement.speed_mps + self.accel_mps2 * middle_s).max(0.0);
        }
        if !movement.standstill {
            self.beyond_m = self.since_edge_m(self.edge_age_s).clamp(0.0, self.pulse_m);
        }
    }

    /// Distance from the last edge to `seconds` after it, m, ahead positive.
    fn since_edge_m(&self, seconds: f64) -> f64 {
        // A train that slows comes to a stop, it does not turn round.
        let stops_s = if self.accel_mps2 < 0.0 {
            -self.speed_mps / self.accel_mps2
        } else {
            f64::INFINITY
        };
        let t = seconds.min(stops_s);
        self.speed_mps * t + self.accel_mps2 * t * t / 2.0
    }

    /// Distance since power-up, m, by the configured wheel.
    pub fn distance_m(&self) -> f64 {
        self.counted_m + self.direction * self.beyond_m
    }

    /// Distance as it was `age_s` before the inputs were sampled, m.
    pub fn distance_ago_m(&self, age_s: f64) -> f64 {
        let now_m = self.since_edge_m(self.edge_age_s);
        let then_m = self.since_edge_m(self.edge_age_s - age_s);
        self.distance_m() - self.direction * (now_m - then_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PULSE_M: f64 = 0.027;

    /// Steps an odometer along `distance(t)` with `speed(t)` for `seconds`; the greatest error.
    fn follow(
        distance: impl Fn(f64) -> f64,
        speed: impl Fn(f64) -> f64,
        seconds: f64,
    ) -> (f64, f64) {
        let mut odometer = Odometer::new(PULSE_M, 0.1);
        let (mut counted, mut edge_s) = (0.0, 0.0);
        let (mut worst, mut worst_ago) = (0.0f64, 0.0f64);
        for scan in 1..=libm::round(seconds / 0.01) as u32 {
            let t = f64::from(scan) * 0.01;
            let pulses = libm::floor(distance(t) / PULSE_M);
            let moved = pulses - counted;
            if moved > 0.0 {
                // The edge lies where the distance crosses a whole pulse.
                let back_m = distance(t) - pulses * PULSE_M;
                edge_s = t - back_m / speed(t).max(1e-3);
                counted = pulses;
            }
            odometer.step(&Movement {
                moved_m: moved * PULSE_M,
                edge_age_s: t - edge_s,
                // The tachometer's mean is half its window late.
                speed_mps: speed((edge_s - 0.05).max(0.0)),
                ..Movement::default()
            });
            if t > 1.0 {
                worst = worst.max(libm::fabs(odometer.distance_m() - distance(t)));
                let ago = odometer.distance_ago_m(0.02);
                worst_ago = worst_ago.max(libm::fabs(ago - distance(t - 0.02)));
            }
        }
        (worst, worst_ago)
    }

    #[test]
    fn distance_is_known_to_millimetres_between_pulses_while_braking_from_60() {
        let (v, a) = (60.0 / 3.6, 0.9);
        let (worst, ago) = follow(|t| v * t - a * t * t / 2.0, |t| v - a * t, 15.0);
        assert!(worst < 0.003 && ago < 0.003, "{worst} {ago}");
    }

    #[test]
    fn the_last_centimetres_before_a_stop_are_known_to_one() {
        let (v, a) = (1.5, 0.33);
        let stop_s = v / a;
        let distance = |t: f64| v * t.min(stop_s) - a * t.min(stop_s) * t.min(stop_s) / 2.0;
        let (worst, _) = follow(distance, |t| (v - a * t).max(0.0), stop_s + 0.4);
        assert!(worst < 0.01, "{worst}");
    }
}
