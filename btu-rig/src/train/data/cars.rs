//! Data of a train of cars: traction, brakes, resistance, wheels and each car.

use serde::{Deserialize, Serialize};

use super::{DoorData, TrainData, built_in};
use crate::tcms::TcmsData;
use crate::train::actuator::Times;
use crate::train::car_set::CarSet;

/// A train of cars.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
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
    /// Electric brake of the motor cars.
    pub electric_brake: ElectricBrake,
    /// Service brake, and the air brake that makes up for what is not electric.
    pub service_brake: AirBrake,
    /// Emergency brake.
    pub emergency_brake: EmergencyBrake,
    /// Resistance to motion.
    pub resistance: Resistance,
    /// Slip, slide and the protection against it.
    pub wheels: Wheels,
    /// Doors of the train.
    #[serde(default)]
    pub doors: DoorData,
    /// Times and thresholds of the train's TCMS.
    pub tcms: TcmsData,
    /// The cars from the head.
    pub cars: Vec<CarData>,
}

/// Powering.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Traction {
    /// Force of the whole train at full power and full load, N [S3 eq. 1].
    pub full_load_n: f64,
    /// Speed up to which the full force is available, km/h; constant power beyond (S3).
    pub base_speed_kmh: f64,
    /// Force at full load at rising speeds; then `base_speed_kmh` is not read. Constant power beyond the last speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub efforts: Option<Vec<EffortAt>>,
    /// Greatest change of powering and service braking effort, m/s³ (S1).
    pub jerk_mps3: f64,
    /// Time from a command to the inverters' first answer, s.
    pub dead_time_s: f64,
    /// Time constant of the inverters' effort, s.
    pub lag_s: f64,
}

/// Tractive effort of a train at a speed.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct EffortAt {
    /// Speed, km/h.
    pub kmh: f64,
    /// Force of the whole train, N, at most `full_load_n`.
    pub n: f64,
}

impl Traction {
    /// Force available at a speed, share of the greatest (S3: TE_v).
    pub fn share_at(&self, speed_mps: f64) -> f64 {
        let Some(efforts) = &self.efforts else {
            let base_mps = self.base_speed_kmh / 3.6;
            return base_mps / speed_mps.max(base_mps);
        };
        let kmh = speed_mps * 3.6;
        let after = efforts.partition_point(|effort| effort.kmh <= kmh);
        let before = after.checked_sub(1).map(|place| efforts[place]);
        let n = match (before, efforts.get(after)) {
            (Some(low), Some(high)) => {
                low.n + (high.n - low.n) * (kmh - low.kmh) / (high.kmh - low.kmh)
            }
            (Some(last), None) => last.n * last.kmh / kmh.max(last.kmh),
            (None, first) => first.map_or(0.0, |first| first.n),
        };
        n / self.full_load_n
    }
}

/// Electric brake of the motor cars.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ElectricBrake {
    /// Greatest force of the brake divided by the car's weight [S3 eq. 6].
    pub adhesion_limit: f64,
    /// Speed up to which the greatest force is available, km/h; constant power beyond.
    pub full_to_kmh: f64,
    /// Speed below which the brake fades, km/h (S3).
    pub fade_from_kmh: f64,
    /// Speed at which no electric brake is left, km/h.
    pub fade_to_kmh: f64,
}

/// Service brake.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AirBrake {
    /// Full service brake, km/h/s [S3: B7].
    pub kmh_per_s: f64,
    /// Holding brake, share of full service (S4).
    pub holding_share: f64,
    /// Time from a demand to the first force of air, s.
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
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct EmergencyBrake {
    /// Deceleration, km/h/s.
    pub kmh_per_s: f64,
    /// Time from the opening of the brake loop to the first force, s.
    pub dead_time_s: f64,
    /// Time constant while it builds up, s.
    pub build_up_s: f64,
    /// Time constant while it is released, s.
    pub release_s: f64,
}

/// Resistance to motion.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Resistance {
    /// Resistance when starting from rest, kgf/t.
    pub starting_kgf_t: f64,
    /// Speed up to which the starting resistance counts, km/h.
    pub starting_kmh: f64,
    /// Rolling resistance, kgf/t.
    pub rolling_kgf_t: f64,
    /// Rise of rolling resistance with speed, kgf/t per km/h.
    pub rolling_kgf_t_per_kmh: f64,
    /// Air resistance of the whole train, kgf per (km/h)².
    pub air_kgf_per_kmh2: f64,
    /// Resistance of a tunnel, kgf/t.
    pub tunnel_kgf_t: f64,
    /// Curve resistance times radius, kgf·m/t.
    pub curve_kgf_m_t: f64,
    /// Davis formula in place of rolling and air resistance, which are then 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub davis: Option<Davis>,
}

/// Davis' formula A + B·v + C·v² for the whole train, whatever its load.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Davis {
    /// A, N.
    pub a_n: f64,
    /// B, N per km/h.
    pub b_n_per_kmh: f64,
    /// C, N per (km/h)².
    pub c_n_per_kmh2: f64,
}

/// Slip, slide and the protection against it.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Wheels {
    /// Friction of a sliding wheel divided by the adhesion of a rolling one.
    pub sliding_share: f64,
    /// Difference to the train's speed at which effort is taken off, m/s.
    pub protection_mps: f64,
    /// Time in which all effort is taken off, s.
    pub release_s: f64,
    /// Time in which all effort is given back, s.
    pub restore_s: f64,
}

/// One car.
#[derive(Clone, Debug, PartialEq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CarData {
    /// Name, for instance `M1`.
    pub name: String,
    /// With motors or without.
    pub role: Role,
    /// MT pair of the car, counted from 1. Cars of a pair share a demand: electric first, then air
    /// on trailers, then on motor cars (S3).
    pub pair: usize,
    /// Length, m.
    pub length_m: f64,
    /// Empty mass, kg.
    pub empty_kg: f64,
    /// Mass of the bogies, which is part of the empty mass, kg.
    pub bogies_kg: f64,
    /// Mass that stands for the inertia of rotating parts, kg.
    pub rotating_kg: f64,
    /// Greatest passenger load, kg.
    pub full_load_kg: f64,
    /// Greatest force of the car's air brake in service, N.
    pub air_n: f64,
}

impl CarData {
    /// Weight with a share of its passengers, kg.
    pub fn weight_kg(&self, share: f64) -> f64 {
        self.empty_kg + share * self.full_load_kg
    }

    /// Mass that is braked at full load, with rotating parts, kg (S3).
    pub fn full_inertia_kg(&self) -> f64 {
        self.empty_kg + self.rotating_kg + self.full_load_kg
    }
}

/// Kind of car: with or without motors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, schemars::JsonSchema, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// With motors and electric brake.
    Motor,
    /// Without motors.
    Trailer,
}

impl CarsData {
    /// The train of [`TrainData::line6`].
    ///
    /// # Panics
    /// Never: a test reads the same text.
    pub fn line6() -> Self {
        match built_in(include_str!("../../../../scripts/trains/line6.toml")) {
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

    /// Response of the inverters to a demand.
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
