//! What TCMS watches of the train's equipment: inverters and brake control units that do not answer,
//! cylinders that do not follow, brakes that are not released (S4 figure 3).

use protocol::{Duration, Instant};

use crate::train::{CarSet, Equipment, MAX_CARS, PerCar};

use super::data::TcmsData;
use super::timer::Lasting;

/// What it looks at in one scan.
#[derive(Clone, Copy, Debug)]
pub struct WatchInputs<'a> {
    /// What the equipment reports.
    pub equipment: &'a Equipment,
    /// Air TCMS asks of each car, N.
    pub air_n: &'a PerCar,
    /// Neither a brake nor the holding brake is ordered.
    pub brakes_off: bool,
    /// Cars without a brake: cut out.
    pub brakes_cut_out: CarSet,
    /// Cars whose inverter is cut out.
    pub inverters_cut_out: CarSet,
    /// The driver releases brakes by force.
    pub forced_release: bool,
}

/// What was found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// Inverters that do not answer and are not cut out (BCXVVVFF).
    pub inverters: CarSet,
    /// Brake control units that do not answer and are not cut out (BCXECUF).
    pub brake_units: CarSet,
    /// Cars whose cylinders do not follow (BCXBCCSF).
    pub cylinders: CarSet,
    /// Cars whose brake is not released (BCXNRB).
    pub not_released: CarSet,
}

/// The watch.
#[derive(Clone, Debug)]
pub struct Watch {
    silent_after: Duration,
    not_released_above: f64,
    not_released_after: Duration,
    not_following_above: f64,
    not_following_after: Duration,
    full_service_n: PerCar,
    inverters: [Lasting; MAX_CARS],
    brake_units: [Lasting; MAX_CARS],
    cylinders: [Lasting; MAX_CARS],
    not_released: [Lasting; MAX_CARS],
}

impl Watch {
    /// Nothing found yet. `full_service_n` is each car's share of full service, N.
    pub fn new(data: &TcmsData, full_service_n: PerCar) -> Self {
        Self {
            silent_after: Duration::from_secs(data.silent_after_s),
            not_released_above: data.not_released_above / 100.0,
            not_released_after: Duration::from_secs(data.not_released_after_s),
            not_following_above: data.not_following_above / 100.0,
            not_following_after: Duration::from_secs(data.not_following_after_s),
            full_service_n,
            inverters: Default::default(),
            brake_units: Default::default(),
            cylinders: Default::default(),
            not_released: Default::default(),
        }
    }

    /// Takes each car's full service anew, N.
    pub fn weigh(&mut self, full_service_n: PerCar) {
        self.full_service_n = full_service_n;
    }

    /// One scan.
    pub fn step(&mut self, now: Instant, inputs: &WatchInputs<'_>) -> Found {
        let mut found = Found::default();
        let equipment = inputs.equipment;
        let asks = inputs.brakes_off && !equipment.other_brakes && !inputs.forced_release;
        let (inverters, brakes) = (
            equipment.inverters_silent.without(inputs.inverters_cut_out),
            equipment.brake_units_silent.without(inputs.brakes_cut_out),
        );
        for car in 0..MAX_CARS {
            let full_n = self.full_service_n[car];
            let answers = !equipment.brake_units_silent.contains(car);
            let has_brake = full_n > 0.0 && answers && !inputs.brakes_cut_out.contains(car);
            let air_n = equipment.air_n[car];
            let off_n = (air_n - inputs.air_n[car]).abs();
            let too_little = !equipment.other_brakes && air_n < inputs.air_n[car];
            found.inverters.set(
                car,
                self.inverters[car].update(now, inverters.contains(car), self.silent_after),
            );
            found.brake_units.set(
                car,
                self.brake_units[car].update(now, brakes.contains(car), self.silent_after),
            );
            let follows_not = has_brake && too_little && off_n > self.not_following_above * full_n;
            found.cylinders.set(
                car,
                self.cylinders[car].update(now, follows_not, self.not_following_after),
            );
            let remains = has_brake && asks && air_n > self.not_released_above * full_n;
            found.not_released.set(
                car,
                self.not_released[car].update(now, remains, self.not_released_after),
            );
        }
        found
    }
}
