//! A train newly put on the track knows nothing of its last drive.

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

use btu_rig::conditions::Conditions;
use btu_rig::lever::Lever;
use btu_rig::rig::Rig;
use btu_rig::stimulus::{Stimulus, TrainSwitch};
use btu_rig::train::{Train, TrainData, TrainInputs};
use protocol::event::Event;
use protocol::link::{End, Link};
use protocol::message::{AtcToTcms, AtcToTcmsBits, IoOutput, ModeSwitch, Outputs};
use protocol::signal::Signal;
use protocol::{CYCLE, Instant, SCAN};

use super::bench::order;

/// The rig and what a unit in automatic run would say to it.
struct Stand {
    rig: Rig,
    unit: Link,
    now: Instant,
    order: AtcToTcms,
    events: Vec<u16>,
}

impl Stand {
    fn new(train: TrainData) -> Self {
        let (unit, line) = crate::shipped();
        let mut rig = Rig::new(&unit, &line, 1);
        rig.set_train(train);
        let mut stand = Self {
            rig,
            unit: Link::new(End::Unit),
            now: Instant::from_ms(1000),
            order: order(AtcToTcmsBits::HOLDING_BRAKE, 0),
            events: Vec::new(),
        };
        stand.apply(Stimulus::ModeSwitch(ModeSwitch::Automatic));
        stand.run(500);
        stand
    }

    fn apply(&mut self, stimulus: Stimulus) {
        self.rig.apply(self.now, &stimulus).unwrap();
    }

    fn run(&mut self, ms: u64) {
        for _ in 0..ms / SCAN.as_ms() {
            self.now += SCAN;
            if self.now.as_us().is_multiple_of(CYCLE.as_us()) {
                let mut said = Vec::new();
                let outputs = IoOutput {
                    outputs: Outputs::EB_RELAY,
                    ..IoOutput::default()
                };
                self.unit.send(self.now, &self.order.into(), &mut said);
                self.unit.send(self.now, &outputs.into(), &mut said);
                self.rig.receive(self.now, &said);
            }
            self.rig.step(self.now, &mut Vec::new());
            let events = self.rig.take_events();
            self.events.extend(events.iter().map(|event| event.code));
        }
    }

    fn value(&self, signal: Signal) -> f64 {
        self.rig.sample().get(signal).unwrap()
    }

    /// Takes the train off the track as it drives, and puts it back at standstill.
    fn put_anew(&mut self) {
        self.apply(Stimulus::TrainDriven { on: false });
        self.order = order(AtcToTcmsBits::HOLDING_BRAKE, 0);
        while self.rig.truth().speed_mps > 0.0 {
            self.run(100);
        }
        self.run(1000);
        assert_eq!(self.value(Signal::TcmsHolding), 1.0);
        self.events.clear();
        self.apply(Stimulus::TrainDriven { on: true });
    }
}

/// The equipment of a train that is put on the track again reports what that of a new train reports.
#[test]
fn a_train_put_anew_reports_nothing_of_its_last_drive() {
    for data in [TrainData::line6(), TrainData::ideal()] {
        for effort_n in [50e3, -50e3] {
            let mut train = Train::new(&data, &Conditions::default());
            let new = train.equipment();
            let inputs = TrainInputs {
                demand: effort_n / 50e3,
                motor_n: [effort_n; 12],
                air_n: [20e3; 12],
                emergency: true,
                parking: true,
                regeneration_refused: true,
                ..TrainInputs::default()
            };
            (0..400).for_each(|_| _ = train.step(0.005, &inputs));
            assert_ne!(train.equipment(), new);
            train.place(0.0);
            assert_eq!(train.equipment(), new);
        }
    }
}

/// Off the track in full power, back on 35 ‰ under the holding brake, which is on from the first scan. The train comes
/// without effort, and rolls back, by less than 15 cm, until its brake has built up.
#[test]
fn the_last_drives_traction_releases_no_holding_brake() {
    for train in [TrainData::line6(), TrainData::ideal()] {
        let mut stand = Stand::new(train);
        stand.apply(Stimulus::Gradient {
            permille: Some(35.0),
        });
        stand.apply(Stimulus::TrainDriven { on: true });
        stand.order = order(AtcToTcmsBits::POWER, 1023);
        stand.run(10_000);
        assert!(stand.value(Signal::Traction) > 10e3);
        stand.put_anew();
        let from_m = stand.rig.truth().position_m;
        for _ in 0..300 {
            stand.run(10);
            assert_eq!(stand.value(Signal::TcmsHolding), 1.0);
        }
        // ATO asks for the holding brake no more, but no motor car pulls: the brake stays on.
        stand.order = order(AtcToTcmsBits::empty(), 0);
        stand.run(3000);
        assert_eq!(stand.value(Signal::TcmsHolding), 1.0);
        let rolled_m = from_m - stand.rig.truth().position_m;
        println!("put on 35 ‰ again: rolls back {rolled_m:.3} m");
        assert!((0.0..0.15).contains(&rolled_m), "{rolled_m} m");
    }
}

/// Off the track while braking on a line that takes no power, back on one that does.
#[test]
fn the_last_drives_cut_outs_are_no_events() {
    let mut stand = Stand::new(TrainData::line6());
    stand.apply(Stimulus::TrainDriven { on: true });
    stand.order = order(AtcToTcmsBits::POWER, 1023);
    stand.run(15_000);
    stand.apply(Stimulus::Switch {
        switch: TrainSwitch::Regeneration,
        on: false,
    });
    stand.order = order(AtcToTcmsBits::BRAKE, -1024);
    stand.run(3000);
    let code = Event::RegenerationCutOut.definition().code;
    assert!(stand.events.contains(&code));
    stand.apply(Stimulus::Switch {
        switch: TrainSwitch::SecurityBrake,
        on: true,
    });
    stand.run(100);
    stand.apply(Stimulus::Switch {
        switch: TrainSwitch::SecurityBrake,
        on: false,
    });
    stand.apply(Stimulus::Switch {
        switch: TrainSwitch::Regeneration,
        on: true,
    });
    stand.put_anew();
    stand.run(5000);
    assert!(stand.events.is_empty(), "{:?}", stand.events);
}

/// The bench is made safe with the holding brake on, and the unit asks for the brake 200 ms longer: the brake is off
/// when the unit does not ask any more.
#[test]
fn making_safe_leaves_no_holding_brake_behind() {
    let mut stand = Stand::new(TrainData::line6());
    stand.apply(Stimulus::TrainDriven { on: true });
    stand.run(2000);
    assert_eq!(stand.value(Signal::TcmsHolding), 1.0);
    stand.rig.make_safe(stand.now);
    stand.run(200);
    stand.order = AtcToTcms::default();
    stand.run(500);
    assert_eq!(stand.value(Signal::TcmsHolding), 0.0);
    // With a driver, standstill alone puts no holding brake on; a brake by the lever that lasts does.
    stand.apply(Stimulus::TrainDriven { on: true });
    stand.run(3000);
    assert_eq!(stand.value(Signal::TcmsHolding), 0.0);
    stand.apply(Stimulus::Controller {
        lever: Lever::Brake(1),
    });
    stand.run(1200);
    assert_eq!(stand.value(Signal::TcmsHolding), 1.0);
}
