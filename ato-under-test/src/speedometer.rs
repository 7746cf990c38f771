//! Speed from one tachometer: pulses over the time between their edges.
//!
//! Counting whole pulses in a fixed window would step by 1 km/h; dividing by the time between the
//! first and last edge of the window does not.

use alloc::collections::VecDeque;

use protocol::{Duration, Instant, Speed};

use crate::signals::Pulses;

/// Silence after which the wheel stands.
const STANDING: Duration = Duration::from_ms(1000);
/// Edges kept; more than any window of the configuration's range holds scans.
const EDGES: usize = 128;
/// Scans between the speeds that are compared for an impossible jump.
const JUMP_SCANS: usize = 10;
/// Jump allowed beyond the plausible acceleration, for the first pulses after standing, m/s.
const JUMP_ALLOWANCE_MPS: f64 = 0.5;
/// Jump that uneven teeth alone make, m/s.
const TEETH_MPS: f64 = 0.1;
const GRAVITY_MPS2: f64 = 9.81;

#[derive(Clone, Debug)]
pub struct Speedometer {
    window: Duration,
    metres_per_pulse: f64,
    edges: VecDeque<(Instant, u64)>,
    total: u64,
    pub speed: Speed,
    history: [f64; JUMP_SCANS],
    at: usize,
}

impl Speedometer {
    /// Averages over `window`.
    pub fn new(window: Duration, metres_per_pulse: f64) -> Self {
        Self {
            window,
            metres_per_pulse,
            edges: VecDeque::with_capacity(EDGES),
            total: 0,
            speed: Speed::ZERO,
            history: [0.0; JUMP_SCANS],
            at: 0,
        }
    }

    /// Sets the way that a pulse stands for, m; what was measured is forgotten.
    pub fn set_pulse(&mut self, pulse_m: f64) {
        self.metres_per_pulse = pulse_m;
        self.reset();
    }

    /// Forgets everything: the source of the pulses has changed.
    pub fn reset(&mut self) {
        self.edges.clear();
        self.speed = Speed::ZERO;
        self.history = [0.0; JUMP_SCANS];
    }

    /// One scan; returns the jump in speed over the last ten scans, m/s.
    pub fn step(&mut self, pulses: &Pulses) -> f64 {
        if pulses.count > 0 {
            self.measure(pulses);
        } else {
            self.fade(pulses.sampled_at);
        }
        let before = core::mem::replace(&mut self.history[self.at], self.speed.mps());
        self.at = (self.at + 1) % JUMP_SCANS;
        self.speed.mps() - before
    }

    fn measure(&mut self, pulses: &Pulses) {
        self.total += u64::from(pulses.count);
        let newest = self.edges.back().map(|(at, _)| *at);
        if newest.is_some_and(|at| pulses.edge_at <= at || pulses.edge_at.since(at) > STANDING) {
            self.edges.clear();
        }
        if self.edges.len() == EDGES {
            self.edges.pop_front();
        }
        self.edges.push_back((pulses.edge_at, self.total));
        let begin = pulses.edge_at.back(self.window);
        while self.edges.get(1).is_some_and(|(at, _)| *at <= begin) {
            self.edges.pop_front();
        }
        let (first_at, first_total) = self.edges[0];
        let span = pulses.edge_at.since(first_at).as_secs();
        if span > 0.0 {
            let metres = (self.total - first_total) as f64 * self.metres_per_pulse;
            self.speed = Speed::from_mps(metres / span);
        }
    }

    /// No pulse: the wheel turns at most as fast as one pulse since the last edge would say.
    fn fade(&mut self, sampled_at: Instant) {
        let Some((last, _)) = self.edges.back() else {
            self.speed = Speed::ZERO;
            return;
        };
        let silence = sampled_at.since(*last);
        if silence >= STANDING {
            self.speed = Speed::ZERO;
            self.edges.clear();
        } else if silence > Duration::ZERO {
            let most = Speed::from_mps(self.metres_per_pulse / silence.as_secs());
            self.speed = self.speed.min(most);
        }
    }

    /// Acceleration or deceleration that a jump over the compared scans stands for, m/s², where it is more than a wheel that
    /// rolls can have at this adhesion.
    pub fn accel_beyond(jump_mps: f64, adhesion: f64) -> Option<f64> {
        let span_s = JUMP_SCANS as f64 * protocol::SCAN.as_secs();
        let accel_mps2 = libm::fabs(jump_mps) / span_s;
        let most_mps2 = adhesion * GRAVITY_MPS2 + TEETH_MPS / span_s;
        (accel_mps2 > most_mps2).then_some(accel_mps2)
    }

    /// Whether a jump over the compared scans is more than a wheel can do.
    pub fn impossible(jump_mps: f64, plausible_mps2: f64) -> bool {
        jump_mps
            > plausible_mps2 * JUMP_SCANS as f64 * protocol::SCAN.as_secs() + JUMP_ALLOWANCE_MPS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const METRES: f64 = 0.027;

    fn drive(meter: &mut Speedometer, from_ms: u64, scans: u64, speed: f64) {
        for i in 0..scans {
            let now = Instant::from_ms(from_ms + 10 * i);
            let before = libm::floor(speed * (now.as_secs() - 0.01) / METRES);
            let after = libm::floor(speed * now.as_secs() / METRES);
            meter.step(&Pulses {
                count: (after - before) as u32,
                edge_at: Instant::from_us((after * METRES / speed * 1e6) as u64),
                sampled_at: now,
                backward: false,
            });
        }
    }

    #[test]
    fn edge_times_give_the_speed_to_a_thousandth() {
        for speed in [0.5, 3.3, 12.5, 22.2] {
            let mut meter = Speedometer::new(Duration::from_ms(100), METRES);
            drive(&mut meter, 1000, 100, speed);
            let error = (meter.speed.mps() - speed).abs();
            assert!(
                error < speed * 1e-3,
                "{speed} m/s measured as {}",
                meter.speed.mps()
            );
        }
    }

    #[test]
    fn a_wheel_that_stops_is_seen_to_stop() {
        let mut meter = Speedometer::new(Duration::from_ms(100), METRES);
        drive(&mut meter, 1000, 100, 10.0);
        let still = |ms| Pulses {
            sampled_at: Instant::from_ms(ms),
            ..Pulses::default()
        };
        meter.step(&still(2090));
        assert!(meter.speed.mps() < 0.4, "one pulse in 100 ms at most");
        meter.step(&still(3100));
        assert_eq!(meter.speed, Speed::ZERO);
    }
}
