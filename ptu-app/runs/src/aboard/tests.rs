use btu_rig::drive::DrivePlan;
use protocol::link::{End, Link};
use protocol::message::{
    ArmRefusal, ArmRequest, Channel, EbCause, FsbCause, Identify, KeepAlive, Message, Mode,
    ReadLog, ReadRun, ReadStored, SelfTest, Status, StatusBits, StoreKind,
};
use protocol::signal::Signal;
use protocol::{CYCLE, SCAN};

use super::*;
use crate::test_support::setup;

/// A laptop on the maintenance port, that listens.
struct Laptop {
    aboard: UnitAboard,
    link: Link,
    to_unit: Vec<u8>,
    /// Bytes each way.
    sent: usize,
    heard: Vec<u8>,
    messages: Vec<Message>,
}

impl Laptop {
    fn of(aboard: UnitAboard) -> Self {
        Self {
            aboard,
            link: Link::new(End::Bench),
            to_unit: Vec::new(),
            sent: 0,
            heard: Vec::new(),
            messages: Vec::new(),
        }
    }

    /// A train in the depot whose unit has started.
    fn in_depot(faults: &[&str]) -> Self {
        let mut laptop = Self::of(setup(faults).aboard(3, Instant::ZERO));
        laptop.run(300);
        laptop
    }

    fn send(&mut self, message: impl Into<Message>) {
        let now = self.aboard.now();
        self.link.send(now, &message.into(), &mut self.to_unit);
    }

    /// Scans; a keep-alive comes every 200 ms.
    fn run(&mut self, scans: u64) {
        self.messages.clear();
        for _ in 0..scans {
            if self.aboard.now().as_us().is_multiple_of(200_000) {
                self.send(KeepAlive { session: 0 });
            }
            let before = self.heard.len();
            let now = self.aboard.now() + SCAN;
            let exchanged = self.aboard.exchange(now, &self.to_unit, &mut self.heard);
            exchanged.expect("exchanged");
            self.sent += self.to_unit.len();
            self.to_unit.clear();
            self.link.push(&self.heard[before..]);
            while let Some(received) = self.link.poll(now) {
                assert_eq!(received.header.channel, Channel::Ptu);
                self.messages.push(received.message);
            }
        }
        assert_eq!(self.link.counters().rejected_total(), 0);
    }

    /// The last one that was heard.
    fn status(&self) -> Status {
        let statuses = self.messages.iter().rev();
        let status = statuses.filter_map(|message| match message {
            Message::Status(status) => Some(*status),
            _ => None,
        });
        status.take(1).next().expect("a status")
    }

    fn has(&self, bits: StatusBits) -> bool {
        self.status().bits.contains(bits)
    }

    fn count(&self, wanted: fn(&Message) -> bool) -> usize {
        self.messages
            .iter()
            .filter(|message| wanted(message))
            .count()
    }

    fn cab(&mut self, stimulus: Stimulus) {
        self.aboard.apply(&stimulus).expect("a train does that");
    }
}

/// Goal: the train does the unit's inputs, and only what a laptop may hear comes out. Method: a good one in the
/// depot. In 3 s there are 60 cycles of one `Status` (60 bytes, stuffing not counted) and 15 keep-alives of 21.
#[test]
fn in_the_depot_a_good_unit_has_all_inputs_and_holds_the_train() {
    let laptop = Laptop::in_depot(&[]);
    let status = laptop.status();
    let inputs = StatusBits::INPUTS_OK | StatusBits::TCMS_OK | StatusBits::TRA_OK;
    assert!(laptop.has(inputs | StatusBits::STARTED), "{status:?}");
    assert!(!laptop.has(StatusBits::TWC_OK), "no loop");
    assert_eq!(status.mode, Mode::Manual);
    assert_eq!(status.eb_cause, EbCause::None);
    assert_eq!(status.fsb_cause, FsbCause::NoCode);
    assert_eq!(status.self_test, SelfTest::empty());
    assert_eq!(status.rejected_frames, 0);
    let cycles = 3_000_000 / CYCLE.as_us() as usize;
    let (to_unit, from_unit) = (laptop.sent, laptop.heard.len());
    assert!((15 * 21..16 * 23).contains(&to_unit), "{to_unit} bytes");
    assert!(
        (cycles * 56..cycles * 64).contains(&from_unit),
        "{from_unit} bytes"
    );
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    assert!(Laptop::in_depot(&[]).heard == Laptop::in_depot(&[]).heard);
}

#[test]
fn a_unit_whose_key_is_turned_off_is_not_armed() {
    let mut laptop = Laptop::in_depot(&[]);
    let mut refusal = |on| {
        laptop.cab(Stimulus::MaintenanceKey { on });
        laptop.run(10);
        laptop.send(ArmRequest { session: 5 });
        laptop.run(2);
        laptop.messages.iter().find_map(|message| match message {
            Message::ArmState(state) => Some(state.refusal),
            Message::ArmChallenge(_) => Some(ArmRefusal::None),
            _ => None,
        })
    };
    assert_eq!(refusal(false), Some(ArmRefusal::KeyOff));
    assert_eq!(refusal(true), Some(ArmRefusal::None));
}

/// Goal: a pushed train moves really, the unit brakes it, and the train is left as it was. Method: 5 km/h without a
/// code, at rest again, acknowledged.
#[test]
fn a_pushed_train_moves_whatever_its_brakes_do() {
    let mut laptop = Laptop::in_depot(&[]);
    laptop.aboard.push(Speed::from_kmh(12.0)).expect("pushed");
    laptop.run(1000);
    let status = laptop.status();
    assert!(status.speed1_cms.abs_diff(333) <= 2, "{status:?}");
    assert_ne!(status.eb_cause, EbCause::None, "{status:?}");
    laptop.aboard.push(Speed::ZERO).expect("let stand");
    laptop.run(1500);
    assert_eq!(laptop.status().speed1_cms, 0);
    laptop.cab(Stimulus::Acknowledge);
    laptop.run(100);
    assert_eq!(laptop.status().eb_cause, EbCause::None);
    assert_eq!(laptop.aboard.rig().truth().speed_mps, 0.0);
    laptop
        .aboard
        .push(Speed::from_kmh(-3.0))
        .expect("pushed back");
    laptop.run(600);
    let truth = laptop.aboard.rig().truth();
    assert!((truth.speed_mps + 3.0 / 3.6).abs() < 0.01, "{truth:?}");
    for (kmh, words) in [
        (3.0, "the other way"),
        (101.0, "at most"),
        (f64::NAN, "at most"),
    ] {
        let refused = laptop.aboard.push(Speed::from_kmh(kmh)).expect_err(words);
        assert!(refused.0.contains(words), "{refused:?}");
    }
    laptop.run(100);
    let goes_on = laptop.aboard.rig().truth().speed_mps;
    assert!((goes_on + 3.0 / 3.6).abs() < 0.01, "{goes_on} m/s");
    laptop.aboard.push(Speed::ZERO).expect("let stand");
    laptop.run(300);
    assert_eq!(laptop.aboard.rig().truth().speed_mps, 0.0);
}

/// Goal: a unit without supply says nothing and lets the brake line open; it starts again when it gets it back. Method:
/// for 3 s, then for as short a time as it can be.
#[test]
fn a_unit_that_loses_its_supply_starts_anew() {
    let mut laptop = Laptop::in_depot(&[]);
    laptop.aboard.set_power(false);
    laptop.run(300);
    assert!(laptop.messages.is_empty() && !laptop.aboard.powered());
    let line = laptop.aboard.rig().sample().get(Signal::EbLoop);
    assert_eq!(line, Some(1.0), "emergency brake");
    laptop.aboard.set_power(true);
    laptop.run(100);
    laptop.send(Identify {});
    laptop.run(200);
    let uptime = laptop.messages.iter().find_map(|message| match message {
        Message::Identity(identity) => Some(identity.uptime_ms),
        _ => None,
    });
    assert!(
        uptime.is_some_and(|ms| (990..1050).contains(&ms)),
        "{uptime:?}"
    );
    assert!(laptop.has(StatusBits::STARTED));
    assert_eq!(laptop.status().eb_cause, EbCause::None);
    laptop.aboard.set_power(false);
    laptop.aboard.set_power(true);
    laptop.run(150);
    assert!(laptop.messages.is_empty());
    laptop.run(300);
    assert_eq!(laptop.status().self_test, SelfTest::empty());
    assert_eq!(laptop.status().eb_cause, EbCause::None);
    laptop.send(ReadStored {
        store: StoreKind::Events,
        from_sequence: 0,
        per_cycle: 2,
    });
    laptop.run(100);
    let stored = laptop.messages.iter().filter_map(|message| match message {
        Message::StoredEntry(entry) => Some(entry.power_up),
        _ => None,
    });
    let mut power_ups: Vec<_> = stored.collect();
    power_ups.dedup();
    assert_eq!(power_ups, [1, 2, 3], "its flash outlives its supply");
}

/// Faults of the unit and of the train around it.
#[test]
fn faults_of_unit_and_train_are_aboard() {
    let unit = Laptop::in_depot(&["tra.dead"]);
    assert!(!unit.has(StatusBits::TRA_OK));
    let train = Laptop::in_depot(&["tcms.silent"]);
    assert!(!train.has(StatusBits::TCMS_OK));
}

/// Goal: a service leaves a log and a run record, and the train as it stood before. Method: two sections, which stop
/// within the tolerance of the doors; then the laptop reads both.
#[test]
fn a_service_is_in_the_log_and_in_the_run_record() {
    let setup = setup(&[]);
    let mut aboard = setup.aboard(3, Instant::ZERO);
    for section in [61, 62] {
        let (config, line) = (&setup.config.content, &setup.line.content);
        let plan = DrivePlan::new(config, line, setup.train.clone(), section, None);
        let arrival = aboard.drive(plan.expect("a plan")).expect("driven");
        assert!(arrival.stopped(), "{section}: {}", arrival.outcome.ending);
        assert_eq!(arrival.doors, Doors::Opened, "section {section}");
        let error_m = arrival.outcome.stop_error_m.expect("it stands");
        assert!(error_m.abs() < 0.3, "{section}: {error_m} m");
    }
    aboard.return_to_depot().expect("in the depot");
    let mut laptop = Laptop::of(aboard);
    laptop.send(ReadLog { from_index: 0 });
    laptop.run(200);
    assert!(laptop.count(|m| matches!(m, Message::LogEntry(_))) > 5);
    assert_eq!(laptop.count(|m| matches!(m, Message::LogEnd(_))), 1);
    let status = laptop.status();
    assert_eq!(
        (status.mode, status.eb_cause),
        (Mode::Manual, EbCause::None)
    );
    assert_eq!(status.fsb_cause, FsbCause::NoCode);
    laptop.send(ReadRun { from_index: 0 });
    laptop.run(6000);
    let rows = laptop.count(|m| matches!(m, Message::RunRow(_)));
    assert!(rows > 1000, "{rows} rows of 50 ms");
}
