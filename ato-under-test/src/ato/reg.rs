//! REG: force to a share of what motors and brakes can give at the present speed, in the 10 bits and
//! sign TCMS takes [S0 §3.3, S4].

use protocol::CYCLE;
use protocol::config::{AtoConfig, AtoTrainConfig};

#[derive(Clone, Copy, Debug, Default)]
pub struct Regulator {
    accel_mps2: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GrantedEffort {
    /// -1024 full brake .. 1023 full power.
    pub effort: i16,
    /// Force that the effort stands for, N.
    pub force_n: f64,
}

/// Bounds of one cycle.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Present speed, m/s.
    pub speed_mps: f64,
    /// Mass to be accelerated, kg.
    pub mass_kg: f64,
    pub power_cut: bool,
}

impl Regulator {
    /// One cycle. A force that is not a number gives a full brake.
    pub fn step(&mut self, force_n: f64, bounds: Bounds, config: &AtoConfig) -> GrantedEffort {
        let train = &config.train;
        let (power, brake) = (
            power_mps2(train, bounds.speed_mps),
            train.brake_kmh_per_s / 3.6,
        );
        let wanted = force_n / bounds.mass_kg;
        let wanted = if wanted.is_finite() { wanted } else { -brake };
        let most = if bounds.power_cut { 0.0 } else { power };
        let step = train.jerk_mps3 * CYCLE.as_secs();
        let accel = wanted.clamp(self.accel_mps2 - step, self.accel_mps2 + step);
        let accel = accel.clamp(-brake, most);
        let (full, scale) = if accel < 0.0 {
            (brake, 1024.0)
        } else {
            (power, 1023.0)
        };
        let effort = libm::round(accel / full * scale).clamp(-1024.0, 1023.0);
        self.accel_mps2 = effort / scale * full;
        GrantedEffort {
            effort: effort as i16,
            force_n: self.accel_mps2 * bounds.mass_kg,
        }
    }

    pub fn reset(&mut self) {
        self.accel_mps2 = 0.0;
    }
}

/// Acceleration at full powering effort, m/s²: constant up to the base speed, constant power beyond.
pub fn power_mps2(train: &AtoTrainConfig, speed_mps: f64) -> f64 {
    let base_mps = train.base_speed_kmh / 3.6;
    let fade = base_mps / speed_mps.max(base_mps);
    train.power_kmh_per_s / 3.6 * fade
}
