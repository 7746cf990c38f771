//! The train: commands become forces on the rails, and the forces its motion.
//!
//! Two models behind [`Train::step`]: the papers' ideal point mass (`ideal`), and a train of cars
//! (`formation`): demands of TCMS for each car → what its inverters and brakes give (`equipment`,
//! `actuator`) → what the rails carry (`wheels`) → motion against `resistance`. Its data is
//! [`TrainData`].
//!
//! Terms: *weight* is the mass that gravity acts on, *inertia* the weight plus the rotating parts (S3's braking mass);
//! the *axle* is the one with the tachometers. Forward is positive, efforts are never negative.

mod actuator;
mod car_set;
mod check;
mod data;
mod equipment;
mod formation;
mod ideal;
mod piece;
mod resistance;
mod step;
mod wheels;

use crate::conditions::Conditions;

pub(crate) use actuator::Actuators;
pub use car_set::{CarSet, MAX_CARS, PerCar};
pub use data::{
    AirBrake, CarData, CarsData, Davis, DoorData, EffortAt, ElectricBrake, EmergencyBrake,
    IdealData, Resistance, Role, Traction, TrainData, Wheels,
};
pub use equipment::{Equipment, EquipmentFaults};
pub use piece::Piece;
pub use step::{KGF_PER_T, TrainInputs, TrainState};

use formation::Formation;
use ideal::Ideal;

/// The motion of a train: one point mass, or cars with wheels that slip and slide.
#[derive(Clone, Debug)]
pub struct Train {
    model: Model,
    /// Passengers that the train can carry, kg.
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

    /// Changes how train and track differ from their data, from now on.
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
