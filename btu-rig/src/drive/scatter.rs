//! Scatter of trains, tracks and sensors: values drawn at random for each of many runs.

use std::collections::BTreeMap;

use protocol::Random;
use protocol::config::ConfigError;
use serde::de::{Deserialize, Deserializer, Error};

use crate::conditions::{Conditions, Disturbance, MAX_DELAY_FACTOR};
use crate::random::standard_normal;

/// A quantity that differs from run to run.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
#[serde(untagged)]
pub enum Spread {
    /// Any value of a range as likely as any other.
    Uniform {
        /// Least value, in the quantity's unit.
        low: f64,
        /// Greatest value, in the quantity's unit.
        high: f64,
    },
    /// Normal distribution.
    Normal {
        /// Mean, in the quantity's unit.
        mean: f64,
        /// Standard deviation, in the quantity's unit.
        sigma: f64,
    },
}

impl<'de> Deserialize<'de> for Spread {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let wrong = || D::Error::custom("use { low, high } or { mean, sigma }, all numbers");
        let table = BTreeMap::<String, f64>::deserialize(from).map_err(|_| wrong())?;
        let pairs: Vec<_> = table
            .iter()
            .map(|(key, value)| (key.as_str(), *value))
            .collect();
        match pairs[..] {
            [("high", high), ("low", low)] => Ok(Self::Uniform { low, high }),
            [("mean", mean), ("sigma", sigma)] => Ok(Self::Normal { mean, sigma }),
            _ => Err(wrong()),
        }
    }
}

impl Spread {
    pub(crate) fn draw(self, random: &mut Random) -> f64 {
        // Both kinds take two numbers, so that changing one quantity leaves the others as they are.
        let (first, second) = (random.unit(), random.unit());
        match self {
            Self::Uniform { low, high } => low + (high - low) * first,
            Self::Normal { mean, sigma } => mean + sigma * standard_normal(first, second),
        }
    }

    pub(crate) fn check(self, key: &str, low: f64, high: f64) -> Result<(), ConfigError> {
        let (least, most) = self.range();
        // A negated comparison so that not-a-number is refused, too.
        if !(low <= least && least <= most && most <= high) {
            return Err(ConfigError::Conflict(format!(
                "{key}: values from {least} to {most} are not all within {low} to {high}"
            )));
        }
        Ok(())
    }

    /// Least and greatest believable value; of a normal distribution, the bounds of all values but one in 15 000.
    fn range(self) -> (f64, f64) {
        match self {
            Self::Uniform { low, high } => (low, high),
            Self::Normal { mean, sigma } => (mean - 4.0 * sigma, mean + 4.0 * sigma),
        }
    }
}

/// Refuses spreads that leave their permitted range. Each line has a key with its least and greatest value; each field
/// of the type must have a line.
macro_rules! check_spreads {
    ($type:ident = $of:expr; $($key:ident: $low:expr, $high:expr;)+) => {{
        let $type { $($key),+ } = $of;
        let checked = [$($key.check(stringify!($key), $low, $high)),+];
        checked.into_iter().collect::<Result<(), ConfigError>>()
    }};
}
pub(crate) use check_spreads;

/// Quantities that differ from run to run; see `scripts/scatter.toml`.
#[derive(
    Clone, Copy, Debug, PartialEq, serde::Deserialize, schemars::JsonSchema, serde::Serialize,
)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// Passengers, kg; what the train cannot carry stays behind.
    pub load_kg: Spread,
    /// Gradient added to every gradient of the track, ‰.
    pub gradient_offset_permille: Spread,
    /// Wheel–rail adhesion coefficient at standstill.
    pub adhesion: Spread,
    /// Factor on dead times and time constants of traction and brakes.
    pub delay_factor: Spread,
    /// Factor on braking effort.
    pub brake_factor: Spread,
    /// Ratio of the true wheel diameter to the configured one.
    pub wheel_factor: Spread,
    /// Shift of each marker's pulse along the track, by how the marker is laid and how antenna and TRA receive it, m.
    pub marker_offset_m: Spread,
}

/// Values drawn for one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterDraw {
    /// Passengers, kg.
    pub load_kg: f64,
    /// The other quantities.
    pub conditions: Conditions,
}

impl Scatter {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// The first thing wrong: syntax with line and column, or a spread no train can have.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        let scatter: Self =
            toml::from_str(text).map_err(|error| ConfigError::Syntax(error.to_string()))?;
        scatter.check()?;
        Ok(scatter)
    }

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        check_spreads! { Scatter = self;
            load_kg: 0.0, 1e6;
            gradient_offset_permille: -50.0, 50.0;
            adhesion: 0.02, 0.6;
            delay_factor: 0.0, MAX_DELAY_FACTOR;
            brake_factor: 0.2, 2.0;
            wheel_factor: 0.8, 1.2;
            marker_offset_m: -5.0, 5.0;
        }
    }

    /// Draws the values of one run; equal seeds give equal values. The load is at most `full_load_kg`.
    pub fn draw(&self, seed: u64, full_load_kg: f64) -> ScatterDraw {
        let random = &mut Random::new(seed);
        ScatterDraw {
            load_kg: self.load_kg.draw(random).clamp(0.0, full_load_kg),
            conditions: Conditions {
                gradient_offset_permille: self.gradient_offset_permille.draw(random),
                adhesion: self.adhesion.draw(random),
                delay_factor: self.delay_factor.draw(random),
                brake_factor: self.brake_factor.draw(random),
                wheel_factor: self.wheel_factor.draw(random),
                marker_offsets_m: [(); 4].map(|()| self.marker_offset_m.draw(random)),
                disturbance: Disturbance::None,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = include_str!("../../../scripts/scatter.toml");

    /// Means and spreads of 10 000 draws against the file: load uniform to 160 t, brakes 1 ± 3 %.
    #[test]
    fn draws_have_the_spread_the_file_says_and_repeat() {
        let scatter = Scatter::from_toml(FILE).unwrap();
        let drawn: Vec<_> = (0..10_000)
            .map(|seed| scatter.draw(seed, 160_000.0))
            .collect();
        let spread = |of: fn(&ScatterDraw) -> f64| {
            let mean = drawn.iter().map(of).sum::<f64>() / 1e4;
            let var = drawn.iter().map(|d| (of(d) - mean).powi(2)).sum::<f64>() / 1e4;
            (mean, var.sqrt())
        };
        let (load, _) = spread(|d| d.load_kg);
        assert!((load - 80_000.0).abs() < 1_500.0, "{load}");
        let (brake, sigma) = spread(|d| d.conditions.brake_factor);
        assert!(
            (brake - 1.0).abs() < 1e-3 && (sigma - 0.03).abs() < 1e-3,
            "{brake} {sigma}"
        );
        let (_, third) = spread(|d| d.conditions.marker_offsets_m[2]);
        assert!((third - 0.02).abs() < 1e-3, "{third}");
        assert_eq!(scatter.draw(77, 160_000.0), drawn[77]);
    }

    #[test]
    fn an_error_in_a_spread_names_its_place_and_the_permitted_forms() {
        for instead in [
            "0.03",
            "{ spread = 0.03 }",
            "{ low = 1 }",
            "{ low = 1, sigma = 2 }",
        ] {
            let text = FILE.replace("{ mean = 1.0, sigma = 0.03 }", instead);
            let error = Scatter::from_toml(&text).unwrap_err().to_string();
            assert!(
                error.contains("use { low, high } or { mean, sigma }"),
                "{error}"
            );
            assert!(error.contains("brake_factor = "), "{error}");
        }
    }

    #[test]
    fn an_impossible_spread_is_refused_and_the_key_is_named() {
        let good = "load_kg = { low = 0, high = 1e5 }
            gradient_offset_permille = { mean = 0, sigma = 1 }
            adhesion = { low = 0.1, high = 0.3 }
            delay_factor = { low = 0.7, high = 1.3 }
            brake_factor = { mean = 1, sigma = 0.03 }
            wheel_factor = { low = 0.99, high = 1.01 }
            marker_offset_m = { mean = 0, sigma = 0.02 }";
        assert!(Scatter::from_toml(good).is_ok());
        for (from, to, words) in [
            ("high = 0.3", "high = 2.5", "adhesion"),
            ("low = 0.1,", "low = 0.4,", "adhesion"),
            ("sigma = 0.03", "sigma = 0.3", "brake_factor"),
            ("sigma = 0.03", "sigma = nan", "brake_factor"),
            ("sigma = 0.03", "spread = 0.03", "brake_factor"),
            ("wheel_factor", "weel_factor", "weel_factor"),
        ] {
            let error = Scatter::from_toml(&good.replace(from, to)).unwrap_err();
            assert!(error.to_string().contains(words), "{to}: {error}");
        }
    }
}
