//! ATO's part of the unit configuration: controller, profiles, observer, train and monitoring.

mod controllers;
mod ranges;

use serde::{Deserialize, Serialize};

use super::ConfigError;

pub use controllers::{
    FuzzyConfig, GainUnit, ObserverConfig, PiConfig, ProfileConfig, PssConfig, ServoConfig,
};

crate::labelled! {
    /// The speed controllers that can be chosen.
    #[derive(
        Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
    )]
    #[serde(rename_all = "snake_case")]
    pub enum ControllerKind: name {
        /// S-curve profile and servo tracking controller [S0 §3.1].
        Servo = "servo",
        /// Jerk-limited profile and proportional-integral controller (S1).
        Pi = "pi",
        /// Jerk-limited profile and Mamdani fuzzy controller (S1).
        Fuzzy = "fuzzy",
        /// Limit less a margin until the station stop's own curve is lower [S2 §3.2].
        Pss = "pss",
    }
}

impl ControllerKind {
    /// The controller called `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// What the unit knows of the train it drives: REG turns force into a share of what motors and brakes can give, the
/// controllers scale their gains by mass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AtoTrainConfig {
    /// Empty mass, kg (S3).
    pub empty_kg: f64,
    /// Rotating parts as mass, kg (S3).
    pub rotating_kg: f64,
    /// Length over all cars, m.
    pub length_m: f64,
    /// Acceleration at full powering effort up to the base speed, km/h/s [S1, S3: 3.0].
    pub power_kmh_per_s: f64,
    /// Speed up to which this acceleration is there, km/h; constant power beyond [S1, S3: 40].
    pub base_speed_kmh: f64,
    /// Deceleration at full braking effort, km/h/s [S3: 3.5].
    pub brake_kmh_per_s: f64,
    /// Greatest change of effort, m/s³ of the acceleration it stands for [S1: 0.8].
    pub jerk_mps3: f64,
    /// Time from a command until inverters begin to follow it, ms.
    pub dead_time_ms: f64,
    /// Time constant with which they follow, ms.
    pub lag_ms: f64,
    /// Time from a command until the air brake begins to follow it, ms.
    pub air_dead_time_ms: f64,
    /// Time constant with which the air brake follows, ms.
    pub air_lag_ms: f64,
    /// Speed below which the electric brake hands over to air, km/h [S3: 15].
    pub air_from_kmh: f64,
    /// Speed below which the air brake works alone, km/h.
    pub air_alone_kmh: f64,
    /// Speed-proportional resistance, 1/s [S0: r = 0.001].
    pub drag_per_s: f64,
    /// Constant running resistance, kgf/t.
    pub rolling_kgf_t: f64,
    /// Curve resistance times radius, kgf·m/t [700/R].
    pub curve_kgf_m_t: f64,
}

/// Limits of ATO's monitoring of its inputs and of itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AtoWatchConfig {
    /// Difference, km/h, between the change of speed and what the efforts should have made of it: with a greater one
    /// the train does not follow.
    pub following_kmh: f64,
    /// Time with which this difference fades, and for which a speed must stay exactly the same to count as frozen, ms.
    pub following_ms: u32,
    /// Distance past the stop point that is an overrun, m.
    pub overrun_m: f64,
    /// Difference between distance by wheels and distance between markers that is a fault, share.
    pub wheel_error: f64,
}

/// How ATO inches to a stop point that it has missed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JogConfig {
    /// Greatest distance from the stop point from which it jogs, m; 0 = not at all.
    pub max_m: f64,
    /// Tries after a stop.
    pub tries: u8,
    /// Speed it jogs at, km/h.
    pub kmh: f64,
    /// Acceleration and deceleration, m/s².
    pub accel_mps2: f64,
}

impl Default for JogConfig {
    /// Values of `sg100`, for configurations without the table.
    fn default() -> Self {
        Self {
            max_m: 5.0,
            tries: 3,
            kmh: 2.5,
            accel_mps2: 0.25,
        }
    }
}

/// Parameters of automatic operation: limits of the run, the train, each speed controller.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AtoConfig {
    /// The speed controller in use.
    pub controller: ControllerKind,
    /// Target below the limit in recovery running, km/h.
    pub below_limit_kmh: f64,
    /// Further lowering in normal running mode, km/h [S0 §3.1.1]; both together are 5 in S2 §3.3.
    pub normal_lowering_kmh: f64,
    /// Target in slow running at most, km/h.
    #[serde(default = "super::way::thousandths::<25_000>")]
    pub slow_kmh: f64,
    /// Acceleration that ATO asks for at most, km/h/s [S0 §4: 3.0].
    pub accel_kmh_per_s: f64,
    /// Deceleration that ATO asks for at most, km/h/s [S0 §4: 3.5].
    pub decel_kmh_per_s: f64,
    /// Acceleration that ATO asks for at most where the stop point is nearer than from PSM2, m/s².
    pub gently_mps2: f64,
    /// What the unit knows of its train.
    pub train: AtoTrainConfig,
    /// How far the observer trusts a measured speed.
    pub observer: ObserverConfig,
    /// Poles and profile of the `servo` controller (S0).
    pub servo: ServoConfig,
    /// Jerk-limited profile of `pi` and `fuzzy`.
    pub profile: ProfileConfig,
    /// Gains of the `pi` controller (S1).
    pub pi: PiConfig,
    /// Peaks of the sets of the `fuzzy` controller (S1).
    pub fuzzy: FuzzyConfig,
    /// Station stop by distance, also of `pi` and `fuzzy`.
    pub pss: PssConfig,
    /// How a stop point that was missed is reached.
    #[serde(default)]
    pub jog: JogConfig,
    /// Limits of monitoring.
    pub watch: AtoWatchConfig,
}

impl AtoConfig {
    /// Checks ranges and that values fit together.
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        self.check_ranges()?;
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::UnitConfig;

    fn read_with(line: &str, instead: &str) -> Result<UnitConfig, ConfigError> {
        let text = include_str!("../../../../scripts/units/sg100.toml");
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
