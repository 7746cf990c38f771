//! Data of a train, a point mass or a train of cars, as in the files of `scripts/trains/`.

mod cars;
mod doors;

use serde::{Deserialize, Serialize};

use crate::tcms::TcmsData;
use crate::train::car_set::CarSet;

pub use cars::{
    AirBrake, CarData, CarsData, Davis, EffortAt, ElectricBrake, EmergencyBrake, Resistance, Role,
    Traction, Wheels,
};
pub use doors::DoorData;

/// Data of a train, checked when it comes from a file.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[schemars(untagged)]
#[expect(
    clippy::large_enum_variant,
    reason = "a bench has one, and most are trains of cars"
)]
pub enum TrainData {
    /// A point mass with ideal drive and brakes.
    Ideal(IdealData),
    /// A train of cars.
    Cars(CarsData),
}

/// The papers' point mass [S0 eq. 8].
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
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
    /// Speed up to which full power is available, km/h, constant power beyond; none = at all speeds.
    #[serde(default)]
    pub base_speed_kmh: Option<f64>,
    /// Full service brake, km/h/s.
    pub service_kmh_per_s: f64,
    /// Emergency brake, km/h/s.
    pub emergency_kmh_per_s: f64,
    /// Holding brake, share of full service (S4). The security brake is full service.
    pub holding_share: f64,
    /// Parking brake, share of full service.
    pub parking_share: f64,
    /// Gradients act on the train.
    pub gradients: bool,
    /// Doors of the train.
    #[serde(default)]
    pub doors: DoorData,
    /// Times and thresholds of its TCMS.
    pub tcms: TcmsData,
}

impl TrainData {
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
        built_in(include_str!("../../../../scripts/trains/ideal.toml"))
    }

    /// Name of the train.
    pub fn name(&self) -> &str {
        match self {
            Self::Ideal(data) => &data.name,
            Self::Cars(data) => &data.name,
        }
    }

    /// Passengers that the train can carry, kg.
    pub fn full_load_kg(&self) -> f64 {
        match self {
            Self::Ideal(data) => data.full_load_kg,
            Self::Cars(data) => data.cars.iter().map(|car| car.full_load_kg).sum(),
        }
    }

    /// Deceleration of the full service brake, km/h/s.
    pub fn service_kmh_per_s(&self) -> f64 {
        match self {
            Self::Ideal(data) => data.service_kmh_per_s,
            Self::Cars(data) => data.service_brake.kmh_per_s,
        }
    }

    pub fn doors(&self) -> &DoorData {
        match self {
            Self::Ideal(data) => &data.doors,
            Self::Cars(data) => &data.doors,
        }
    }

    /// Times and thresholds of its TCMS.
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

    /// Length of each car from the head, m, and its share of the train's weight.
    pub fn weight_shares(&self, load_kg: f64) -> Vec<(f64, f64)> {
        let cars = self.cars(load_kg);
        let weight_kg: f64 = cars.iter().map(|car| car.1).sum();
        cars.into_iter()
            .map(|(length_m, kg)| (length_m, kg / weight_kg))
            .collect()
    }

    /// Motor cars and trailers of the first MT pairs; a point mass has none.
    pub fn first_pairs(&self) -> [(CarSet, CarSet); 4] {
        std::array::from_fn(|at| match self {
            Self::Ideal(_) => Default::default(),
            Self::Cars(data) => data.pair_cars(at + 1),
        })
    }
}

fn built_in(text: &str) -> TrainData {
    TrainData::from_toml(text).unwrap_or_else(|e| panic!("built-in train: {e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE6: &str = include_str!("../../../../scripts/trains/line6.toml");

    /// Against the sums that S3 prints: empty mass, braking mass full, brake force at B7 full; S3 rounds after adding
    /// up.
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
    fn an_impossible_train_is_refused_and_the_key_is_named() {
        let cut = LINE6.find("[[cars]]").unwrap_or(LINE6.len());
        // The train without the first car of this name.
        let without = |name: &str| {
            let named = format!("[[cars]]\nname = \"{name}\"");
            let from = LINE6.find(&named).unwrap_or(LINE6.len());
            let next = LINE6[from + 1..].find("[[cars]]").unwrap_or(0);
            format!("{}{}", &LINE6[..from], &LINE6[from + 1 + next..])
        };
        let rows = include_str!("wrong_trains.txt").lines().skip(1);
        let changed = rows.map(|row| {
            let [there, instead, words] = row.split(" | ").collect::<Vec<_>>()[..] else {
                panic!("{row}")
            };
            let there = there.replace("\\n", "\n");
            assert!(LINE6.contains(&there), "{row}");
            (LINE6.replace(&there, &instead.replace("\\n", "\n")), words)
        });
        let twice = format!("{LINE6}{}", &LINE6[cut..]);
        for (text, words) in changed.chain([
            (LINE6[..cut].to_owned(), "cars"),
            (without("M1"), "pair 1: a pair needs a motor car"),
            (twice, "cars = 16 is outside 1 .. 12"),
        ]) {
            let error = TrainData::from_toml(&text).unwrap_err().to_string();
            assert!(error.contains(words), "{words}: {error}");
        }
    }
}
