//! Faults of the train and its wiring, each at its place: equipment of cars, the cab's contacts, what
//! TCMS sends.

use protocol::injection::{Effect, FaultMode, Place};
use protocol::{Duration, Instant};
use thiserror::Error;

use crate::stimulus::TcmsCondition;
use crate::train::{CarSet, EquipmentFaults, Role, TrainData};

/// What is wrong with desk and train lines.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DeskFaults {
    /// What the door contact says, whatever the doors do.
    pub doors: Option<bool>,
    /// What the head control relay does, whatever it is told.
    pub hcr: Option<bool>,
    /// Voltage of the master controller's potentiometer, whatever its position.
    pub volts: Option<f64>,
}

/// Voltage of a broken potentiometer, V: its supply or nothing.
const SUPPLY_V: f64 = 10.0;

/// All faults of the train that have set in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrainFaults {
    /// Equipment of cars.
    pub equipment: EquipmentFaults,
    /// Desk and train lines.
    pub desk: DeskFaults,
    /// What becomes of TCMS's frames, if anything.
    pub tcms: Option<TcmsCondition>,
}

/// Fault modes that are on the train, by when they set in.
#[derive(Debug, Default)]
pub struct Injected {
    modes: Vec<(Instant, FaultMode)>,
}

impl Injected {
    /// Those of `modes` that are on the train; their times count from `from`.
    pub fn new(modes: &[FaultMode], from: Instant) -> Self {
        let mut modes: Vec<_> = modes
            .iter()
            .filter(|mode| mode.place.on_train())
            .map(|mode| (from + Duration::from_secs(mode.onset_s), mode.clone()))
            .collect();
        modes.sort_by_key(|(at, _)| *at);
        modes.reverse();
        Self { modes }
    }

    /// Adds what sets in by now to `faults`; whether anything did.
    pub fn set_in(&mut self, now: Instant, faults: &mut TrainFaults) -> bool {
        let mut changed = false;
        while let Some((_, mode)) = self.modes.pop_if(|(at, _)| *at <= now) {
            add(&mode, faults);
            changed = true;
        }
        changed
    }
}

/// A fault that a train has no place for.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Misplaced {
    /// A point mass has no cars.
    #[error(
        "fault {fault} is on a car, and this train is one point mass; choose another with --train"
    )]
    PointMass {
        /// Its name.
        fault: String,
    },
    /// The train is shorter.
    #[error("fault {fault} is on car {car}, and this train has {cars}")]
    NoSuchCar {
        /// Its name.
        fault: String,
        /// Car it names.
        car: u8,
        /// Cars there are.
        cars: usize,
    },
    /// A trailer has no inverter.
    #[error("fault {fault} is on the inverter of car {car}, and that is a trailer")]
    Trailer {
        /// Its name.
        fault: String,
        /// Car it names.
        car: u8,
    },
}

/// Whether the train has what these faults are faults of.
///
/// # Errors
/// The first that it has not.
pub fn check_places(modes: &[FaultMode], train: &TrainData) -> Result<(), Misplaced> {
    for mode in modes {
        let Some(car) = mode.car else { continue };
        let fault = mode.id.clone();
        let TrainData::Cars(data) = train else {
            return Err(Misplaced::PointMass { fault });
        };
        let Some(built) = place_from_car(car).and_then(|place| data.cars.get(place)) else {
            let cars = data.cars.len();
            return Err(Misplaced::NoSuchCar { fault, car, cars });
        };
        let on_inverter = matches!(mode.place, Place::Inverter | Place::Regeneration);
        if on_inverter && built.role == Role::Trailer {
            return Err(Misplaced::Trailer { fault, car });
        }
    }
    Ok(())
}

/// Place from 0 of a car that people count from 1.
fn place_from_car(car: u8) -> Option<usize> {
    usize::from(car).checked_sub(1)
}

/// The catalogue lets only these effects happen at these places.
fn add(mode: &FaultMode, faults: &mut TrainFaults) {
    let place = mode.car.and_then(place_from_car);
    let car = place.map_or(CarSet::NONE, CarSet::one);
    let on = |set: &mut CarSet| *set = set.with(car);
    let TrainFaults {
        equipment,
        desk,
        tcms,
    } = faults;
    match (mode.place, mode.effect) {
        (Place::Inverter, Effect::Dead) => on(&mut equipment.inverters_dead),
        (Place::Regeneration, Effect::Dead) => on(&mut equipment.regeneration_lost),
        (Place::BrakeUnit, Effect::Dead) => on(&mut equipment.brake_units_dead),
        (Place::BrakeCylinder, Effect::StuckOn) => on(&mut equipment.brakes_stuck),
        (Place::BrakeCylinder, Effect::Gain { factor }) => {
            if let Some(lost) = place.and_then(|at| equipment.pressure_lost.get_mut(at)) {
                *lost = 1.0 - factor;
            }
        }
        (Place::ControllerPot, Effect::StuckOn) => desk.volts = Some(SUPPLY_V),
        (Place::ControllerPot, Effect::StuckOff) => desk.volts = Some(0.0),
        (Place::DoorContact, Effect::StuckOn) => desk.doors = Some(true),
        (Place::DoorContact, Effect::StuckOff) => desk.doors = Some(false),
        (Place::HeadControlRelay, Effect::StuckOn) => desk.hcr = Some(true),
        (Place::HeadControlRelay, Effect::StuckOff) => desk.hcr = Some(false),
        (Place::Tcms, Effect::StuckOn) => *tcms = Some(TcmsCondition::Stale),
        (Place::Tcms, Effect::Dead) => *tcms = Some(TcmsCondition::Silent),
        _ => {}
    }
}
