//! Faults of the train and its wiring, each at its place: equipment of cars, the cab's contacts, what
//! TCMS sends.

use protocol::injection::{Effect, FaultMode, Place};
use protocol::{Duration, Instant};

use crate::stimulus::TcmsCondition;
use crate::train::{CarSet, EquipmentFaults};

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

fn add(mode: &FaultMode, faults: &mut TrainFaults) {
    let car = mode.car.map_or(CarSet::NONE, |car| {
        CarSet::one(usize::from(car).wrapping_sub(1))
    });
    let on = |set: &mut CarSet| *set = set.with(car);
    let equipment = &mut faults.equipment;
    match (mode.place, mode.effect) {
        (Place::Inverter, _) => on(&mut equipment.inverters_dead),
        (Place::Regeneration, _) => on(&mut equipment.regeneration_lost),
        (Place::BrakeUnit, _) => on(&mut equipment.brake_units_dead),
        (Place::BrakeCylinder, Effect::StuckOn) => on(&mut equipment.brakes_stuck),
        (Place::BrakeCylinder, _) => on(&mut equipment.brakes_weak),
        (Place::ControllerPot, Effect::StuckOn) => faults.desk.volts = Some(SUPPLY_V),
        (Place::ControllerPot, _) => faults.desk.volts = Some(0.0),
        (Place::DoorContact, effect) => faults.desk.doors = Some(effect == Effect::StuckOn),
        (Place::HeadControlRelay, effect) => faults.desk.hcr = Some(effect == Effect::StuckOn),
        (Place::Tcms, Effect::StuckOn) => faults.tcms = Some(TcmsCondition::Stale),
        (Place::Tcms, _) => faults.tcms = Some(TcmsCondition::Silent),
        _ => {}
    }
}
