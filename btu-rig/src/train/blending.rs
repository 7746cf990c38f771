//! From a command to demands on each car's inverter and air brake, as TCMS shares them out (S3).
//!
//! Powering is shared by the motor cars. Braking is shared by brake units; in each, the electric
//! brake takes what it can at this speed, air on the trailers makes up for the rest, and air on the
//! motor cars for what is still missing.

use super::data::{CarsData, Role};
use super::{MAX_CARS, PerCar};

/// Acceleration of gravity as S3 calculates with, m/s².
const S3_GRAVITY_MPS2: f64 = 9.8;

/// What each car is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CarDemands {
    /// Inverters, N: powering above 0, electric brake below.
    pub motor_n: PerCar,
    /// Air brakes, N.
    pub air_n: PerCar,
}

/// Commands to the train and what it does, as far as they decide on efforts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Command<'a> {
    /// Share of full effort, −1..1.
    pub share: f64,
    /// Emergency brake: no effort of the inverters.
    pub emergency: bool,
    /// Speed, m/s, a size.
    pub speed_mps: f64,
    /// Electric brake each car was asked for and did not give, N; none when all gave theirs.
    pub electric_lost_n: Option<&'a PerCar>,
}

/// Brake force a unit can be asked for, N.
#[derive(Clone, Copy, Debug, Default)]
struct BrakeUnit {
    full_service_n: f64,
    electric_n: f64,
    trailer_air_n: f64,
    motor_air_n: f64,
}

/// Shares of what its cars can give that a brake unit asks for.
#[derive(Clone, Copy, Debug, Default)]
struct UnitShares {
    electric: f64,
    trailer_air: f64,
    motor_air: f64,
}

/// The sharing out of effort.
#[derive(Clone, Debug)]
pub(super) struct Blending {
    cars: CarsData,
    unit_of: [usize; MAX_CARS],
    /// Share of the train's traction.
    traction: PerCar,
    electric_n: PerCar,
    trailer_air_n: PerCar,
    motor_air_n: PerCar,
    units: Vec<BrakeUnit>,
    traction_n: f64,
    power_mps2: f64,
    service_mps2: f64,
    /// Effort asked for, as acceleration: jerk limited.
    effort_mps2: f64,
}

impl Blending {
    pub fn new(cars: &CarsData) -> Self {
        let motors = cars.cars.iter().filter(|c| c.role == Role::Motor).count();
        let full_kg = |c: &super::CarData| c.empty_kg + c.rotating_kg + c.full_load_kg;
        let full_inertia_kg: f64 = cars.cars.iter().map(full_kg).sum();
        let mut blending = Self {
            cars: cars.clone(),
            unit_of: [0; MAX_CARS],
            traction: [0.0; MAX_CARS],
            electric_n: [0.0; MAX_CARS],
            trailer_air_n: [0.0; MAX_CARS],
            motor_air_n: [0.0; MAX_CARS],
            units: Vec::new(),
            traction_n: 0.0,
            power_mps2: cars.traction.full_load_n / full_inertia_kg,
            service_mps2: cars.service_brake.kmh_per_s / 3.6,
            effort_mps2: 0.0,
        };
        for (i, car) in cars.cars.iter().enumerate() {
            blending.unit_of[i] = car.brake_unit - 1;
            match car.role {
                Role::Motor => {
                    blending.traction[i] = 1.0 / motors as f64;
                    blending.motor_air_n[i] = car.air_n;
                }
                Role::Trailer => blending.trailer_air_n[i] = car.air_n,
            }
        }
        blending
    }

    /// Compensates for the load: the same acceleration from empty to full.
    pub fn weigh(&mut self, weight_kg: &PerCar, inertia_kg: &PerCar) {
        self.traction_n = self.power_mps2 * inertia_kg.iter().sum::<f64>();
        let count = self.unit_of.iter().max().map_or(0, |last| last + 1);
        self.units = vec![BrakeUnit::default(); count];
        for (i, car) in self.cars.cars.iter().enumerate() {
            let unit = &mut self.units[self.unit_of[i]];
            if car.role == Role::Motor {
                let limit = self.cars.electric_brake.adhesion_limit;
                self.electric_n[i] = weight_kg[i] * limit * S3_GRAVITY_MPS2;
            }
            unit.full_service_n += self.service_mps2 * inertia_kg[i];
            unit.electric_n += self.electric_n[i];
            unit.trailer_air_n += self.trailer_air_n[i];
            unit.motor_air_n += self.motor_air_n[i];
        }
    }

    /// Asks for nothing.
    pub fn reset(&mut self) {
        self.effort_mps2 = 0.0;
    }

    /// One step's demands.
    pub fn step(&mut self, dt_s: f64, command: Command<'_>) -> CarDemands {
        self.limit_jerk(dt_s, command);
        let mut demands = CarDemands {
            motor_n: [0.0; MAX_CARS],
            air_n: [0.0; MAX_CARS],
        };
        if self.effort_mps2 > 0.0 {
            let share = self.effort_mps2 / self.power_mps2;
            let force_n = share * self.traction_n * self.traction_pattern(command.speed_mps);
            for (demand, share) in demands.motor_n.iter_mut().zip(&self.traction) {
                *demand = share * force_n;
            }
        } else if self.effort_mps2 < 0.0 {
            let shares = self.brake(command);
            for i in 0..MAX_CARS {
                let unit = &shares[self.unit_of[i]];
                demands.motor_n[i] = -unit.electric * self.electric_n[i];
                demands.air_n[i] =
                    unit.trailer_air * self.trailer_air_n[i] + unit.motor_air * self.motor_air_n[i];
            }
        }
        demands
    }

    /// Lets the effort asked for go to the commanded one.
    fn limit_jerk(&mut self, dt_s: f64, command: Command<'_>) {
        let full = if command.share < 0.0 {
            self.service_mps2
        } else {
            self.power_mps2
        };
        // The emergency brake's contacts take power off without a ramp.
        if command.emergency {
            self.effort_mps2 = self.effort_mps2.min(0.0);
        }
        let step = self.cars.traction.jerk_mps3 * dt_s;
        let change = command.share * full - self.effort_mps2;
        self.effort_mps2 += change.clamp(-step, step);
    }

    /// What each brake unit asks of its cars.
    fn brake(&self, command: Command<'_>) -> [UnitShares; MAX_CARS] {
        let mut shares = [UnitShares::default(); MAX_CARS];
        let effort = -self.effort_mps2 / self.service_mps2;
        let pattern = if command.emergency {
            0.0
        } else {
            self.electric_pattern(command.speed_mps)
        };
        for (i, (unit, share)) in self.units.iter().zip(&mut shares).enumerate() {
            let needed_n = effort * unit.full_service_n;
            let electric_n = needed_n.min(pattern * unit.electric_n);
            // Air makes up for what electric brakes are not asked for, and what they fail to give.
            let air_n = needed_n - electric_n + self.lost_n(i, command.electric_lost_n);
            let trailer_n = air_n.min(unit.trailer_air_n);
            let motor_n = (air_n - trailer_n).min(unit.motor_air_n);
            *share = UnitShares {
                electric: part(electric_n, unit.electric_n),
                trailer_air: part(trailer_n, unit.trailer_air_n),
                motor_air: part(motor_n, unit.motor_air_n),
            };
        }
        shares
    }

    fn lost_n(&self, unit: usize, lost_n: Option<&PerCar>) -> f64 {
        let cars = self.unit_of.iter().zip(lost_n.into_iter().flatten());
        cars.filter(|(of, _)| **of == unit).map(|(_, n)| n).sum()
    }

    /// Traction there is at a speed, share of the greatest: constant power beyond base speed.
    fn traction_pattern(&self, speed_mps: f64) -> f64 {
        let base_mps = self.cars.traction.base_speed_kmh / 3.6;
        base_mps / speed_mps.max(base_mps)
    }

    /// Electric brake there is at a speed, share of the greatest (S3's DBE_v).
    fn electric_pattern(&self, speed_mps: f64) -> f64 {
        let electric = &self.cars.electric_brake;
        let kmh = speed_mps * 3.6;
        if kmh < electric.fade_from_kmh {
            let span = electric.fade_from_kmh - electric.fade_to_kmh;
            ((kmh - electric.fade_to_kmh) / span).max(0.0)
        } else {
            electric.full_to_kmh / kmh.max(electric.full_to_kmh)
        }
    }
}

/// `value` as a share of `whole`; nothing of nothing is nothing.
fn part(value: f64, whole: f64) -> f64 {
    if whole > 0.0 { value / whole } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::train::TrainData;

    /// Full train, full service, the jerk limit long past.
    fn full_service(kmh: f64, emergency: bool, lost_n: Option<&PerCar>) -> CarDemands {
        let TrainData::Cars(data) = TrainData::line6() else {
            panic!("a train of cars");
        };
        let mut blending = Blending::new(&data);
        let (mut weight_kg, mut inertia_kg) = ([0.0; MAX_CARS], [0.0; MAX_CARS]);
        for (i, car) in data.cars.iter().enumerate() {
            weight_kg[i] = car.empty_kg + car.full_load_kg;
            inertia_kg[i] = weight_kg[i] + car.rotating_kg;
        }
        blending.weigh(&weight_kg, &inertia_kg);
        let command = Command {
            share: -1.0,
            emergency,
            speed_mps: kmh / 3.6,
            electric_lost_n: lost_n,
        };
        (0..500)
            .fold(None, |_, _| Some(blending.step(0.005, command)))
            .unwrap()
    }

    fn check(demand_n: f64, printed_n: f64) {
        assert!((demand_n - printed_n).abs() < 3.0, "{demand_n} {printed_n}");
    }

    /// M2 and T1 (cars 3 and 4), from S3's table: 108 825 N together, 87 418 N of it electric, the
    /// rest air on the trailer.
    #[test]
    fn electric_first_then_air_on_the_trailer() {
        let demands = full_service(50.0, false, None);
        check(demands.motor_n[2], -87_418.0);
        check(demands.air_n[3], 108_825.0 - 87_418.0);
        assert_eq!((demands.motor_n[3], demands.air_n[2]), (0.0, 0.0));
    }

    /// Below the fade, and in emergency, air gives each car's own B7 force [S3: FBE].
    #[test]
    fn without_electric_brake_air_takes_all_of_it() {
        for (kmh, emergency) in [(3.0, false), (50.0, true)] {
            let demands = full_service(kmh, emergency, None);
            assert!(demands.motor_n.iter().all(|&n| n == 0.0));
            check(demands.air_n[2], 59_068.0);
            check(demands.air_n[3], 49_756.0);
        }
    }

    /// What an inverter fails to give comes as air, on its own unit's trailer first [S3 eq. 8].
    #[test]
    fn air_makes_up_for_an_inverter_that_fails_to_brake() {
        let mut lost_n = [0.0; MAX_CARS];
        lost_n[2] = 40_000.0;
        let demands = full_service(50.0, false, Some(&lost_n));
        check(demands.air_n[3], 49_756.0);
        check(demands.air_n[2], 108_825.0 - 87_418.0 + 40_000.0 - 49_756.0);
        check(demands.air_n[0], full_service(50.0, false, None).air_n[0]);
    }
}
