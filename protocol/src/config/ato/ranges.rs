//! Permitted range of every number of ATO's configuration.

use alloc::vec::Vec;

use super::AtoConfig;

impl AtoConfig {
    /// Key path, value, least and greatest permitted value.
    pub(super) fn ranges(&self) -> Vec<(&'static str, f64, f64, f64)> {
        let (t, s, p, o) = (&self.train, &self.servo, &self.profile, &self.observer);
        let (pi, f, pss, w) = (&self.pi, &self.fuzzy, &self.pss, &self.watch);
        Vec::from([
            ("ato.below_limit_kmh", self.below_limit_kmh, 0.0, 20.0),
            (
                "ato.normal_lowering_kmh",
                self.normal_lowering_kmh,
                0.0,
                20.0,
            ),
            ("ato.arrived_m", self.arrived_m, 0.1, 5.0),
            ("ato.accel_kmh_per_s", self.accel_kmh_per_s, 1.0, 5.0),
            ("ato.decel_kmh_per_s", self.decel_kmh_per_s, 2.0, 5.0),
            ("ato.train.empty_kg", t.empty_kg, 1e3, 1e7),
            ("ato.train.rotating_kg", t.rotating_kg, 0.0, 1e6),
            ("ato.train.length_m", t.length_m, 5.0, 500.0),
            ("ato.train.power_kmh_per_s", t.power_kmh_per_s, 0.5, 6.0),
            ("ato.train.base_speed_kmh", t.base_speed_kmh, 5.0, 130.0),
            ("ato.train.brake_kmh_per_s", t.brake_kmh_per_s, 0.5, 6.0),
            ("ato.train.jerk_mps3", t.jerk_mps3, 0.1, 100.0),
            ("ato.train.dead_time_ms", t.dead_time_ms, 0.0, 1000.0),
            ("ato.train.lag_ms", t.lag_ms, 0.0, 1000.0),
            (
                "ato.train.air_dead_time_ms",
                t.air_dead_time_ms,
                0.0,
                1000.0,
            ),
            ("ato.train.air_lag_ms", t.air_lag_ms, 0.0, 1000.0),
            ("ato.train.air_alone_kmh", t.air_alone_kmh, 0.0, 60.0),
            (
                "ato.train.air_from_kmh",
                t.air_from_kmh,
                t.air_alone_kmh,
                80.0,
            ),
            ("ato.train.drag_per_s", t.drag_per_s, 0.0, 0.1),
            ("ato.train.rolling_kgf_t", t.rolling_kgf_t, 0.0, 20.0),
            ("ato.train.curve_kgf_m_t", t.curve_kgf_m_t, 0.0, 2000.0),
            (
                "ato.servo.s_curve_s_per_mps",
                s.s_curve_s_per_mps,
                0.0,
                10.0,
            ),
            ("ato.servo.s_curve_s", s.s_curve_s, 0.5, 60.0),
            ("ato.servo.psm1_kmh", s.psm1_kmh, 10.0, 80.0),
            ("ato.servo.psm4_mps", s.psm4_mps, 0.3, 2.4),
            (
                "ato.servo.position_gain_per_s",
                s.position_gain_per_s,
                0.0,
                2.0,
            ),
            ("ato.servo.pull_share", s.pull_share, 0.0, 0.5),
            ("ato.servo.pull_mps", s.pull_mps, 0.0, 1.0),
            ("ato.servo.correction_mps2", s.correction_mps2, 0.1, 2.0),
            ("ato.servo.brake_share", s.brake_share, 0.3, 1.0),
            ("ato.servo.left_behind_mps", s.left_behind_mps, 0.1, 5.0),
            ("ato.servo.rest_mps2", s.rest_mps2, 0.05, 1.0),
            ("ato.servo.creep_mps2", s.creep_mps2, 0.05, 1.0),
            ("ato.servo.creep_mps", s.creep_mps, 0.1, 1.5),
            ("ato.gently_mps2", self.gently_mps2, 0.05, 1.0),
            ("ato.observer.pole_per_s", o.pole_per_s, 0.1, 10.0),
            ("ato.observer.against_mps", o.against_mps, 0.01, 5.0),
            ("ato.observer.along_mps", o.along_mps, 0.01, 5.0),
            ("ato.observer.missing_mps2", o.missing_mps2, 0.0, 2.0),
            ("ato.observer.slide_mps", o.slide_mps, 0.05, 5.0),
            ("ato.observer.slide_s", o.slide_s, 0.0, 20.0),
            ("ato.profile.accel_mps2", p.accel_mps2, 0.1, 2.0),
            ("ato.profile.decel_mps2", p.decel_mps2, 0.1, 2.0),
            ("ato.profile.jerk_mps3", p.jerk_mps3, 0.1, 5.0),
            ("ato.profile.lead_kmh", p.lead_kmh, 0.5, 50.0),
            ("ato.pi.proportional_n", pi.proportional_n, 0.0, 1e8),
            ("ato.pi.integral_n_per_s", pi.integral_n_per_s, 0.0, 1e8),
            ("ato.pi.mass_kg", pi.mass_kg, 1e3, 1e7),
            ("ato.fuzzy.big_error_mps", f.big_error_mps, 1e-3, 20.0),
            ("ato.fuzzy.change_mps2", f.change_mps2, 1e-3, 20.0),
            ("ato.fuzzy.force_n", f.force_n, 1e3, 1e7),
            ("ato.fuzzy.mass_kg", f.mass_kg, 1e3, 1e7),
            ("ato.pss.brake_rate_mps2", pss.brake_rate_mps2, 0.1, 1.2),
            ("ato.pss.offset_m", pss.offset_m, 0.0, 5.0),
            ("ato.pss.slope_per_s", pss.slope_per_s, 0.1, 10.0),
            ("ato.pss.jerk_mps3", pss.jerk_mps3, 0.1, 5.0),
            ("ato.pss.join_per_s", pss.join_per_s, 0.1, 10.0),
            (
                "ato.pss.full_effort_error_kmh",
                pss.full_effort_error_kmh,
                0.1,
                50.0,
            ),
            ("ato.pss.integral_per_s", pss.integral_per_s, 0.0, 5.0),
            (
                "ato.pss.integral_above_kmh",
                pss.integral_above_kmh,
                0.0,
                20.0,
            ),
            ("ato.watch.following_kmh", w.following_kmh, 0.5, 50.0),
            ("ato.watch.overrun_m", w.overrun_m, 0.1, 20.0),
            ("ato.watch.wheel_error", w.wheel_error, 0.001, 0.2),
        ])
    }
}
