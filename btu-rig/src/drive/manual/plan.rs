//! Plan of a manual run: sequence, train, speed code and section.

use protocol::config::{SpeedCode, UnitConfig, find_code};
use protocol::line::{Line, Section};
use thiserror::Error;

use super::{Sequence, SequenceError, Step, When};
use crate::conditions::Conditions;
use crate::drive::PlanError;
use crate::drive::plan::fixed_code;
use crate::stimulus::{CutOut, Stimulus};
use crate::train::{CarsData, Role, TrainData};

/// Why a sequence cannot be driven.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ManualError {
    /// Something is wrong with a step.
    #[error(transparent)]
    Sequence(#[from] SequenceError),
    /// No such section or code.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The train has no cars whose effort could be shown.
    #[error("train {0} has no cars: driving by hand shows what each MT pair does")]
    NoCars(String),
}

/// A run by hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What is done when.
    pub sequence: Sequence,
    /// Somebody drives: the sequence is what was done so far.
    pub by_hand: bool,
    /// Section of the track database that is driven.
    pub section: Section,
    /// Name of the speed code.
    pub code: String,
    /// Limit that the code stands for, km/h.
    pub limit_kmh: f64,
    /// Stimulus that puts the code into the antenna.
    pub antenna: Stimulus,
    /// Train of cars; a run by hand needs TCMS' sharing of effort, which a point mass has not.
    pub train: CarsData,
    /// Passengers, kg.
    pub load_kg: f64,
    /// How train and track differ from the unit's configuration.
    pub conditions: Conditions,
}

impl Plan {
    /// `sequence` on an empty train in a section, nominal but for the sequence's gradient, under its
    /// code, or the highest the unit knows.
    ///
    /// # Errors
    /// An unknown section, code or car, a train without cars, or a speed ATP does not let it reach.
    pub fn new(
        config: &UnitConfig,
        line: &Line,
        train: &TrainData,
        section: u16,
        sequence: Sequence,
    ) -> Result<Self, ManualError> {
        let TrainData::Cars(cars) = train else {
            return Err(ManualError::NoCars(train.name().into()));
        };
        let found = line.section(section);
        let found = found.ok_or_else(|| PlanError::no_section(line, section))?;
        let by_limit = |a: &&SpeedCode, b: &&SpeedCode| a.line_kmh().total_cmp(&b.line_kmh());
        let highest = config.codes.iter().max_by(by_limit);
        let highest = highest.map_or("", |code| code.name.as_str());
        let code = sequence.code.as_deref().unwrap_or(highest).to_owned();
        let antenna = fixed_code(config, section, &code)?;
        let limit = find_code(&config.codes, &code).map(|at| &config.codes[at]);
        let conditions = Conditions {
            gradient_offset_permille: sequence.gradient_permille,
            ..Conditions::default()
        };
        for step in &sequence.steps {
            check(step, cars, limit)?;
        }
        Ok(Self {
            sequence,
            by_hand: false,
            section: found.clone(),
            limit_kmh: limit.map_or(0.0, |code| code.limit_kmh),
            code,
            antenna,
            train: cars.clone(),
            load_kg: 0.0,
            conditions,
        })
    }

    /// Mass that is accelerated with these passengers: rotating parts too, kg.
    pub fn inertia_kg(&self) -> f64 {
        let cars = self.train.cars.iter();
        let empty_kg: f64 = cars.map(|car| car.empty_kg + car.rotating_kg).sum();
        empty_kg + self.load_kg
    }

    /// Full service brake of the train with these passengers, N (S3 table 1: FBE).
    pub fn full_service_n(&self) -> f64 {
        self.inertia_kg() * self.train.service_brake.kmh_per_s / 3.6
    }
}

/// Holds a step to what train and ATP can do.
fn check(step: &Step, train: &CarsData, code: Option<&SpeedCode>) -> Result<(), SequenceError> {
    let wrong = |message| {
        Err(SequenceError {
            line: step.line,
            message,
        })
    };
    if let (When::AtKmh(kmh), Some(code)) = (step.when, code)
        && kmh > code.limit_kmh
    {
        let (limit_kmh, name) = (code.limit_kmh, &code.name);
        return wrong(format!(
            "{kmh} km/h is never reached: ATP brakes above {limit_kmh} km/h (code {name})"
        ));
    }
    for action in &step.actions {
        let Stimulus::CutOut { what, car, .. } = *action else {
            continue;
        };
        let found = usize::from(car).checked_sub(1);
        let Some(found) = found.and_then(|at| train.cars.get(at)) else {
            let (name, count) = (&train.name, train.cars.len());
            return wrong(format!("car {car}: train {name} has cars 1 to {count}"));
        };
        if what == CutOut::Inverter && found.role != Role::Motor {
            let motors = (1..)
                .zip(&train.cars)
                .filter(|(_, car)| car.role == Role::Motor);
            let motors: Vec<_> = motors.map(|(at, _): (usize, _)| at.to_string()).collect();
            return wrong(format!(
                "car {car} ({}) of train {} has no inverter; {} have one",
                found.name,
                train.name,
                motors.join(", ")
            ));
        }
    }
    Ok(())
}
