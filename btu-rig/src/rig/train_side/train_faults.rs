//! Faults around the unit, each at its place: equipment of cars, the cab's contacts, what TCMS sends, the bench itself.

use protocol::injection::{Effect, FaultMode, OccurrenceState, Place};
use protocol::{Duration, Instant, Random, Speed};
use thiserror::Error;

use crate::stimulus::TcmsCondition;
use crate::train::{CarSet, EquipmentFaults, Role, TrainData};

use super::bench_faults::BenchFaults;

/// Faults of desk and train lines.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CabDeskFaults {
    /// State that all door lines show, whatever the doors do.
    pub doors: Option<bool>,
    /// State that the contacts which prove the left doors and the right doors closed show, whatever the doors do.
    pub side_doors: [Option<bool>; 2],
    /// State of a failed head control relay, independent of its command.
    pub hcr: Option<bool>,
    /// Voltage of the master controller's potentiometer, whatever its position.
    pub volts: Option<f64>,
    /// Voltage above that of the lever's position, V.
    pub volts_offset: f64,
    /// The main reservoir's pressure switch, whatever the pressure.
    pub main_reservoir_low: Option<bool>,
}

/// Changes the seed, so that the random generators of faults differ from all others of the bench.
const FAULT_SEED: u64 = 0xFA01_75ED;
/// Supply voltage of the potentiometer, V: a broken one shows this voltage or 0.
const SUPPLY_V: f64 = 10.0;

/// All faults around the unit that act.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrainFaults {
    /// Equipment of cars.
    pub equipment: EquipmentFaults,
    /// Desk and train lines.
    pub desk: CabDeskFaults,
    /// Fault of TCMS's frames, if any.
    pub tcms: Option<TcmsCondition>,
    /// TCMS does not change the cabs.
    pub cabs_stay: bool,
    /// The bench and its wires to the unit.
    pub bench: BenchFaults,
}

/// Fault modes around the unit, and how much of each acts.
///
/// Each fault has a generator of its own: whatever is injected, the other random draws of the bench
/// stay the same.
#[derive(Debug)]
pub struct Injected {
    modes: Vec<ActiveFault>,
    random: Random,
    from: Instant,
}

#[derive(Debug)]
struct ActiveFault {
    mode: FaultMode,
    occurs: OccurrenceState,
    random: Random,
    strength: f64,
}

impl Injected {
    pub fn new(seed: u64) -> Self {
        Self {
            modes: Vec::new(),
            random: Random::new(seed ^ FAULT_SEED),
            from: Instant::ZERO,
        }
    }

    /// Injects those of `modes` that act outside the unit; their times count from `from`.
    pub fn begin(&mut self, modes: &[FaultMode], from: Instant) {
        self.from = from;
        let random = &mut self.random;
        let around = modes.iter().filter(|mode| !mode.place.in_unit());
        self.modes = around
            .map(|mode| ActiveFault {
                mode: mode.clone(),
                occurs: OccurrenceState::new(
                    mode.occurs,
                    Instant::ZERO + Duration::from_secs(mode.onset_s),
                ),
                random: random.fork(),
                strength: 0.0,
            })
            .collect();
    }

    /// Faults that act now, if they have changed; the wheels turn at `rims`.
    pub fn step(&mut self, now: Instant, rims: Speed) -> Option<TrainFaults> {
        if now < self.from {
            return None;
        }
        let since = Instant::ZERO + now.since(self.from);
        let mut changed = false;
        for acting in &mut self.modes {
            let random = &mut acting.random;
            let strength = acting.occurs.step(since, rims, &mut || random.unit());
            changed |= strength != acting.strength;
            acting.strength = strength;
        }
        changed.then(|| {
            let mut faults = TrainFaults::default();
            for ActiveFault { mode, strength, .. } in &self.modes {
                if let Some(effect) = mode.effect.at_strength(*strength) {
                    add(mode, effect, &mut faults);
                }
            }
            faults
        })
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
        /// Identifier of the fault mode, `part.mode`.
        fault: String,
    },
    #[error("fault {fault} is on car {car}, and this train has {cars}")]
    NoSuchCar {
        /// Identifier of the fault mode, `part.mode`.
        fault: String,
        /// Car that the mode names, from 1.
        car: u8,
        /// Number of cars of the train.
        cars: usize,
    },
    /// A trailer has no inverter.
    #[error("fault {fault} is on the inverter of car {car}, and that is a trailer")]
    Trailer {
        /// Identifier of the fault mode, `part.mode`.
        fault: String,
        /// Car that the mode names, from 1.
        car: u8,
    },
}

/// Checks that the train has the car that each fault mode names, with an inverter where the fault is on one.
///
/// # Errors
/// The first fault mode that the train has no place for.
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

/// Adds a fault mode around the unit; the catalogue lets only these effects happen at these places.
fn add(mode: &FaultMode, effect: Effect, faults: &mut TrainFaults) {
    let place = mode.car.and_then(place_from_car);
    let car = place.map_or(CarSet::NONE, CarSet::one);
    let on = |set: &mut CarSet| *set = set.with(car);
    let TrainFaults {
        equipment,
        desk,
        tcms,
        cabs_stay,
        bench,
    } = faults;
    match (mode.place, effect) {
        (Place::Inverter, Effect::Dead) => on(&mut equipment.inverters_dead),
        (Place::Inverter, Effect::Gain { factor }) => {
            if let Some(lost) = place.and_then(|at| equipment.motor_lost.get_mut(at)) {
                *lost = 1.0 - factor;
            }
        }
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
        (Place::ControllerPot, Effect::Offset { by }) => desk.volts_offset = by,
        (Place::MainReservoir, Effect::StuckOn) => desk.main_reservoir_low = Some(true),
        (Place::MainReservoir, Effect::StuckOff) => desk.main_reservoir_low = Some(false),
        (Place::DoorContact, Effect::StuckOn) => desk.doors = Some(true),
        (Place::DoorContact, Effect::StuckOff) => desk.doors = Some(false),
        (Place::DoorContactLeft, Effect::StuckOn) => desk.side_doors[0] = Some(true),
        (Place::DoorContactLeft, Effect::StuckOff) => desk.side_doors[0] = Some(false),
        (Place::DoorContactRight, Effect::StuckOn) => desk.side_doors[1] = Some(true),
        (Place::DoorContactRight, Effect::StuckOff) => desk.side_doors[1] = Some(false),
        (Place::HeadControlRelay, Effect::StuckOn) => desk.hcr = Some(true),
        (Place::HeadControlRelay, Effect::StuckOff) => desk.hcr = Some(false),
        (Place::Tcms, Effect::StuckOn) => *tcms = Some(TcmsCondition::Stale),
        (Place::Tcms, Effect::Dead) => *tcms = Some(TcmsCondition::Silent),
        (Place::TcmsCabs, Effect::Dead) => *cabs_stay = true,
        _ => bench.add(mode, effect),
    }
}
