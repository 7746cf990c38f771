//! The rig as a whole, against a unit that is nothing but a script of answers.

mod driving;
mod fake_unit;
mod on_train;
mod properties;
mod session;
mod tcms_events;
mod train;
mod train_faults;
mod trust;
mod wire;

use protocol::config::UnitConfig;
use protocol::line::Line;
use protocol::message::{AtcToTcms, AtcToTcmsBits, Mode};
use protocol::signal::Signal;

use super::{Bench, Rig, UnitLink};
use crate::procedure::Refusal;
use crate::stimulus::Stimulus;
use fake_unit::FakeUnit;

fn config() -> UnitConfig {
    UnitConfig::from_toml(include_str!("../../../../scripts/units/sg100.toml")).unwrap()
}

fn line() -> Line {
    Line::from_toml(include_str!("../../../../scripts/lines/line8.toml")).unwrap()
}

fn rig(seed: u64) -> Rig {
    Rig::new(&config(), &line(), seed)
}

fn bench(unit: FakeUnit) -> Bench<FakeUnit> {
    Bench::new(rig(1), unit)
}

/// Trouble of the link as text; empty if there is none.
fn link_error<L: UnitLink>(bench: &Bench<L>) -> String {
    let error = bench.rig.link_error();
    error.map_or_else(String::new, |error| error.to_string())
}

/// An order of ATO in automatic run.
fn order(bits: AtcToTcmsBits, effort: i16) -> AtcToTcms {
    AtcToTcms {
        bits,
        effort,
        mode: Mode::AutomaticRun,
        ..AtcToTcms::default()
    }
}

impl<L: UnitLink> Bench<L> {
    fn run_ms(&mut self, ms: u64) {
        for _ in 0..ms / 10 {
            self.tick().unwrap();
        }
    }

    fn apply(&mut self, stimulus: Stimulus) {
        let now = self.now();
        self.rig.apply(now, &stimulus).unwrap();
    }

    /// Why the rig refuses a stimulus.
    fn refusal(&mut self, stimulus: Stimulus) -> String {
        let now = self.now();
        self.rig.apply(now, &stimulus).unwrap_err().0
    }

    fn value(&self, signal: Signal) -> f64 {
        self.rig.sample().get(signal).unwrap()
    }

    fn make_safe(&mut self) {
        let now = self.now();
        self.rig.make_safe(now);
    }

    fn note_stalled(&mut self) {
        let now = self.now();
        self.rig.note_stalled(now);
    }

    /// Applies and waits for the outcome, for at most 10 s.
    fn settle(&mut self, stimulus: Stimulus) -> Result<(), Refusal> {
        self.apply(stimulus);
        for _ in 0..1000 {
            self.tick().unwrap();
            if self.rig.settled()? {
                return Ok(());
            }
        }
        panic!("{stimulus:?} never settles");
    }
}
