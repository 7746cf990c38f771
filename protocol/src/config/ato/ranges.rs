//! Permitted range of every number of ATO's configuration.

use super::AtoConfig;
use crate::check_ranges;
use crate::config::ConfigError;

impl AtoConfig {
    pub(super) fn check_ranges(&self) -> Result<(), ConfigError> {
        check_ranges! { self, "ato.";
            below_limit_kmh: 0.0, 20.0;
            normal_lowering_kmh: 0.0, 20.0;
            slow_kmh: 1.0, 45.0;
            accel_kmh_per_s: 1.0, 5.0;
            decel_kmh_per_s: 0.5, 5.0;
            train.empty_kg: 1e3, 1e7;
            train.rotating_kg: 0.0, 1e6;
            train.length_m: 5.0, 500.0;
            train.power_kmh_per_s: 0.5, 6.0;
            train.base_speed_kmh: 5.0, 130.0;
            train.brake_kmh_per_s: 0.5, 6.0;
            train.jerk_mps3: 0.1, 100.0;
            train.dead_time_ms: 0.0, 1000.0;
            train.lag_ms: 0.0, 1000.0;
            train.air_dead_time_ms: 0.0, 1000.0;
            train.air_lag_ms: 0.0, 1000.0;
            train.air_alone_kmh: 0.0, 60.0;
            train.air_from_kmh: self.train.air_alone_kmh, 80.0;
            train.drag_per_s: 0.0, 0.1;
            train.rolling_kgf_t: 0.0, 20.0;
            train.curve_kgf_m_t: 0.0, 2000.0;
            servo.s_curve_s_per_mps: 0.0, 10.0;
            servo.s_curve_s: 0.5, 60.0;
            servo.psm1_kmh: 10.0, 80.0;
            servo.psm4_mps: 0.3, 2.4;
            servo.position_gain_per_s: 0.0, 2.0;
            servo.pull_share: 0.0, 0.5;
            servo.pull_mps: 0.0, 1.0;
            servo.correction_mps2: 0.1, 2.0;
            servo.brake_share: 0.3, 1.0;
            servo.left_behind_mps: 0.1, 5.0;
            servo.rest_mps2: 0.05, 1.0;
            gently_mps2: 0.05, 1.0;
            observer.pole_per_s: 0.1, 10.0;
            observer.against_mps: 0.01, 5.0;
            observer.along_mps: 0.01, 5.0;
            observer.missing_mps2: 0.0, 2.0;
            observer.slide_mps: 0.05, 5.0;
            observer.slide_s: 0.0, 20.0;
            profile.accel_mps2: 0.1, 2.0;
            profile.decel_mps2: 0.1, 2.0;
            profile.jerk_mps3: 0.1, 5.0;
            profile.lead_kmh: 0.5, 50.0;
            pi.proportional_n: 0.0, 1e8;
            pi.integral_n_per_s: 0.0, 1e8;
            pi.mass_kg: 1e3, 1e7;
            fuzzy.big_error_mps: 1e-3, 20.0;
            fuzzy.change_mps2: 1e-3, 20.0;
            fuzzy.force_n: 1e3, 1e7;
            fuzzy.mass_kg: 1e3, 1e7;
            pss.brake_rate_mps2: 0.1, 1.2;
            pss.offset_m: 0.0, 5.0;
            pss.slope_per_s: 0.1, 10.0;
            pss.jerk_mps3: 0.1, 5.0;
            pss.join_per_s: 0.1, 10.0;
            pss.full_effort_error_kmh: 0.1, 50.0;
            pss.integral_per_s: 0.0, 5.0;
            pss.integral_above_kmh: 0.0, 20.0;
            jog.max_m: 0.0, 20.0;
            jog.tries: 1.0, 3.0;
            jog.kmh: 0.5, 4.0;
            jog.accel_mps2: 0.05, 0.5;
            watch.following_kmh: 0.5, 50.0;
            watch.overrun_m: 0.1, 20.0;
            watch.wheel_error: 0.001, 0.2;
        }
        Ok(())
    }
}
