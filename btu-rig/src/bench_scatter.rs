//! Scatter of good units, trains and benches: values drawn at random for each of many runs of check
//! procedures.

use protocol::Duration;
use protocol::Random;
use protocol::config::ConfigError;
use serde::{Deserialize, Serialize};

use crate::conditions::{Conditions, Sensors};
use crate::drive::Scatter;
use crate::drive::scatter::{Spread, check_spreads};

/// Mixed into the seed, so that the draws here differ from those of train and day by the same seed.
const OWN_SEQUENCE: u64 = 0xBE7C_45CA_77E2_0B1D;

/// Spreads of all that differs from run to run; see `scripts/bench_scatter.toml`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BenchScatter {
    /// Train and track.
    pub train: Scatter,
    /// Antenna and tachometers.
    pub sensors: SensorScatter,
    /// When things happen.
    pub timing: TimingScatter,
}

/// Deviations of the sensors; each is one of [`Sensors`].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SensorScatter {
    /// Level in the antenna divided by the intended one.
    pub level_factor: Spread,
    /// Noise of the level, as a share.
    pub level_noise: Spread,
    /// Added to the carrier, Hz.
    pub carrier_offset_hz: Spread,
    /// Added to the code rate, Hz.
    pub rate_offset_hz: Spread,
    /// Noise of the code rate, Hz.
    pub rate_jitter_hz: Spread,
    /// Displacement of each tooth from its place, share of the pitch.
    pub tooth_pitch: Spread,
    /// Spurious pulses of a channel, 1/s.
    pub spurious_pulses_per_s: Spread,
}

/// When the unit is powered up and how long frames take; each field is one of [`Timing`].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TimingScatter {
    /// Time from the start of a bench cycle to power-up, ms.
    pub power_up_ms: Spread,
    /// Time that a frame to the unit is on its way, ms.
    pub to_unit_ms: Spread,
    /// Time that a frame from the unit is on its way, ms.
    pub from_unit_ms: Spread,
    /// Share of scans whose frames come one scan later than that.
    pub late_share: Spread,
}

/// When a unit is powered up, and how long frames are on their way. The default is no delay.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    /// Time from the start of a bench cycle to power-up.
    pub power_up: Duration,
    /// Time that a frame to the unit is on its way.
    pub to_unit: Duration,
    /// Time that a frame from the unit is on its way.
    pub from_unit: Duration,
    /// Share of scans whose frames come one scan later than that.
    pub late_share: f64,
}

/// What was drawn for one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchDraw {
    /// Passengers where a procedure says nothing of them, kg.
    pub load_kg: f64,
    /// Train and track.
    pub conditions: Conditions,
    /// Antenna and tachometers.
    pub sensors: Sensors,
    /// When things happen.
    pub timing: Timing,
}

impl BenchScatter {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// The first thing wrong: syntax with line and column, or a spread that cannot be.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        let scatter: Self =
            toml::from_str(text).map_err(|error| ConfigError::Syntax(error.to_string()))?;
        scatter.train.check()?;
        check_spreads! { SensorScatter = scatter.sensors;
            level_factor: 0.1, 10.0;
            level_noise: 0.0, 0.2;
            carrier_offset_hz: -500.0, 500.0;
            rate_offset_hz: -5.0, 5.0;
            rate_jitter_hz: 0.0, 5.0;
            tooth_pitch: 0.0, 0.1;
            spurious_pulses_per_s: 0.0, 100.0;
        }?;
        check_spreads! { TimingScatter = scatter.timing;
            power_up_ms: 0.0, 1000.0;
            to_unit_ms: 0.0, 100.0;
            from_unit_ms: 0.0, 100.0;
            late_share: 0.0, 0.5;
        }?;
        Ok(scatter)
    }

    /// Draws a run's unit, train and bench; the same for the same `seed`.
    pub fn draw(&self, seed: u64, full_load_kg: f64) -> BenchDraw {
        let train = self.train.draw(seed, full_load_kg);
        let random = &mut Random::new(seed ^ OWN_SEQUENCE);
        let (sensors, timing) = (&self.sensors, &self.timing);
        let ms =
            |spread: Spread, random: &mut Random| Duration::from_secs(spread.draw(random) / 1e3);
        BenchDraw {
            load_kg: train.load_kg,
            conditions: train.conditions,
            sensors: Sensors {
                level_factor: sensors.level_factor.draw(random),
                level_noise: sensors.level_noise.draw(random),
                carrier_offset_hz: sensors.carrier_offset_hz.draw(random),
                rate_offset_hz: sensors.rate_offset_hz.draw(random),
                rate_jitter_hz: sensors.rate_jitter_hz.draw(random),
                tooth_pitch: sensors.tooth_pitch.draw(random),
                teeth_seed: random.bits(),
                spurious_pulses_per_s: sensors.spurious_pulses_per_s.draw(random),
            },
            timing: Timing {
                power_up: ms(timing.power_up_ms, random),
                to_unit: ms(timing.to_unit_ms, random),
                from_unit: ms(timing.from_unit_ms, random),
                late_share: timing.late_share.draw(random),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = include_str!("../../scripts/bench_scatter.toml");

    /// Goal: the same seed gives the same unit, another seed another one, all within the file's ranges.
    #[test]
    fn draws_repeat_and_stay_within_the_file() {
        let scatter = BenchScatter::from_toml(FILE).unwrap();
        let drawn: Vec<_> = (0..1000).map(|seed| scatter.draw(seed, 160e3)).collect();
        assert_eq!(scatter.draw(77, 160e3), drawn[77]);
        let of = |value: fn(&BenchDraw) -> f64| {
            let values = drawn.iter().map(value);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            })
        };
        let (low, high) = of(|d| d.sensors.level_factor);
        assert!((0.85..0.86).contains(&low) && (1.14..1.15).contains(&high));
        let (low, high) = of(|d| d.timing.to_unit.as_secs());
        assert!((0.0..0.001).contains(&low) && (0.015..=0.016).contains(&high));
        let (low, high) = of(|d| d.conditions.brake_factor);
        assert!((0.97..0.98).contains(&low) && (1.02..1.03).contains(&high));
    }

    #[test]
    fn an_impossible_bench_is_refused_and_the_key_is_named() {
        for (from, to, words) in [
            (
                "late_share = { low = 0.0, high = 0.02 }",
                "late_share = { low = 0, high = 2 }",
                "late_share",
            ),
            (
                "tooth_pitch = { low = 0.0",
                "tooth_pitch = { low = -0.1",
                "tooth_pitch",
            ),
            ("high = 0.33", "high = 3.3", "adhesion"),
            ("level_noise", "level_nose", "level_nose"),
            ("[timing]", "[timings]", "timings"),
        ] {
            assert!(FILE.contains(from), "{from}");
            let error = BenchScatter::from_toml(&FILE.replace(from, to)).unwrap_err();
            assert!(error.to_string().contains(words), "{to}: {error}");
        }
    }
}
