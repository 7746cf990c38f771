//! ATO's part of the unit configuration: controller, profiles, what it knows of its train.

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use super::{ConfigError, conflict, within};

/// The speed controllers that can be chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ControllerKind {
    /// S-curve profile and servo tracking controller [S0 §3.1].
    Servo,
    /// Jerk-limited profile and proportional-integral controller (S1).
    Pi,
    /// Jerk-limited profile and Mamdani fuzzy controller (S1).
    Fuzzy,
    /// Limit less a margin until the station stop's own curve is lower [S2 §3.2].
    Pss,
}

impl ControllerKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Servo, Self::Pi, Self::Fuzzy, Self::Pss];

    /// Name in files, commands and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Servo => "servo",
            Self::Pi => "pi",
            Self::Fuzzy => "fuzzy",
            Self::Pss => "pss",
        }
    }

    /// The controller called `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// What the unit knows of the train it drives: REG turns force into a share of what is there, the
/// controllers scale their gains by mass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AtoTrainConfig {
    /// Empty mass, kg (S3).
    pub empty_kg: f64,
    /// Rotating parts as mass, kg (S3).
    pub rotating_kg: f64,
    /// Length, m.
    pub length_m: f64,
    /// Acceleration at full powering effort up to the base speed, km/h/s [S1, S3: 3.0].
    pub power_kmh_per_s: f64,
    /// Speed up to which it is there, km/h; constant power beyond [S1, S3: 40].
    pub base_speed_kmh: f64,
    /// Deceleration at full braking effort, km/h/s [S3: 3.5].
    pub brake_kmh_per_s: f64,
    /// Greatest change of effort, m/s³ of the acceleration it stands for [S1: 0.8].
    pub jerk_mps3: f64,
    /// Time from a command until inverters begin to follow it, ms.
    pub dead_time_ms: f64,
    /// Time constant with which they follow, ms.
    pub lag_ms: f64,
    /// The same of the air brake, ms.
    pub air_dead_time_ms: f64,
    /// The same of the air brake, ms.
    pub air_lag_ms: f64,
    /// Speed below which the electric brake hands over to air, km/h [S3: 15].
    pub air_from_kmh: f64,
    /// Speed below which air brakes alone, km/h.
    pub air_alone_kmh: f64,
    /// Speed-proportional resistance, 1/s [S0: r = 0.001].
    pub drag_per_s: f64,
    /// Constant running resistance, kgf/t.
    pub rolling_kgf_t: f64,
    /// Curve resistance times radius, kgf·m/t [700/R].
    pub curve_kgf_m_t: f64,
}

/// Servo tracking controller and its profile [S0 §3.1].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoConfig {
    /// Chosen closed-loop poles in the z-plane, real and imaginary part (S0).
    pub poles: [[f64; 2]; 4],
    /// Lengthening of the S-curve per change of speed, s/(m/s) [S0 eq. 1: 5/6 printed].
    pub s_curve_s_per_mps: f64,
    /// Time of the S-curve for no change of speed, s [S0 eq. 1: 11].
    pub s_curve_s: f64,
    /// Speed held from PSM1 on, km/h [S0: 40].
    pub psm1_kmh: f64,
    /// Speed reached at PSM4, m/s [S0 eq. 2: 1.5].
    pub psm4_mps: f64,
    /// Pull toward the profile's own position, 1/s.
    pub position_gain_per_s: f64,
    /// Greatest pull: this share of the profile's speed …
    pub pull_share: f64,
    /// … and this much more, m/s.
    pub pull_mps: f64,
    /// Greatest difference of what is asked for from the profile's own acceleration, m/s².
    pub correction_mps2: f64,
    /// Share of the brake that is there which the way from PSM2 to PSM4 may ask for.
    pub brake_share: f64,
    /// Speed by which a train that was braked too much may be below the profile before the profile
    /// begins anew from the train, m/s.
    pub left_behind_mps: f64,
    /// Rate at which the last of the speed is taken away at least, m/s².
    pub rest_mps2: f64,
    /// How a train moves up that came to rest too early: acceleration, m/s².
    pub creep_mps2: f64,
    /// The same: greatest speed, m/s.
    pub creep_mps: f64,
}

/// What the observer believes of a measured speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObserverConfig {
    /// How fast an error of the model is taken away, 1/s.
    pub pole_per_s: f64,
    /// Greatest error taken for one of the model when wheels turn faster than a braked train by it, or
    /// slower than a powered one, m/s.
    pub against_mps: f64,
    /// The same for slower than a braked train or faster than a powered one: wheels that slide or slip.
    pub along_mps: f64,
    /// Greatest acceleration the model may lack, m/s².
    pub missing_mps2: f64,
    /// Speed below the model's at which a braked wheel slides, m/s.
    pub slide_mps: f64,
    /// Longest slide, s.
    pub slide_s: f64,
}

/// Jerk-limited profile (S1).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProfileConfig {
    /// Acceleration limit, m/s² [S1: a_L].
    pub accel_mps2: f64,
    /// Deceleration limit, m/s².
    pub decel_mps2: f64,
    /// Jerk limit, m/s³ [S1: J = 0.8].
    pub jerk_mps3: f64,
    /// Speed by which the profile may run ahead of a train that cannot follow it, km/h.
    pub lead_kmh: f64,
    /// The profile's acceleration is asked for in every ramp, not only in the station stop. The
    /// printed laws work on the speed error alone, and follow a ramp with a large one.
    pub feed_forward: bool,
}

/// Proportional-integral controller (S1).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PiConfig {
    /// Proportional gain, N per unit of speed [S1: 300 000].
    pub proportional_n: f64,
    /// Integral gain, N/s per unit of speed [S1: 2 000].
    pub integral_n_per_s: f64,
    /// The unit of speed the gains are for, which S1 does not print: `mps` or `kmh`.
    pub speed_unit: GainUnit,
    /// Mass the gains are for, kg [S1: 432 000]; they scale with the load.
    pub mass_kg: f64,
}

/// Unit of speed of a gain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GainUnit {
    /// m/s.
    Mps,
    /// km/h.
    Kmh,
}

/// Mamdani controller (S1). Places of the sets are not printed; isosceles triangles that overlap by
/// half lie evenly, so the outermost peak fixes all of a variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FuzzyConfig {
    /// Error at which `nb`/`pb` peak, m/s; `ns`/`ps` at half of it.
    pub big_error_mps: f64,
    /// Change of error per second at which `negative`/`positive` peak, m/s².
    pub change_mps2: f64,
    /// Force at which `nvh`/`pvh` peak at `mass_kg`, N [S1: 400 kN]; `nh`/`ph` at half of it.
    pub force_n: f64,
    /// Mass it is for, kg [S1: 432 000]; it scales with the load.
    pub mass_kg: f64,
}

/// Station stop curve [S2 §3.2] and the loop that follows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PssConfig {
    /// Brake rate, m/s² [S2: B_r].
    pub brake_rate_mps2: f64,
    /// Distance at which the square root reaches zero, m [S2: E_off].
    pub offset_m: f64,
    /// Slope of the linear end, 1/s [S2: S_l].
    pub slope_per_s: f64,
    /// Jerk with which the curve's deceleration is built up, m/s³.
    pub jerk_mps3: f64,
    /// How fast the reference takes away its distance from the curve, 1/s.
    pub join_per_s: f64,
    /// Speed error that asks for full effort, km/h.
    pub full_effort_error_kmh: f64,
    /// Share of the error taken away per second by the integral part.
    pub integral_per_s: f64,
    /// Speed below which it rests, km/h: too few tachometer pulses.
    pub integral_above_kmh: f64,
}

impl PssConfig {
    /// Speed of the linear end at the stop point, m/s [S2: V_stop], so that it meets the square root
    /// in value and slope.
    pub fn stop_mps(&self) -> f64 {
        self.brake_rate_mps2 / (2.0 * self.slope_per_s) - self.slope_per_s * self.offset_m
    }

    /// Whether a train can follow the curve to its end.
    fn check(&self, ato: &AtoConfig) -> Result<(), ConfigError> {
        let stop_mps = self.stop_mps();
        if stop_mps <= 0.0 {
            return Err(ConfigError::Conflict(alloc::format!(
                "ato.pss: V_stop = brake_rate_mps2/(2 slope_per_s) - slope_per_s offset_m is {stop_mps:.3} m/s; it must be above 0, or the train comes near the stop point but never arrives"
            )));
        }
        let jerk = self.brake_rate_mps2 * self.slope_per_s;
        if jerk > ato.train.jerk_mps3 {
            return Err(ConfigError::Conflict(alloc::format!(
                "ato.pss: the linear end begins with a jerk of brake_rate_mps2 x slope_per_s = {jerk:.2} m/s3, more than ato.train.jerk_mps3 = {}",
                ato.train.jerk_mps3
            )));
        }
        if self.brake_rate_mps2 > ato.profile.decel_mps2 {
            return Err(conflict(
                "ato.pss.brake_rate_mps2 must not be above ato.profile.decel_mps2",
            ));
        }
        Ok(())
    }
}

/// When ATO doubts itself or its inputs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AtoWatchConfig {
    /// Speed error that is not following, km/h.
    pub following_kmh: f64,
    /// How long it must last, ms.
    pub following_ms: u32,
    /// Way past the stop point that is an overrun, m.
    pub overrun_m: f64,
    /// Difference between way by wheels and way between markers that is a fault, share.
    pub wheel_error: f64,
}

/// ATO.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AtoConfig {
    /// The speed controller in use.
    pub controller: ControllerKind,
    /// Target below the limit, km/h [S2 §3.3: 5].
    pub below_limit_kmh: f64,
    /// Further lowering in normal running mode, km/h [S0 §3.1.1].
    pub normal_lowering_kmh: f64,
    /// Distance before the stop point at which a train that stands has arrived, m.
    pub arrived_m: f64,
    /// Acceleration and deceleration ATO asks for at most, km/h/s [S0 §4: 3.0 and 3.5].
    pub accel_kmh_per_s: f64,
    /// See `accel_kmh_per_s`.
    pub decel_kmh_per_s: f64,
    /// Acceleration at which a train is moved up from beyond PSM2 at most, m/s².
    pub gently_mps2: f64,
    /// What the unit knows of its train.
    pub train: AtoTrainConfig,
    /// What the observer believes.
    pub observer: ObserverConfig,
    /// Servo.
    pub servo: ServoConfig,
    /// Jerk-limited profile of `pi` and `fuzzy`.
    pub profile: ProfileConfig,
    /// PI.
    pub pi: PiConfig,
    /// Fuzzy.
    pub fuzzy: FuzzyConfig,
    /// Station stop by distance, also of `pi` and `fuzzy`.
    pub pss: PssConfig,
    /// When ATO doubts.
    pub watch: AtoWatchConfig,
}

impl AtoConfig {
    /// Checks ranges and that values fit together.
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        for (key, value, low, high) in self.ranges() {
            within(key, value, low, high)?;
        }
        for [re, im] in self.servo.poles {
            let size = libm::hypot(re, im);
            if size.is_nan() || size >= 1.0 {
                return Err(ConfigError::Conflict(alloc::format!(
                    "ato.servo.poles: {re} {im:+}i has size {size}, a stable pole lies inside the unit circle"
                )));
            }
            let paired = self.servo.poles.iter().any(|p| *p == [re, -im]);
            if !paired {
                return Err(ConfigError::Conflict(alloc::format!(
                    "ato.servo.poles: {re} {im:+}i needs its conjugate {re} {:+}i",
                    -im
                )));
            }
        }
        self.pss.check(self)
    }

    fn ranges(&self) -> Vec<(&'static str, f64, f64, f64)> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::UnitConfig;

    fn read_with(line: &str, instead: &str) -> Result<UnitConfig, ConfigError> {
        let text = include_str!("../../../scripts/units/sg100.toml");
        assert!(text.contains(line), "{line}");
        UnitConfig::from_toml(&text.replace(line, instead))
    }

    /// A line of the configuration, what stands there instead, and what the reason must say.
    #[test]
    fn a_stop_curve_that_cannot_be_followed_is_refused_with_the_reason() {
        for (line, instead, reason) in [
            ("\noffset_m = 0.10", "\noffset_m = 0.30", "never arrives"),
            ("\nslope_per_s = 1.2", "\nslope_per_s = 1.4", "jerk"),
            (
                "\ndecel_mps2 = 0.8333333333333334",
                "\ndecel_mps2 = 0.6",
                "brake_rate_mps2",
            ),
        ] {
            let refused = read_with(line, instead).unwrap_err();
            assert!(matches!(refused, ConfigError::Conflict(_)), "{refused:?}");
            assert!(alloc::format!("{refused}").contains(reason), "{refused}");
        }
    }
}
