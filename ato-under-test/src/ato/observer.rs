//! Where the train will be when the effort of this cycle begins to act.
//!
//! The printed laws act on the present speed. A measured one is the mean of a window that lies in
//! the past, and an effort is followed after a dead time: the observer runs the train model over that
//! time with the efforts already asked for.

use protocol::CYCLE;
use protocol::config::AtoTrainConfig;

/// Cycles of efforts that are remembered: 1 s, the longest dead time, and the measuring delay.
const CYCLES: usize = 24;
/// Age of a measured speed when it is used: half the window and a frame [default window: 100 ms].
const MEASURED_S: f64 = 0.06;

/// The observer.
#[derive(Debug, Default)]
pub struct Observer {
    asked: [f64; CYCLES],
    accel_mps2: f64,
}

/// The train at the time the effort begins to act.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ahead {
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Acceleration, m/s².
    pub accel_mps2: f64,
    /// Way until then, m.
    pub moved_m: f64,
}

impl Observer {
    /// One cycle: `asked_mps2` is what the last effort asks of the train.
    pub fn step(&mut self, measured_mps: f64, asked_mps2: f64, train: &AtoTrainConfig) -> Ahead {
        self.asked.rotate_right(1);
        self.asked[0] = asked_mps2;
        let dt = CYCLE.as_secs();
        let follow = |accel: f64, asked: f64| {
            let share = (dt / (train.lag_ms / 1000.0)).min(1.0);
            accel + (asked - accel) * share
        };
        let dead_cycles = libm::round(train.dead_time_ms / 1000.0 / dt) as usize;
        let begins = dead_cycles.min(CYCLES - 1);
        self.accel_mps2 = follow(self.accel_mps2, self.asked[begins]);
        let mut ahead = Ahead {
            speed_mps: measured_mps + self.accel_mps2 * MEASURED_S,
            accel_mps2: self.accel_mps2,
            moved_m: 0.0,
        };
        for cycle in (0..begins).rev() {
            ahead.accel_mps2 = follow(ahead.accel_mps2, self.asked[cycle]);
            ahead.moved_m += ahead.speed_mps * dt;
            ahead.speed_mps += ahead.accel_mps2 * dt;
        }
        ahead.speed_mps = ahead.speed_mps.max(0.0);
        ahead
    }

    /// The train stands.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}
