//! Target speed: the most restrictive of limit, fixed speed and station stop [S0 §3.1.1, S2 §3.2].

use protocol::Speed;
use protocol::config::AtoConfig;
use protocol::message::RunningMode;

/// Distance to the stop point that counts as there, m.
pub const ARRIVED_M: f64 = 0.5;

/// What the target depends on.
#[derive(Clone, Copy, Debug)]
pub struct TargetInputs {
    /// Limit from ATP.
    pub limit: Speed,
    /// Fixed speed ordered by the wayside.
    pub fixed_speed: Option<Speed>,
    /// Running mode.
    pub running_mode: RunningMode,
    /// Distance to the stop point, m.
    pub to_stop_m: Option<f64>,
}

/// A target and how it changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetSpeed {
    /// The speed.
    pub speed: Speed,
    /// Deceleration it asks for by itself, m/s².
    pub decel_mps2: f64,
}

/// The target in force.
pub fn target(inputs: TargetInputs, config: &AtoConfig) -> TargetSpeed {
    let lowering = match inputs.running_mode {
        RunningMode::Recovery => 0.0,
        RunningMode::Normal | RunningMode::Unknown(_) => config.normal_lowering_kmh,
    };
    let below = Speed::from_kmh(config.below_limit_kmh + lowering);
    let allowed = (inputs.limit - below).max(Speed::ZERO);
    let cruise = inputs
        .fixed_speed
        .map_or(allowed, |fixed| allowed.min(fixed));
    let stop = inputs.to_stop_m.map(|distance_m| {
        Speed::from_mps(libm::sqrt(
            2.0 * config.stop_rate_mps2 * distance_m.max(0.0),
        ))
    });
    match stop {
        Some(stop) if stop < cruise => TargetSpeed {
            speed: stop,
            decel_mps2: config.stop_rate_mps2,
        },
        _ => TargetSpeed {
            speed: cruise,
            decel_mps2: 0.0,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config() -> AtoConfig {
        AtoConfig {
            below_limit_kmh: 5.0,
            normal_lowering_kmh: 0.0,
            full_effort_error_kmh: 4.0,
            integral_per_s: 0.05,
            stop_rate_mps2: 0.63,
        }
    }

    #[test]
    fn pss_takes_over_98_m_before_the_stop_at_40_kmh() {
        // S2 §3.3: limit 45, target 40 km/h, section 735 m, PSS from 637 m.
        let at = |to_stop_m| {
            let inputs = TargetInputs {
                limit: Speed::from_kmh(45.0),
                fixed_speed: None,
                running_mode: RunningMode::Normal,
                to_stop_m: Some(to_stop_m),
            };
            target(inputs, &config())
        };
        assert_eq!(at(101.0).decel_mps2, 0.0);
        assert!((at(101.0).speed.kmh() - 40.0).abs() < 1e-9);
        assert!(at(95.0).decel_mps2 > 0.0);
    }

    #[test]
    fn no_code_gives_no_target() {
        let inputs = TargetInputs {
            limit: Speed::ZERO,
            fixed_speed: Some(Speed::from_kmh(60.0)),
            running_mode: RunningMode::Recovery,
            to_stop_m: None,
        };
        assert_eq!(target(inputs, &config()).speed, Speed::ZERO);
    }
}
