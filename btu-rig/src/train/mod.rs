//! The train: commands become forces on the rails, and those its motion.
//!
//! Two models behind [`Train::step`]: the papers' ideal point mass (`ideal`), and a train of cars
//! (`formation`): demands of TCMS for each car → what its inverters and brakes give (`equipment`,
//! `actuator`) → what the rails carry (`wheels`) → motion against `resistance`. Its data is
//! [`TrainData`].
//!
//! Terms: *weight* is the mass gravity acts on, *inertia* that and the rotating parts (S3's braking
//! mass); an *axle* is the one the tachometers sit on. Forward is positive, efforts are sizes.

mod actuator;
mod car_set;
mod check;
mod data;
mod equipment;
mod formation;
mod ideal;
mod piece;
mod resistance;
#[cfg(test)]
mod tests;
mod wheels;

use crate::conditions::{Conditions, Disturbance};

pub(crate) use actuator::Actuators;
pub use car_set::CarSet;
pub use data::{
    AirBrake, CarData, CarsData, Davis, DoorData, EffortAt, ElectricBrake, EmergencyBrake,
    IdealData, Resistance, Role, Traction, TrainData, Wheels,
};
pub use equipment::{Equipment, EquipmentFaults};
pub use piece::Piece;

use formation::Formation;
use ideal::Ideal;

/// Cars a train may have.
pub const MAX_CARS: usize = 12;

/// A value for each car; those beyond the train's last are 0.
pub type PerCar = [f64; MAX_CARS];

/// One kilogram-force per tonne, N/kg; also what 1 ‰ of gradient takes.
pub const KGF_PER_T: f64 = 9.80665e-3;

/// Everything that acts on the train in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrainInputs {
    /// Share of full effort, −1 full service brake .. 1 full power: what the point mass goes by.
    pub demand: f64,
    /// Demand of TCMS on each car's inverter, N: powering above 0, electric brake below.
    pub motor_n: PerCar,
    /// Demand of TCMS on each car's air brake, N.
    pub air_n: PerCar,
    /// Emergency brake: its train line is de-energised. Hard-wired, air on all cars (S3).
    pub emergency: bool,
    /// Security brake, hard-wired (S3).
    pub security: bool,
    /// Parking brake: springs.
    pub parking: bool,
    /// Brakes are released by force (S4).
    pub forced_release: bool,
    /// The line takes no regenerated power.
    pub regeneration_refused: bool,
    pub brakes_cut_out: CarSet,
    pub inverters_cut_out: CarSet,
    /// Traction pulls backward.
    pub backward: bool,
    /// Passengers, kg.
    pub load_kg: f64,
    /// Gradient under the train, mean over its weight, ‰, uphill positive.
    pub gradient_permille: f64,
    /// Curvature under the train, mean over its weight, 1/m.
    pub curvature_per_m: f64,
    /// Share of the train in the open air, not in a tunnel.
    pub open_air: f64,
}

impl TrainInputs {
    /// Takes the voltage of the contact line away: nothing drives, and nothing is regenerated.
    pub(crate) fn without_voltage(&mut self) {
        self.regeneration_refused = true;
        self.demand = self.demand.min(0.0);
        self.motor_n = self.motor_n.map(|motor_n| motor_n.min(0.0));
    }
}

/// Motion of the train in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrainState {
    /// Motion of the train: moving, then standing for the rest if it came to a stop.
    pub pieces: [Piece; 2],
    /// Motion at the rim of the axle with the tachometers; equal to the train's unless the wheel
    /// slips or slides.
    pub axle: [Piece; 2],
    /// Traction on the rails, N, a size.
    pub traction_n: f64,
    /// Electric brake, N, a size.
    pub electric_brake_n: f64,
    /// Air brake, N, a size.
    pub air_brake_n: f64,
    /// Running, starting and curve resistance and the disturbance, N, against the motion.
    pub resistance_n: f64,
    /// Force of the gradient, N, uphill positive.
    pub gradient_n: f64,
    /// Traction power at the wheels, W.
    pub tractive_power_w: f64,
    pub braking: bool,
    /// A car slips or slides.
    pub sliding: bool,
}

/// The motion of a train: one point mass, or cars with wheels that slip and slide.
#[derive(Clone, Debug)]
pub struct Train {
    model: Model,
    /// Passengers it can carry, kg.
    pub full_load_kg: f64,
}

#[derive(Clone, Debug)]
enum Model {
    Ideal(Box<Ideal>),
    Cars(Box<Formation>),
}

impl Train {
    /// A train at rest with no effort.
    pub fn new(data: &TrainData, conditions: &Conditions) -> Self {
        let model = match data {
            TrainData::Ideal(data) => Model::Ideal(Box::new(Ideal::new(data, conditions))),
            TrainData::Cars(data) => Model::Cars(Box::new(Formation::new(data, conditions))),
        };
        Self {
            model,
            full_load_kg: data.full_load_kg(),
        }
    }

    /// Changes what it differs from its data in, from now on.
    pub fn set_conditions(&mut self, conditions: &Conditions) {
        match &mut self.model {
            Model::Ideal(train) => train.set_conditions(conditions),
            Model::Cars(train) => train.set_conditions(conditions),
        }
    }

    /// Puts the train at a speed, m/s, forward positive, with no effort, and begins its time at 0.
    pub fn place(&mut self, velocity_mps: f64) {
        match &mut self.model {
            Model::Ideal(train) => train.place(velocity_mps),
            Model::Cars(train) => train.place(velocity_mps),
        }
    }

    /// Speed of the train, m/s, forward positive.
    pub fn velocity_mps(&self) -> f64 {
        match &self.model {
            Model::Ideal(train) => train.velocity_mps,
            Model::Cars(train) => train.velocity_mps,
        }
    }

    /// Lets equipment fail, or be sound again. A point mass has none.
    pub fn set_faults(&mut self, faults: EquipmentFaults) {
        if let Model::Cars(train) = &mut self.model {
            train.set_faults(faults);
        }
    }

    /// Reports of the equipment at the end of the last step. A point mass is one sound car.
    pub fn equipment(&self) -> Equipment {
        match &self.model {
            Model::Ideal(train) => train.equipment(),
            Model::Cars(train) => train.equipment(),
        }
    }

    /// One step of `dt_s`, at most 5 ms.
    pub fn step(&mut self, dt_s: f64, inputs: &TrainInputs) -> TrainState {
        match &mut self.model {
            Model::Ideal(train) => train.step(dt_s, inputs),
            Model::Cars(train) => train.step(dt_s, inputs),
        }
    }
}

impl Disturbance {
    /// Coefficient of the disturbance at a time, N·s/m: the force is `−f_d·v`.
    fn at(&self, seconds: f64) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Sine {
                amplitude_n_s_per_m,
                hz,
            } => amplitude_n_s_per_m * (std::f64::consts::TAU * hz * seconds).sin(),
        }
    }
}
