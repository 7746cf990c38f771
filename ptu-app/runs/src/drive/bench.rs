//! Drives one run to its end with a fresh embedded unit.

use ato_under_test::Setup;
use btu_rig::drive::{Drive, DrivePlan, Ending, Outcome};
use btu_rig::rig::{Bench, Rig};
use protocol::Instant;
use protocol::config::UnitConfig;
use protocol::line::Line;

use super::Setting;
use crate::data::DataFile;
use crate::link::{SIM_SERIAL, SimLink};

/// Material of the bench of a drive.
#[derive(Clone)]
pub struct DriveBench {
    pub config: DataFile<UnitConfig>,
    /// Track database.
    pub line: DataFile<Line>,
    /// Changes to the configuration's file.
    pub settings: Vec<Setting>,
}

impl DriveBench {
    /// A fresh embedded unit on a rig, at the beginning of time.
    pub(crate) fn fresh(&self, seed: u64) -> Bench<SimLink> {
        let setup = Setup {
            serial: SIM_SERIAL.into(),
            config: self.config.content.clone(),
            config_crc: self.config.crc,
            line: self.line.content.clone(),
            tdb_crc: self.line.crc,
            seed,
            faults: Vec::new(),
        };
        let rig = Rig::new(&self.config.content, &self.line.content, seed);
        Bench::new(rig, SimLink::new(setup, Instant::ZERO))
    }
}

/// Drives `plan` once, in virtual time.
pub fn drive(bench: &DriveBench, plan: DrivePlan, seed: u64) -> Outcome {
    let mut bench = bench.fresh(seed);
    let mut drive = Drive::new(plan);
    loop {
        let ticked = bench.tick();
        let now = bench.now();
        if let Err(why) = ticked {
            return drive.abandon(Ending::LinkLost(why));
        }
        if let Some(outcome) = drive.step(now, &mut bench.rig) {
            return outcome;
        }
    }
}
