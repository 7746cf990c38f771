//! Runs with a laptop alone on a train: the embedded unit aboard, and what a train's people and its supply do meanwhile.

use std::collections::BTreeMap;
use std::sync::Arc;

use btu_rig::procedure::{Procedure, Verdict};
use btu_rig::rig::{Bench, Harness, LinkTrouble, UnitLink};
use btu_rig::stimulus::Stimulus;
use protocol::frame::Decoder;
use protocol::message::{Channel, Message, ModeSwitch};
use protocol::signal::Signal;
use protocol::{Instant, Speed};

use super::bench_setup::SWITCHED_OFF;
use super::session::Session;
use super::settle::{READY_WITHIN, settled};
use super::workers::run_task;
use super::{BenchSetup, Task};
use crate::aboard::UnitAboard;
use crate::link::Pace;
use crate::stop::Stop;
use crate::test_support::{Heard, procedures, setup};

/// When it happens, after power-up: the steps are under way.
const AT_MS: u64 = 10_000;

/// Events that happen to the train.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Happens {
    Nothing,
    Moves,
    KeyTurned,
    ModeTurned,
    /// The supply fails for good.
    PowerLost,
    /// The unit fails for half a second.
    Restarted,
    Unplugged,
}

/// Frames and bytes of one direction, by message.
#[derive(Debug, Default)]
struct Traffic {
    decoder: Decoder,
    frames: BTreeMap<(u8, &'static str), u64>,
    bytes: usize,
    /// Most of them in 50 ms.
    busiest: usize,
    cycle: usize,
}

impl Traffic {
    fn note(&mut self, now: Instant, bytes: &[u8]) {
        self.bytes += bytes.len();
        if now.as_us().is_multiple_of(50_000) {
            self.busiest = self.busiest.max(self.cycle);
            self.cycle = 0;
        }
        self.cycle += bytes.len();
        self.decoder.push(bytes);
        while let Some(frame) = self.decoder.next_frame() {
            let (header, payload) = frame.expect("sound");
            let message = Message::decode(header.channel, payload).expect("known");
            *self
                .frames
                .entry((header.channel.code(), message.name()))
                .or_default() += 1;
        }
    }
}

/// The train, and the laptop's cable.
struct Line {
    train: UnitAboard,
    happens: Happens,
    to_unit: Traffic,
    from_unit: Traffic,
    /// Contacts never powered or released doors.
    safe: bool,
}

impl UnitLink for Line {
    fn exchange(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble> {
        let since_ms = now.since(Instant::ZERO + SWITCHED_OFF).as_ms();
        let begins = since_ms == AT_MS;
        let done = match self.happens {
            Happens::Moves if begins => self.train.push(Speed::from_kmh(5.0)),
            Happens::KeyTurned if begins => {
                self.train.apply(&Stimulus::MaintenanceKey { on: false })
            }
            Happens::ModeTurned if begins => {
                self.train.apply(&Stimulus::ModeSwitch(ModeSwitch::Yard))
            }
            Happens::PowerLost | Happens::Restarted if begins => {
                self.train.set_power(false);
                Ok(())
            }
            Happens::Restarted if since_ms == AT_MS + 500 => {
                self.train.set_power(true);
                Ok(())
            }
            _ => Ok(()),
        };
        done.expect("a train does that");
        self.to_unit.note(now, to_unit);
        let unplugged = self.happens == Happens::Unplugged && since_ms >= AT_MS;
        let heard: &[u8] = if unplugged { &[] } else { to_unit };
        let before = from_unit.len();
        self.train.exchange(now, heard, from_unit)?;
        if unplugged {
            from_unit.truncate(before);
        }
        self.from_unit.note(now, &from_unit[before..]);
        let sample = self.train.rig().sample();
        let on = |signal| sample.get(signal) == Some(1.0);
        self.safe &= !on(Signal::Power) && !on(Signal::DoorEnableLeft);
        self.safe &= !on(Signal::DoorEnableRight);
        Ok(())
    }
}

struct Laptop {
    setup: BenchSetup,
    procedures: Vec<Arc<Procedure>>,
}

impl Laptop {
    fn new(faults: &[&str]) -> Self {
        let setup = BenchSetup {
            harness: Harness::Auto,
            ..setup(faults)
        };
        let procedures = procedures(&setup);
        Self { setup, procedures }
    }

    /// A session on a train whose unit has started; that there is no harness is found out.
    fn on_train(&self, happens: Happens) -> Session<Line> {
        let power_at = Instant::ZERO + SWITCHED_OFF;
        let line = Line {
            train: self.setup.aboard(7, power_at),
            happens,
            to_unit: Traffic::default(),
            from_unit: Traffic::default(),
            safe: true,
        };
        let mut rig = self.setup.rig(7, power_at);
        rig.set_harness(self.setup.harness);
        let bench = Bench::new(rig, line);
        let mut session = Session::new(bench, Pace::Virtual, Stop::default(), true);
        let (ready, faults) = session.judge_bring_up(SWITCHED_OFF + READY_WITHIN, settled());
        assert!(ready && faults.is_empty(), "{:?}", session.link_error());
        session
    }

    fn run(&self, id: &str, session: &mut Session<Line>) -> Heard {
        let procedure = self.procedures.iter().find(|p| p.id == id).expect("there");
        let task = Task::from(procedure.clone());
        let mut heard = Heard::default();
        let mut sink = |event| heard.take(event);
        let began = session.now();
        run_task(session, &task, Vec::new(), began, &mut sink, &|| true);
        heard
    }
}

/// The suite of a laptop alone.
const SUITE: [&str; 6] = [
    "ptu/identity",
    "ptu/limit_speed",
    "ptu/markers",
    "ptu/overspeed",
    "ptu/self_test",
    "ptu/twc",
];

/// Goal: on a good train the whole suite passes with nothing but the maintenance channel on the line, which it fills to
/// 40 % at most. Method: one session, frames counted at the cable.
#[test]
fn the_suite_of_a_laptop_passes_on_a_good_train_within_the_bytes_of_its_line() {
    let laptop = Laptop::new(&[]);
    let mut session = laptop.on_train(Happens::Nothing);
    let mut timed = 0;
    for id in SUITE {
        let heard = laptop.run(id, &mut session);
        assert_eq!(
            heard.verdict,
            Some(Verdict::Passed),
            "{id}: {:?}",
            heard.steps
        );
        let measured = heard.steps.iter().flat_map(|step| &step.measurements);
        for measurement in measured.filter(|m| m.name.ends_with("reaction")) {
            let off = measurement.uncertainty.expect("by the unit's clock");
            assert!(off > 0.0 && off <= 60.0, "{} ± {off}", measurement.name);
            timed += 1;
        }
    }
    assert!(timed > 0, "times are measured");
    let seconds = session.now().since(Instant::ZERO + SWITCHED_OFF).as_secs();
    let line = &session.bench.link;
    assert!(line.safe, "braked and barred all the time");
    for (name, traffic, least) in [("to", &line.to_unit, 0.0), ("from", &line.from_unit, 0.05)] {
        let ptu = Channel::Ptu.code();
        assert!(
            traffic.frames.keys().all(|(channel, _)| *channel == ptu),
            "{:?}",
            traffic.frames
        );
        let share = traffic.bytes as f64 * 10.0 / 115_200.0 / seconds;
        println!(
            "{name} the unit: {} bytes in {seconds:.1} s, {:.1} %; most in 50 ms {}; {:?}",
            traffic.bytes,
            share * 100.0,
            traffic.busiest,
            traffic.frames
        );
        assert!(share > least && share <= 0.4, "{share}");
        assert!(traffic.busiest < 400, "{}", traffic.busiest);
    }
}

/// Goal: what others do to the train is no fault of its unit: the procedure ends as an error that says what happened,
/// and outputs stay safe. Method: each of it in a step of the overspeed procedure.
#[test]
fn what_happens_to_the_train_meanwhile_is_an_error_and_no_fault() {
    let laptop = Laptop::new(&[]);
    for (happens, words) in [
        (Happens::Moves, "the train moved"),
        (Happens::KeyTurned, "the maintenance key was turned off"),
        (Happens::ModeTurned, "the mode switch was turned"),
        (Happens::PowerLost, "unit silent for"),
        (Happens::Restarted, "the unit restarted"),
        (Happens::Unplugged, "unit silent for"),
    ] {
        let mut session = laptop.on_train(happens);
        let heard = laptop.run("ptu/overspeed", &mut session);
        let what = format!("{happens:?}: {} {:?}", heard.message, heard.steps);
        assert_eq!(heard.verdict, Some(Verdict::Error), "{what}");
        assert!(heard.message.contains(words), "{what}");
        assert_eq!(heard.faults, [""; 0], "{what}");
        assert!(session.bench.link.safe, "{what}");
        let train = session.bench.link.train.rig().sample();
        if happens == Happens::Moves {
            assert_eq!(train.get(Signal::Eb), Some(1.0), "{what}");
        }
    }
}

/// Goal: a train that is not as a procedure needs it is reported, before anything is tested.
#[test]
fn a_train_that_is_not_at_rest_is_refused_with_the_reason() {
    let laptop = Laptop::new(&[]);
    let mut session = laptop.on_train(Happens::Nothing);
    let key = Stimulus::MaintenanceKey { on: false };
    let train = &mut session.bench.link.train;
    train.apply(&key).expect("done");
    let heard = laptop.run("ptu/markers", &mut session);
    assert_eq!(heard.verdict, Some(Verdict::Error), "{}", heard.message);
    assert!(
        heard.message.contains("maintenance_key"),
        "{}",
        heard.message
    );
    assert!(
        heard
            .steps
            .iter()
            .all(|step| step.verdict == Verdict::Skipped)
    );
}

/// Goal: a slow relay is found by a laptop alone, with a time that says how sure it is.
#[test]
fn a_slow_relay_is_found_on_a_train() {
    let laptop = Laptop::new(&["eb_relay.slow"]);
    let mut session = laptop.on_train(Happens::Nothing);
    let heard = laptop.run("ptu/overspeed", &mut session);
    assert_eq!(heard.verdict, Some(Verdict::Failed), "{:?}", heard.steps);
    let mut measured = heard.steps.iter().flat_map(|step| &step.measurements);
    let reaction = measured.find(|m| m.name == "eb_reaction");
    let reaction = reaction.expect("measured");
    assert_eq!(reaction.verdict, Verdict::Failed, "{reaction:?}");
    let (value, off) = (reaction.value.expect("a value"), reaction.uncertainty);
    let (off, high) = (off.expect("uncertain"), reaction.high.expect("a limit"));
    assert!(value - off > high, "{value} ± {off}, at most {high}");
    assert!(
        heard
            .steps
            .iter()
            .any(|step| step.findings.to_string().contains(" ± "))
    );
}

#[test]
fn a_procedure_of_a_bench_is_skipped_on_a_train() {
    let laptop = Laptop::new(&[]);
    let mut session = laptop.on_train(Happens::Nothing);
    let heard = laptop.run("atp/overspeed", &mut session);
    assert_eq!(heard.verdict, Some(Verdict::Skipped));
    assert!(
        heard.message.contains("needs the bench harness"),
        "{}",
        heard.message
    );
    assert!(!heard.steps.is_empty());
}

/// Goal: a unit that restarts by itself says so, and is the finding: not an error, as a supply that somebody switched is.
#[test]
fn a_supply_that_dips_on_a_train_is_a_fault_of_the_unit() {
    let laptop = Laptop::new(&["power_supply.dips"]);
    let mut session = laptop.on_train(Happens::Nothing);
    let heard = laptop.run("ptu/overspeed", &mut session);
    let what = format!("{} {:?}", heard.message, heard.steps);
    assert_eq!(heard.verdict, Some(Verdict::Failed), "{what}");
    let mut faults = heard.faults.iter();
    assert!(faults.any(|told| told.starts_with("supply_dip ")), "{what}");
}
