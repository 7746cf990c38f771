//! The car table as TCMS calculates with it: MT pairs, their masses, what cars can give (S3 table 1).

use crate::train::{CarSet, CarsData, MAX_CARS, PerCar, Role};

/// Acceleration of gravity as S3 calculates with, m/s².
pub const GRAVITY_MPS2: f64 = 9.8;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pair {
    /// Braking mass with the present load, kg.
    pub inertia_kg: f64,
    /// Braking mass full, kg.
    pub full_inertia_kg: f64,
    pub motors: CarSet,
    pub trailers: CarSet,
}

impl Pair {
    /// Pair of these motor cars and trailers, not weighed.
    fn of((motors, trailers): (CarSet, CarSet)) -> Self {
        Self {
            motors,
            trailers,
            ..Self::default()
        }
    }

    /// Load compensation: TE_w, BE_w of S3.
    pub fn load_factor(&self) -> f64 {
        if self.full_inertia_kg > 0.0 {
            self.inertia_kg / self.full_inertia_kg
        } else {
            0.0
        }
    }
}

/// The cars of a train with the forces they can give at the present load.
#[derive(Clone, Debug)]
pub struct Consist {
    /// Data of the train's file.
    pub data: CarsData,
    /// MT pairs from the head.
    pub pairs: Vec<Pair>,
    /// Cars with inverters (M), which power and brake electrically.
    pub motors: CarSet,
    /// Greatest electric brake of each car at the present load, N [S3 eq. 6].
    pub electric_n: PerCar,
    /// Full service of each car at the present load, N (FBE of S3).
    pub full_service_n: PerCar,
    /// Greatest service brake by air of each car, N.
    pub air_n: PerCar,
    /// Greatest traction of each car at the present load, N: TE_w times the greatest (S3).
    pub power_n: PerCar,
    /// Braking mass of the full train, kg.
    pub full_inertia_kg: f64,
    /// Full service brake, m/s².
    pub service_mps2: f64,
    /// Acceleration of the train's braking mass at full power, m/s².
    pub power_mps2: f64,
    /// Passengers aboard, by which the cars are weighed, kg.
    pub load_kg: f64,
}

impl Consist {
    pub fn new(data: &CarsData) -> Self {
        let count = data.cars.iter().map(|car| car.pair).max().unwrap_or(0);
        let mut consist = Self {
            data: data.clone(),
            pairs: (1..=count)
                .map(|pair| Pair::of(data.pair_cars(pair)))
                .collect(),
            motors: data.motor_cars(),
            electric_n: [0.0; MAX_CARS],
            full_service_n: [0.0; MAX_CARS],
            air_n: [0.0; MAX_CARS],
            power_n: [0.0; MAX_CARS],
            full_inertia_kg: 0.0,
            service_mps2: data.service_brake.kmh_per_s / 3.6,
            power_mps2: 0.0,
            load_kg: 0.0,
        };
        for (i, car) in data.cars.iter().enumerate() {
            let pair = &mut consist.pairs[car.pair - 1];
            pair.full_inertia_kg += car.full_inertia_kg();
            consist.air_n[i] = car.air_n;
        }
        consist.full_inertia_kg = consist.pairs.iter().map(|pair| pair.full_inertia_kg).sum();
        consist.power_mps2 = data.traction.full_load_n / consist.full_inertia_kg;
        consist.weigh(0.0);
        consist
    }

    /// Takes the passengers aboard as the brake control units report them, kg. Compensation ends at
    /// full load, where TE_w and BE_w are 1 (S3).
    pub fn weigh(&mut self, load_kg: f64) {
        self.load_kg = load_kg;
        let full_kg: f64 = self.data.cars.iter().map(|car| car.full_load_kg).sum();
        // `max` turns not-a-number into an empty train.
        let share = (load_kg.max(0.0) / full_kg.max(1.0)).min(1.0);
        let service_mps2 = self.service_mps2;
        for pair in &mut self.pairs {
            pair.inertia_kg = 0.0;
        }
        for (i, car) in self.data.cars.iter().enumerate() {
            let weight_kg = car.weight_kg(share);
            let inertia_kg = weight_kg + car.rotating_kg;
            self.pairs[car.pair - 1].inertia_kg += inertia_kg;
            self.full_service_n[i] = inertia_kg * service_mps2;
            if car.role == Role::Motor {
                let limit = self.data.electric_brake.adhesion_limit;
                self.electric_n[i] = weight_kg * limit * GRAVITY_MPS2;
            }
        }
        let each_n = self.traction_n();
        for pair in &self.pairs {
            for car in pair.motors.iter() {
                self.power_n[car] = each_n * pair.load_factor();
            }
        }
    }

    /// Effort of each car's air brake beyond its greatest service brake, up to that of its emergency brake, N, at the
    /// present load.
    pub fn more_air_n(&self) -> PerCar {
        let emergency = self.data.emergency_brake.kmh_per_s / self.data.service_brake.kmh_per_s;
        std::array::from_fn(|car| (self.full_service_n[car] * emergency - self.air_n[car]).max(0.0))
    }

    /// Greatest braking effort of the full train, N [S3 eq. 4-1, without its rounding].
    pub fn full_brake_n(&self) -> f64 {
        self.full_inertia_kg * self.service_mps2
    }

    /// Greatest traction of one motor car of the full train, N.
    pub fn traction_n(&self) -> f64 {
        self.data.traction.full_load_n / self.motors.iter().count().max(1) as f64
    }
}

/// Line 6's train with passengers, kg.
#[cfg(test)]
pub(super) fn line6(load_kg: f64) -> Consist {
    let mut consist = Consist::new(&CarsData::line6());
    consist.weigh(load_kg);
    consist
}
