//! Data of a train as files have it; see `scripts/trains/`.

use protocol::config::ConfigError;
use serde::{Deserialize, Serialize};

use super::actuator::Times;
use super::car_set::CarSet;
use super::check;
use crate::tcms::TcmsData;

/// Data of a train, checked when it comes from a file.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub enum TrainData {
    /// A point mass with ideal drive and brakes.
    Ideal(IdealData),
    /// A train of cars.
    Cars(CarsData),
}

/// The papers' point mass [S0 eq. 8].
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct IdealData {
    /// Name of the train.
    pub name: String,
    /// Always `ideal`.
    pub model: String,
    /// Mass without passengers, kg.
    pub mass_kg: f64,
    /// Greatest passenger load, kg.
    pub full_load_kg: f64,
    /// Length, m.
    pub length_m: f64,
    /// Resistance r, 1/s.
    pub drag_per_s: f64,
    /// Acceleration at full power, km/h/s.
    pub power_kmh_per_s: f64,
    /// Speed up to which it is there, km/h, constant power beyond; none = at all speeds.
    #[serde(default)]
    pub base_speed_kmh: Option<f64>,
    /// Full service brake, km/h/s.
    pub service_kmh_per_s: f64,
    /// Emergency brake, km/h/s.
    pub emergency_kmh_per_s: f64,
    /// Holding brake, share of full service (S4). The security brake is all of it.
    pub holding_share: f64,
    /// Parking brake, share of full service.
    pub parking_share: f64,
    /// Gradients act on it.
    pub gradients: bool,
    /// Its TCMS.
    pub tcms: TcmsData,
}

/// A train of cars.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CarsData {
    /// Name of the train.
    pub name: String,
    /// Always `cars`.
    pub model: String,
    /// Car whose axle carries the tachometers, counted from 1.
    pub tachometer_car: usize,
    /// Powering.
    pub traction: Traction,
    /// Electric brake.
    pub electric_brake: ElectricBrake,
    /// Service brake, and the air brake that makes up for what is not electric.
    pub service_brake: AirBrake,
    /// Emergency brake.
    pub emergency_brake: EmergencyBrake,
    /// What resists motion.
    pub resistance: Resistance,
    /// Slip, slide and the protection against it.
    pub wheels: Wheels,
    /// Its TCMS.
    pub tcms: TcmsData,
    /// The cars from the head.
    pub cars: Vec<CarData>,
}

/// Powering.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Traction {
    /// Force of the whole train at full power and full load, N [S3 eq. 1].
    pub full_load_n: f64,
    /// Speed up to which it is there, km/h; constant power beyond (S3).
    pub base_speed_kmh: f64,
    /// Greatest change of powering and service braking effort, m/s³ (S1).
    pub jerk_mps3: f64,
    /// Command to the inverters' first answer, s.
    pub dead_time_s: f64,
    /// Time constant of their effort, s.
    pub lag_s: f64,
}

/// Electric brake of the motor cars.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ElectricBrake {
    /// Its greatest force over the car's weight [S3 eq. 6].
    pub adhesion_limit: f64,
    /// Speed up to which it is there, km/h; constant power beyond.
    pub full_to_kmh: f64,
    /// Speed below which it fades, km/h (S3).
    pub fade_from_kmh: f64,
    /// Speed at which nothing is left, km/h.
    pub fade_to_kmh: f64,
}

/// Service brake.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AirBrake {
    /// Full service brake, km/h/s [S3: B7].
    pub kmh_per_s: f64,
    /// Holding brake, share of full service (S4).
    pub holding_share: f64,
    /// Demand to the first force of air, s.
    pub dead_time_s: f64,
    /// Time constant while it builds up, s.
    pub build_up_s: f64,
    /// Time constant while it is released, s.
    pub release_s: f64,
    /// Security brake, share of full service; hard-wired, air on all cars.
    pub security_share: f64,
    /// Parking brake, share of full service; springs on all cars.
    pub parking_share: f64,
}

/// Emergency brake, by air alone (S3).
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct EmergencyBrake {
    /// Its deceleration, km/h/s.
    pub kmh_per_s: f64,
    /// Opening of the loop to the first force, s.
    pub dead_time_s: f64,
    /// Time constant while it builds up, s.
    pub build_up_s: f64,
    /// Time constant while it is released, s.
    pub release_s: f64,
}

/// What resists motion.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Resistance {
    /// Resistance when starting from rest, kgf/t.
    pub starting_kgf_t: f64,
    /// Speed up to which it counts, km/h.
    pub starting_kmh: f64,
    /// Rolling resistance, kgf/t.
    pub rolling_kgf_t: f64,
    /// Its rise with speed, kgf/t per km/h.
    pub rolling_kgf_t_per_kmh: f64,
    /// Air resistance of the whole train, kgf per (km/h)².
    pub air_kgf_per_kmh2: f64,
    /// Resistance of a tunnel, kgf/t.
    pub tunnel_kgf_t: f64,
    /// Curve resistance times radius, kgf·m/t.
    pub curve_kgf_m_t: f64,
}

/// Slip, slide and the protection against it.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Wheels {
    /// Friction of a sliding wheel over adhesion.
    pub sliding_share: f64,
    /// Difference to the train's speed at which effort is taken off, m/s.
    pub protection_mps: f64,
    /// Time in which all effort is taken off, s.
    pub release_s: f64,
    /// Time in which all of it is given back, s.
    pub restore_s: f64,
}

/// One car.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CarData {
    /// Name, for instance `M1`.
    pub name: String,
    /// Motored or not.
    pub role: Role,
    /// MT pair it belongs to, counted from 1. Cars of a pair share a demand: electric first, then air
    /// on trailers, then on motor cars (S3).
    pub pair: usize,
    /// Length, m.
    pub length_m: f64,
    /// Empty mass, kg.
    pub empty_kg: f64,
    /// Of that its bogies, kg.
    pub bogies_kg: f64,
    /// Rotating parts as mass, kg.
    pub rotating_kg: f64,
    /// Greatest passenger load, kg.
    pub full_load_kg: f64,
    /// Greatest force of its air brake in service, N.
    pub air_n: f64,
}

impl CarData {
    /// Weight with a share of its passengers, kg.
    pub fn weight_kg(&self, share: f64) -> f64 {
        self.empty_kg + share * self.full_load_kg
    }

    /// Braking mass full, kg (S3).
    pub fn full_inertia_kg(&self) -> f64 {
        self.empty_kg + self.rotating_kg + self.full_load_kg
    }
}

/// Whether a car is driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// With motors and electric brake.
    Motor,
    /// Without.
    Trailer,
}

/// The one key all models have.
#[derive(Deserialize)]
struct Kind {
    model: String,
}

impl TrainData {
    /// Reads and checks a train file.
    ///
    /// # Errors
    /// The first thing wrong: syntax with line and column, or a train that cannot be.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        let Kind { model } = parse(text)?;
        let data = match model.as_str() {
            "ideal" => Self::Ideal(parse(text)?),
            "cars" => Self::Cars(parse(text)?),
            _ => {
                return Err(ConfigError::Conflict(format!(
                    "model \"{model}\" must be ideal or cars"
                )));
            }
        };
        match &data {
            Self::Ideal(ideal) => check::ideal(ideal)?,
            Self::Cars(cars) => check::cars(cars)?,
        }
        Ok(data)
    }

    /// The train of eight cars of line 6 (S3).
    ///
    /// # Panics
    /// Never: a test reads the same text.
    pub fn line6() -> Self {
        Self::Cars(CarsData::line6())
    }

    /// The point mass of S0: 200 t, r = 0.001 1/s, 3.0 and 3.5 km/h/s.
    ///
    /// # Panics
    /// Never: a test reads the same text.
    pub fn ideal() -> Self {
        built_in(include_str!("../../../scripts/trains/ideal.toml"))
    }

    /// Name of the train.
    pub fn name(&self) -> &str {
        match self {
            Self::Ideal(data) => &data.name,
            Self::Cars(data) => &data.name,
        }
    }

    /// Passengers it can carry, kg.
    pub fn full_load_kg(&self) -> f64 {
        match self {
            Self::Ideal(data) => data.full_load_kg,
            Self::Cars(data) => data.cars.iter().map(|car| car.full_load_kg).sum(),
        }
    }

    /// Its TCMS.
    pub fn tcms(&self) -> &TcmsData {
        match self {
            Self::Ideal(data) => &data.tcms,
            Self::Cars(data) => &data.tcms,
        }
    }

    /// Length and weight of each car from the head, m and kg, with these passengers spread over
    /// the train.
    pub fn cars(&self, load_kg: f64) -> Vec<(f64, f64)> {
        match self {
            Self::Ideal(data) => vec![(data.length_m, data.mass_kg + load_kg)],
            Self::Cars(data) => {
                let share = load_kg / self.full_load_kg().max(1.0);
                let cars = data.cars.iter();
                cars.map(|c| (c.length_m, c.weight_kg(share))).collect()
            }
        }
    }
}

impl CarsData {
    /// The train of [`TrainData::line6`].
    ///
    /// # Panics
    /// Never: a test reads the same text.
    pub fn line6() -> Self {
        match built_in(include_str!("../../../scripts/trains/line6.toml")) {
            TrainData::Cars(data) => data,
            TrainData::Ideal(_) => panic!("built-in train: line6 is no point mass"),
        }
    }

    /// Cars with an inverter.
    pub fn motor_cars(&self) -> CarSet {
        self.cars_where(|car| car.role == Role::Motor)
    }

    /// Motor cars and trailers of an MT pair, counted from 1.
    pub fn pair_cars(&self, pair: usize) -> (CarSet, CarSet) {
        let all = self.cars_where(|car| car.pair == pair);
        let trailers = all.without(self.motor_cars());
        (all.without(trailers), trailers)
    }

    fn cars_where(&self, holds: impl Fn(&CarData) -> bool) -> CarSet {
        let mut cars = CarSet::NONE;
        for (i, car) in self.cars.iter().enumerate() {
            cars.set(i, holds(car));
        }
        cars
    }

    /// How inverters follow a demand.
    pub(crate) fn motor_times(&self) -> Times {
        Times {
            dead_s: self.traction.dead_time_s,
            rise_s: self.traction.lag_s,
            fall_s: self.traction.lag_s,
        }
    }

    /// How air brakes follow a demand.
    pub(crate) fn air_times(&self) -> Times {
        Times {
            dead_s: self.service_brake.dead_time_s,
            rise_s: self.service_brake.build_up_s,
            fall_s: self.service_brake.release_s,
        }
    }
}

fn parse<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, ConfigError> {
    toml::from_str(text).map_err(|e| ConfigError::Syntax(e.to_string()))
}

fn built_in(text: &str) -> TrainData {
    TrainData::from_toml(text).unwrap_or_else(|e| panic!("built-in train: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE6: &str = include_str!("../../../scripts/trains/line6.toml");

    /// Against the sums S3 prints: empty, braking mass full, brake force at B7 full; it adds up
    /// what it rounds afterwards.
    #[test]
    fn line_6_adds_up_to_the_printed_sums() {
        let train = CarsData::line6();
        let sum = |f: fn(&CarData) -> f64| train.cars.iter().map(f).sum::<f64>();
        assert_eq!(sum(|c| c.empty_kg), 268_807.0);
        let full_kg = sum(CarData::full_inertia_kg);
        assert!((full_kg - 456_368.0).abs() <= 1.0, "{full_kg}");
        assert!((sum(|c| c.air_n) - 443_691.0).abs() <= 4.0);
        assert_eq!(TrainData::ideal().full_load_kg(), 160_000.0);
    }

    #[test]
    fn what_cannot_be_is_refused_by_name() {
        let cut = LINE6.find("[[cars]]").unwrap_or(LINE6.len());
        // The train less the first car of a name.
        let without = |name: &str| {
            let named = format!("[[cars]]\nname = \"{name}\"");
            let from = LINE6.find(&named).unwrap_or(LINE6.len());
            let next = LINE6[from + 1..].find("[[cars]]").unwrap_or(0);
            format!("{}{}", &LINE6[..from], &LINE6[from + 1 + next..])
        };
        for (text, words) in [
            (
                LINE6.replace("empty_kg = 33552", "empty_kg = -1"),
                "cars 1 (TC1): empty_kg",
            ),
            (
                LINE6.replace("role = \"motor\"", "role = \"pusher\""),
                "pusher",
            ),
            (LINE6.replace("lag_s = 0.20", ""), "lag_s"),
            (
                LINE6.replace("lag_s = 0.20", "lag_s = nan"),
                "traction.lag_s",
            ),
            (LINE6.replace("lag_s", "lagging_s"), "lagging_s"),
            (LINE6[..cut].to_owned(), "cars"),
            (
                LINE6.replace("tachometer_car = 1", "tachometer_car = 9"),
                "tachometer_car",
            ),
            (
                LINE6.replace("model = \"cars\"", "model = \"maglev\""),
                "maglev",
            ),
            (
                LINE6.replace("fade_to_kmh = 5", "fade_to_kmh = 15"),
                "fade_to_kmh",
            ),
            (
                LINE6.replace("role = \"motor\"", "role = \"trailer\""),
                "motor car",
            ),
            (LINE6.replace("air_n = 54022", "air_n = 5402"), "pair 1"),
            (
                LINE6.replace("rotating_kg = 4999", "rotating_kg = -4999"),
                "cars 2 (M1): rotating_kg",
            ),
            (
                LINE6.replace("full_load_kg = 20000", "full_load_kg = -1"),
                "cars 1 (TC1): full_load_kg",
            ),
            (
                LINE6.replace("bogies_kg = 13913", "bogies_kg = 40000"),
                "cars 2 (M1): bogies_kg",
            ),
            (
                LINE6.replace("empty_kg = 29378", "empty_kg = nan"),
                "cars 5 (T2): empty_kg",
            ),
            (
                LINE6.replace("air_n = 49720", "air_n = inf"),
                "cars 5 (T2): air_n",
            ),
            (LINE6.replace("pair = 4", "pair = 5"), "pair 4"),
            (LINE6.replace("pair = 4", "pair = 0"), "cars 7 (M2): pair"),
            (without("M1"), "pair 1: a pair needs a motor car"),
            (
                format!("{LINE6}{}", &LINE6[cut..]),
                "cars = 16 is outside 1 .. 12",
            ),
            (LINE6.replace("bogies_kg = 10600\n", ""), "bogies_kg"),
            (
                LINE6.replace("security_share = 1.0", "security_share = 0.4"),
                "service_brake.security_share",
            ),
        ] {
            let error = TrainData::from_toml(&text).unwrap_err().to_string();
            assert!(error.contains(words), "{words}: {error}");
        }
    }
}
