//! The speed controller's seam, and a simple proportional-integral loop behind it.

use protocol::CYCLE;
use protocol::config::AtoConfig;

use super::TargetSpeed;

use protocol::Speed;

/// Service deceleration that full brake effort stands for, m/s² [S3: B7 = 3.5 km/h/s].
const FULL_BRAKE_MPS2: f64 = 3.5 / 3.6;

/// One cycle's task for the controller.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    /// Where to go.
    pub target: TargetSpeed,
    /// Where we are.
    pub speed: Speed,
}

/// Turns target and speed into effort.
pub trait SpeedController {
    /// One cycle; the share of available effort, -1 full brake .. 1 full power.
    fn step(&mut self, drive: Drive) -> f64;
    /// The train stands and is not driven.
    fn reset(&mut self);
}

/// Proportional-integral loop with the stop's own deceleration fed forward. The integral stands
/// still while the effort is at its limit.
#[derive(Debug)]
pub struct SpeedLoop {
    full_effort_error_kmh: f64,
    integral_per_s: f64,
    integral: f64,
}

impl SpeedLoop {
    /// A loop with the configuration's gains.
    pub fn new(config: &AtoConfig) -> Self {
        Self {
            full_effort_error_kmh: config.full_effort_error_kmh,
            integral_per_s: config.integral_per_s,
            integral: 0.0,
        }
    }
}

impl SpeedController for SpeedLoop {
    fn step(&mut self, drive: Drive) -> f64 {
        let error = (drive.target.speed.kmh() - drive.speed.kmh()) / self.full_effort_error_kmh;
        let forward = -drive.target.decel_mps2 / FULL_BRAKE_MPS2;
        let effort = error + forward + self.integral;
        if effort.abs() < 1.0 {
            self.integral += error * self.integral_per_s * CYCLE.as_secs();
        }
        if effort.is_nan() {
            -1.0
        } else {
            effort.clamp(-1.0, 1.0)
        }
    }

    fn reset(&mut self) {
        self.integral = 0.0;
    }
}
