//! The embedded unit aboard a simulated train: the laptop's case, without a bench.
//!
//! A rig plays everything around the unit through the harness, as frames: cab, doors, wheels, TCMS, cars and
//! wayside. Its own tester is silent. What is outside of the train reaches the unit at the maintenance port alone.
//!
//! [`UnitAboard`] is a [`UnitLink`], so a tester's [`Bench`] takes it in place of a unit on its harness, in virtual
//! time, the same for the same seed:
//!
//! * `BenchSetup::aboard` builds one from unit configuration, line, train and faults, standing in a depot;
//! * [`UnitAboard::exchange`](UnitLink::exchange) is one scan of unit and train, so it is called once a scan;
//! * [`UnitAboard::apply`] does what a driver or the track does to the train: any [`Stimulus`] but those of a tester;
//! * [`UnitAboard::push`] moves the train whatever its brakes do, [`UnitAboard::set_power`] switches the unit's
//!   supply, whose flash outlives it;
//! * [`UnitAboard::drive`] is a run from station to station by the unit's ATO, in virtual time and without a tester;
//!   [`UnitAboard::return_to_depot`] ends a service.

mod service;

use ato_under_test::flash::BlockDevice;
use btu_rig::lever::Lever;
use btu_rig::procedure::Refusal;
use btu_rig::rig::{Bench, LinkTrouble, Rig, UnitLink};
use btu_rig::stimulus::{StationData, Stimulus, WaysideCondition};
use protocol::line::Section;
use protocol::message::ModeSwitch;
use protocol::{Instant, Speed};

use crate::link::SimLink;

pub use service::{Arrival, Doors};

/// Fastest that a train is pushed, km/h; a value of this program.
pub const MAX_PUSH_KMH: f64 = 100.0;
/// How fast a pushed train gains and loses speed, m/s² [default].
const PUSH_MPS2: f64 = 0.5;

/// How a train stands in a depot: a manned cab, ready to be driven by hand, the maintenance key on, and neither
/// code nor loop under it, so that the unit asks for the full service brake.
const IN_DEPOT: [Stimulus; 12] = [
    Stimulus::TrainDriven { on: false },
    Stimulus::Direction { backward: false },
    Stimulus::CodeOff,
    Stimulus::MarkersAlong { section: None },
    Stimulus::Wayside(WaysideCondition::Silent),
    Stimulus::Hcr { on: true },
    Stimulus::Reverser { position: 1 },
    Stimulus::Controller {
        lever: Lever::Neutral,
    },
    Stimulus::ModeSwitch(ModeSwitch::Manual),
    Stimulus::Doors { closed: true },
    Stimulus::MaintenanceKey { on: true },
    Stimulus::TrainDriven { on: true },
];

/// A unit and the train it is built into.
pub struct UnitAboard {
    train: Bench<SimLink>,
    /// The train is pushed, and is to go on by itself once it stands.
    comes_to_rest: bool,
}

impl UnitAboard {
    /// A train that stands in a depot. Neither rig nor unit may have been stepped.
    pub fn in_depot(mut rig: Rig, unit: SimLink) -> Self {
        // The only tester is outside of the train.
        must(rig.apply(Instant::ZERO, &Stimulus::PtuSilent { on: true }));
        let mut aboard = Self {
            train: Bench::new(rig, unit),
            comes_to_rest: false,
        };
        IN_DEPOT
            .iter()
            .for_each(|stimulus| must(aboard.apply(stimulus)));
        aboard
    }

    /// Gives the unit the flash that the unit had before; no scan may have been made yet.
    pub fn set_flash(&mut self, flash: Box<dyn BlockDevice>) {
        self.train.link.set_flash(flash);
    }

    /// Draws arm challenges of the unit from another seed; no scan may have been made yet.
    pub fn draw_challenges(&mut self, seed: u64) {
        self.train.link.draw_challenges(seed);
    }

    /// Puts the standing train at the departure station of a section, over its loop and under the section's codes;
    /// no departure is given.
    ///
    /// # Errors
    /// The section has a code that the unit does not know.
    pub fn stand_at(&mut self, section: &Section) -> Result<(), Refusal> {
        let number = section.section;
        let station = StationData::at_departure(section);
        self.apply(&Stimulus::MarkersAlong {
            section: Some(number),
        })?;
        self.apply(&Stimulus::CodesAlong { on: true })?;
        self.apply(&Stimulus::Station(station))?;
        self.apply(&Stimulus::Wayside(WaysideCondition::Good))
    }

    /// Applies a stimulus to train or track, from the next scan on.
    ///
    /// # Errors
    /// The stimulus is impossible for the train, or is for a tester alone.
    pub fn apply(&mut self, stimulus: &Stimulus) -> Result<(), Refusal> {
        let now = self.train.now();
        self.train.rig.apply(now, stimulus)
    }

    /// Pushes the train up to a speed, backward below 0; 0 brings it to rest, and there it is left to itself.
    ///
    /// # Errors
    /// A speed above [`MAX_PUSH_KMH`], or another direction while it moves; nothing is done then.
    pub fn push(&mut self, to: Speed) -> Result<(), Refusal> {
        if !(-MAX_PUSH_KMH..=MAX_PUSH_KMH).contains(&to.kmh()) {
            let text = format!("a train is pushed at {MAX_PUSH_KMH} km/h at most");
            return Err(Refusal(text));
        }
        let now_mps = self.train.rig.truth().speed_mps;
        if now_mps * to.mps() < 0.0 {
            let text = "the train moves the other way: bring it to rest first";
            return Err(Refusal(text.to_owned()));
        }
        self.apply(&Stimulus::TrainDriven { on: false })?;
        self.comes_to_rest = to == Speed::ZERO;
        if now_mps == 0.0 {
            let backward = to < Speed::ZERO;
            self.apply(&Stimulus::Direction { backward })?;
        }
        self.apply(&Stimulus::Speed {
            to: Speed::from_mps(to.mps().abs()),
            accel_mps2: PUSH_MPS2,
        })
    }

    /// Switches the unit's supply off, or on again, which powers the unit up.
    pub fn set_power(&mut self, on: bool) {
        let now = self.train.now();
        self.train.link.set_power(now, on);
    }

    /// The unit has its supply.
    pub fn powered(&self) -> bool {
        self.train.link.powered()
    }

    /// The rig around the unit, for looking at true motion, contacts and mode.
    pub fn rig(&self) -> &Rig {
        &self.train.rig
    }

    /// Time of the last scan.
    pub fn now(&self) -> Instant {
        self.train.now()
    }

    /// Another tester is connected from now on.
    pub fn reset_connection(&mut self) {
        self.train.link.reset_maintenance();
    }

    /// Frames of testers that the unit accepted since it was powered up.
    pub fn frames_accepted(&self) -> u64 {
        self.train.link.maintenance_accepted()
    }

    /// One scan of unit and train.
    fn scan(&mut self) -> Result<(), LinkTrouble> {
        self.train.tick()?;
        if self.comes_to_rest && self.train.rig.motion_settled() {
            self.comes_to_rest = false;
            must(self.apply(&Stimulus::Direction { backward: false }));
            must(self.apply(&Stimulus::TrainDriven { on: true }));
        }
        Ok(())
    }
}

impl UnitLink for UnitAboard {
    fn exchange(
        &mut self,
        _now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble> {
        self.train.link.receive_maintenance(to_unit);
        self.scan()?;
        self.train.link.take_maintenance(from_unit);
        Ok(())
    }
}

/// Applies a stimulus that is always possible on a standing train.
fn must(done: Result<(), Refusal>) {
    debug_assert!(done.is_ok(), "{done:?}");
}

#[cfg(test)]
mod tests;
