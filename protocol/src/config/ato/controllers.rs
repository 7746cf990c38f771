//! Parameters of the speed controllers, their profiles and the observer.

use serde::{Deserialize, Serialize};

use super::AtoConfig;
use crate::config::{ConfigError, conflict};

/// Servo tracking controller and its profile [S0 §3.1].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
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
    /// Greatest pull toward the profile: this share of the profile's speed, plus `pull_mps`.
    pub pull_share: f64,
    /// Part of the greatest pull that does not depend on speed, m/s.
    pub pull_mps: f64,
    /// Greatest difference between the acceleration asked for and the profile's own, m/s².
    pub correction_mps2: f64,
    /// Share of the available brake that the run from PSM2 to PSM4 may ask for.
    pub brake_share: f64,
    /// A train that was braked too much may be slower than the profile by this, m/s; beyond that, the profile restarts
    /// from the train's speed.
    pub left_behind_mps: f64,
    /// Least deceleration in the last 0.1 m before the stop point, m/s².
    pub rest_mps2: f64,
}

/// How far the observer trusts a measured speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObserverConfig {
    /// How fast an error of the model is taken away, 1/s.
    pub pole_per_s: f64,
    /// Greatest speed error put down to the model, m/s, when wheels turn faster than the model of a braked train, or
    /// slower than the model of a powered one.
    pub against_mps: f64,
    /// Greatest speed error put down to the model, m/s, when wheels turn slower than the model of a braked train, or
    /// faster than the model of a powered one: wheels that slide or slip.
    pub along_mps: f64,
    /// Greatest acceleration the model may lack, m/s².
    pub missing_mps2: f64,
    /// Speed by which a braked wheel is slower than the model when it slides, m/s.
    pub slide_mps: f64,
    /// Longest slide, s.
    pub slide_s: f64,
}

/// Jerk-limited profile (S1).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
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
    /// printed laws work on the speed error alone, and follow a ramp with a large error.
    pub feed_forward: bool,
}

/// Proportional-integral controller (S1).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PiConfig {
    /// Proportional gain, N per unit of speed [S1: 300 000].
    pub proportional_n: f64,
    /// Integral gain, N/s per unit of speed [S1: 2 000].
    pub integral_n_per_s: f64,
    /// Unit of speed that the gains are for, which S1 does not print: `mps` or `kmh`.
    pub speed_unit: GainUnit,
    /// Mass that the gains are for, kg [S1: 432 000]; the gains scale with the load.
    pub mass_kg: f64,
}

/// Unit of speed of a gain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GainUnit {
    /// m/s.
    Mps,
    /// km/h.
    Kmh,
}

/// Mamdani controller (S1). Places of the sets are not printed; isosceles triangles that overlap by
/// half lie evenly, so the outermost peak fixes all sets of a variable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FuzzyConfig {
    /// Error at which `nb`/`pb` peak, m/s; `ns`/`ps` at half of it.
    pub big_error_mps: f64,
    /// Change of error per second at which `negative`/`positive` peak, m/s².
    pub change_mps2: f64,
    /// Force at which `nvh`/`pvh` peak at `mass_kg`, N [S1: 400 kN]; `nh`/`ph` at half of it.
    pub force_n: f64,
    /// Mass that `force_n` is for, kg [S1: 432 000]; the force scales with the load.
    pub mass_kg: f64,
}

/// Station stop curve [S2 §3.2] and the loop that follows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
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
    /// Speed below which the integral part rests, km/h: too few tachometer pulses.
    pub integral_above_kmh: f64,
}

impl PssConfig {
    /// Speed of the linear end at the stop point, m/s [S2: V_stop], so that it meets the square root
    /// in value and slope.
    pub fn stop_mps(&self) -> f64 {
        self.brake_rate_mps2 / (2.0 * self.slope_per_s) - self.slope_per_s * self.offset_m
    }

    /// Whether a train can follow the curve to its end.
    pub(super) fn check(&self, ato: &AtoConfig) -> Result<(), ConfigError> {
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
