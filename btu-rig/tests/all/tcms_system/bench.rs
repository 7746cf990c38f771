//! TCMS on a train whose equipment gives at once what it is asked for, but for what is wrong with it.

use btu_rig::lever::Lever;
use btu_rig::tcms::{CabInputs, Tcms, TcmsInputs, TcmsView};
use btu_rig::train::{CarSet, Equipment, TrainData, TrainInputs};
use protocol::event::Event;
use protocol::message::{AtcToTcms, AtcToTcmsBits, Mode, ModeSwitch, Outputs};
use protocol::{CYCLE, Instant, SCAN};

/// TCMS and its surroundings.
pub struct Bench {
    pub tcms: Tcms,
    pub inputs: TcmsInputs<'static>,
    pub equipment: Equipment,
    /// The unit's order, sent every cycle.
    pub order: Option<AtcToTcms>,
    /// Cars whose cylinders stay full.
    pub stuck: CarSet,
    /// Cars whose cylinders get half of their pressure.
    pub weak: CarSet,
    /// Motor cars that give what they are asked for; all, but for tests that pull with some.
    pub pulling: CarSet,
    pub now: Instant,
    told: TrainInputs,
    sent: Instant,
}

pub fn cab(train: &TrainData, lever: Lever) -> CabInputs {
    CabInputs {
        reverser: 1,
        mode_switch: ModeSwitch::Manual,
        controller: train.tcms().at(lever),
        dead_man: true,
        ..CabInputs::default()
    }
}

/// An order of ATO in automatic run.
pub fn order(bits: AtcToTcmsBits, effort: i16) -> AtcToTcms {
    AtcToTcms {
        bits,
        mode: Mode::AutomaticRun,
        effort,
        ..AtcToTcms::default()
    }
}

impl Bench {
    /// The line 6 train at rest, driven by hand from the first cab, unit in order.
    pub fn new() -> Self {
        Self::of(&TrainData::line6())
    }

    pub fn of(train: &TrainData) -> Self {
        let mut first = cab(train, Lever::Neutral);
        first.hcr = true;
        let mut all = CarSet::NONE;
        (0..btu_rig::train::MAX_CARS).for_each(|car| all.set(car, true));
        Self {
            tcms: Tcms::new(train),
            inputs: TcmsInputs {
                cabs: [first, cab(train, Lever::Neutral)],
                doors_closed: true,
                contacts: Some(Outputs::EB_RELAY),
                ..TcmsInputs::default()
            },
            equipment: Equipment::default(),
            order: Some(AtcToTcms::default()),
            stuck: CarSet::NONE,
            weak: CarSet::NONE,
            pulling: all,
            now: Instant::ZERO,
            told: TrainInputs::default(),
            sent: Instant::ZERO,
        }
    }

    /// A bench in automatic, under an order of ATO.
    pub fn automatic(bits: AtcToTcmsBits, effort: i16) -> Self {
        let mut bench = Self::new();
        bench.inputs.cabs[0].mode_switch = ModeSwitch::Automatic;
        bench.order = Some(order(bits, effort));
        bench
    }

    /// Puts the lever of the first cab somewhere.
    pub fn lever(&mut self, lever: Lever) {
        self.inputs.cabs[0].controller = self.tcms.data.at(lever);
    }

    /// All axles at a speed.
    pub fn speed_kmh(&mut self, kmh: f64) {
        self.equipment.axle_mps = [kmh / 3.6; btu_rig::train::MAX_CARS];
    }

    pub fn run(&mut self, ms: u64) -> TrainInputs {
        for _ in 0..ms / SCAN.as_ms() {
            self.now += SCAN;
            if self.now.since(self.sent) >= CYCLE {
                self.sent = self.now;
                if let Some(order) = &self.order {
                    self.tcms.atc.receive(self.now, order);
                }
            }
            self.follow();
            let inputs = TcmsInputs {
                equipment: Some(&self.equipment),
                ..self.inputs
            };
            self.told = self.tcms.step(self.now, &inputs);
        }
        self.told
    }

    fn follow(&mut self) {
        let told = &self.told;
        self.equipment.other_brakes = told.emergency || told.security || told.parking;
        for car in 0..btu_rig::train::MAX_CARS {
            let pulls = self.pulling.contains(car);
            self.equipment.traction_n[car] = if pulls {
                told.motor_n[car].max(0.0)
            } else {
                0.0
            };
            self.equipment.electric_n[car] = (-told.motor_n[car]).max(0.0);
            let mut air_n = told.air_n[car];
            if self.weak.contains(car) {
                air_n *= 0.5;
            }
            if self.stuck.contains(car) && !told.forced_release {
                air_n = air_n.max(50_000.0);
            }
            self.equipment.air_n[car] = air_n;
        }
    }

    pub fn view(&self) -> &TcmsView {
        &self.tcms.view
    }

    /// The full service brake is on.
    pub fn full_service(&self) -> bool {
        self.view().brake.bcyinfsb
    }

    /// Something is asked of an inverter.
    pub fn powers(&self) -> bool {
        self.told.motor_n.iter().any(|n| *n > 0.0)
    }

    /// New events.
    pub fn events(&mut self) -> Vec<Event> {
        let events = self.tcms.take_events();
        events.iter().map(|event| event.event).collect()
    }
}
