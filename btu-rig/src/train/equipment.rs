//! Equipment between TCMS and the rails: inverters and brake control units, what they report, and their
//! faults.

use crate::stimulus::CarFailure;

use super::{CarSet, PerCar};

/// Reports of the train's equipment to TCMS in each scan. Efforts and speeds are never negative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Equipment {
    /// Speed of the rims of each motor car, m/s.
    pub axle_mps: PerCar,
    /// Traction of each inverter, N.
    pub traction_n: PerCar,
    /// Electric brake of each inverter, N (EFM of S3).
    pub electric_n: PerCar,
    /// Air brake of each car by its cylinders' pressure, N; spring brakes do not show in it.
    pub air_n: PerCar,
    /// Inverters that do not answer.
    pub inverters_silent: CarSet,
    /// Inverters that have cut their electric brake out.
    pub regeneration_cut_out: CarSet,
    /// Brake control units that do not answer.
    pub brake_units_silent: CarSet,
    /// Security, emergency or parking brake is applied on the train.
    pub other_brakes: bool,
}

/// Faults of the train's equipment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EquipmentFaults {
    /// Inverters that do nothing and say nothing.
    pub inverters_dead: CarSet,
    /// Inverters without electric brake.
    pub regeneration_lost: CarSet,
    /// Brake control units that do nothing and say nothing; the emergency brake's valve still works.
    pub brake_units_dead: CarSet,
    /// Share of traction and electric brake that each inverter does not give, 0..1.
    pub motor_lost: PerCar,
    /// Cars whose cylinders keep the pressure they have had.
    pub brakes_stuck: CarSet,
    /// Share of the service brake's pressure that is lost on the way to each car's cylinders, 0..1.
    pub pressure_lost: PerCar,
}

impl EquipmentFaults {
    /// Faults when these and `other` come together.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        let worse = |of: &PerCar, than: &PerCar| std::array::from_fn(|car| of[car].max(than[car]));
        Self {
            inverters_dead: self.inverters_dead.with(other.inverters_dead),
            regeneration_lost: self.regeneration_lost.with(other.regeneration_lost),
            brake_units_dead: self.brake_units_dead.with(other.brake_units_dead),
            motor_lost: worse(&self.motor_lost, &other.motor_lost),
            brakes_stuck: self.brakes_stuck.with(other.brakes_stuck),
            pressure_lost: worse(&self.pressure_lost, &other.pressure_lost),
        }
    }

    /// Makes equipment of the car at a place fail, or puts it in order again.
    pub fn set(&mut self, what: CarFailure, car: usize, on: bool) {
        match what {
            CarFailure::InverterSilent => self.inverters_dead.set(car, on),
            CarFailure::BrakeUnitSilent => self.brake_units_dead.set(car, on),
            CarFailure::BrakeStuck => self.brakes_stuck.set(car, on),
            CarFailure::CylinderEmpty => {
                if let Some(lost) = self.pressure_lost.get_mut(car) {
                    *lost = f64::from(on);
                }
            }
        }
    }
}
