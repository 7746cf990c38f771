//! Events that TCMS logs, each once when its condition begins.

use protocol::event::{ALL_CARS, Event};
use protocol::{Duration, Instant};

use crate::train::CarSet;

use super::atc_link::AtcLink;
use super::data::TcmsData;
use super::equipment_monitor::EquipmentFailures;
use super::inputs::TcmsInputs;
use super::timer::BurstDetector;
use super::view::{TcmsEvent, TcmsView};

/// Inputs of the report in one scan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scan<'a> {
    pub inputs: &'a TcmsInputs<'a>,
    pub view: &'a TcmsView,
    pub motors: CarSet,
    pub atc: &'a AtcLink,
    /// The controller's voltage is in a failure range.
    pub controller_failed: bool,
    /// The dead man has been released too long.
    pub dead_man: bool,
}

/// Events that were logged already, and events that wait to be taken.
#[derive(Clone, Debug)]
pub(super) struct Report {
    events: Vec<TcmsEvent>,
    /// Events that were not taken in time.
    pub lost: u32,
    found: EquipmentFailures,
    regeneration: CarSet,
    /// All inverters have cut out together: the contact line takes no power.
    line_takes_nothing: bool,
    /// Conditions of the last scan.
    conditions: [bool; 5],
    contradictions: u32,
    refused: BurstDetector,
    /// Whether the unit was silent, once it has been heard.
    silent: Option<bool>,
}

/// Most events that wait to be taken.
const MAX_WAITING: usize = 256;

impl Report {
    pub fn new(data: &TcmsData) -> Self {
        Self {
            events: Vec::new(),
            lost: 0,
            found: EquipmentFailures::default(),
            regeneration: CarSet::NONE,
            line_takes_nothing: false,
            conditions: [false; 5],
            contradictions: 0,
            refused: BurstDetector::new(
                data.refused_frames,
                Duration::from_secs(data.refused_within_s),
            ),
            silent: None,
        }
    }

    pub fn take(&mut self) -> Vec<TcmsEvent> {
        std::mem::take(&mut self.events)
    }

    /// Logs what began in this scan.
    pub fn step(&mut self, now: Instant, scan: &Scan<'_>) {
        self.found(scan);
        self.conditions(scan);
        self.link(now, scan);
    }

    /// Logs failures of the equipment, car by car.
    fn found(&mut self, scan: &Scan<'_>) {
        let (before, found) = (self.found, scan.view.found);
        if found != before {
            for (before, found, event) in [
                (before.inverters, found.inverters, Event::InverterFailed),
                (
                    before.brake_units,
                    found.brake_units,
                    Event::BrakeUnitFailed,
                ),
                (
                    before.cylinders,
                    found.cylinders,
                    Event::BrakeCylinderFailed,
                ),
                (
                    before.not_released,
                    found.not_released,
                    Event::BrakeNotReleased,
                ),
            ] {
                self.note_cars(found.without(before), event);
            }
            self.found = found;
        }
        let equipment = scan.inputs.equipment;
        let regeneration = equipment.map_or(CarSet::NONE, |e| e.regeneration_cut_out);
        if regeneration != self.regeneration {
            self.regeneration(regeneration, scan);
        }
    }

    /// Logs electric brakes that were cut out: by their inverters, or all at once by the contact line.
    fn regeneration(&mut self, cut_out: CarSet, scan: &Scan<'_>) {
        let new = cut_out.without(self.regeneration);
        self.regeneration = cut_out;
        let silent = scan
            .inputs
            .equipment
            .map_or(CarSet::NONE, |e| e.inverters_silent);
        let answering = scan
            .motors
            .without(silent)
            .without(scan.inputs.inverters_cut_out);
        let all = answering.without(cut_out).is_empty();
        // An inverter that is put back while the contact line takes no power is no new event.
        let line = all && (self.line_takes_nothing || new.iter().count() > 1);
        match (line, self.line_takes_nothing) {
            (true, false) => self.note(Event::RegenerationCutOut, ALL_CARS),
            (true, true) => {}
            (false, _) => self.note_cars(new, Event::RegenerationCutOut),
        }
        self.line_takes_nothing = line;
    }

    /// Reports conditions that are on or off.
    fn conditions(&mut self, scan: &Scan<'_>) {
        let cabs = &scan.inputs.cabs;
        let contacts = scan
            .inputs
            .active_cab()
            .is_some_and(|cab| cab.controller.contradicts());
        let conditions = [
            (scan.controller_failed, Event::ControllerFailed),
            (contacts, Event::ControllerContradicts),
            (cabs.iter().all(|cab| cab.hcr), Event::TwoCabsActive),
            (scan.inputs.main_reservoir_low, Event::MainReservoirLow),
            (scan.dead_man, Event::DeadMan),
        ];
        for ((holds, event), held) in conditions.into_iter().zip(self.conditions) {
            if holds && !held {
                let parameter = match event {
                    Event::ControllerFailed => (scan.view.volts * 1000.0).round() as i32,
                    _ => 0,
                };
                self.note(event, parameter);
            }
        }
        self.conditions = conditions.map(|(holds, _)| holds);
    }

    /// Logs what becomes of the link to the unit.
    fn link(&mut self, now: Instant, scan: &Scan<'_>) {
        let contradictions = scan.atc.contradictions;
        if contradictions != self.contradictions {
            self.contradictions = contradictions;
            self.note(Event::AtoOrderContradicts, i32::from(scan.atc.effort()));
        }
        let refused = scan.inputs.frames_refused;
        if self.refused.begins(now, refused) {
            let parameter = i32::try_from(refused).unwrap_or(i32::MAX);
            self.note(Event::AtcFramesRefused, parameter);
        }
        // Silence before the unit was first heard is a unit that is not switched on yet.
        let silent = scan.atc.silent;
        match (self.silent, silent) {
            (Some(false), true) => self.note(Event::AtcSilent, 0),
            (Some(true), false) => self.note(Event::AtcRestored, 0),
            (None, true) => return,
            _ => {}
        }
        self.silent = Some(silent);
    }

    fn note_cars(&mut self, cars: CarSet, event: Event) {
        for car in cars.iter() {
            self.note(event, car as i32 + 1);
        }
    }

    fn note(&mut self, event: Event, parameter: i32) {
        // When events are not taken, the newest are lost: what began first says more.
        if self.events.len() < MAX_WAITING {
            self.events.push(TcmsEvent { event, parameter });
        } else {
            self.lost = self.lost.saturating_add(1);
        }
    }
}
