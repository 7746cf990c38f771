//! One run: a fresh embedded unit on a bench, driven to the end.

use ato_under_test::Setup;
use btu_rig::drive::{Drive, DrivePlan, Ending, Outcome};
use btu_rig::rig::{Bench, Rig};
use protocol::Instant;
use protocol::config::UnitConfig;
use protocol::line::Line;

use super::Setting;
use crate::data::DataFile;
use crate::link::{SIM_SERIAL, SimLink};

/// What the bench of a run is made of.
#[derive(Clone)]
pub struct DriveBench {
    /// Unit configuration.
    pub config: DataFile<UnitConfig>,
    /// Track database.
    pub line: DataFile<Line>,
    /// What was changed in the configuration's file.
    pub settings: Vec<Setting>,
}

/// Drives `plan` once, in virtual time.
pub fn drive(bench: &DriveBench, plan: DrivePlan, seed: u64) -> Outcome {
    let setup = Setup {
        serial: SIM_SERIAL.into(),
        config: bench.config.content.clone(),
        config_crc: bench.config.crc,
        line: bench.line.content.clone(),
        tdb_crc: bench.line.crc,
        seed,
        faults: Vec::new(),
    };
    let rig = Rig::new(&bench.config.content, &bench.line.content, seed);
    let mut bench = Bench::new(rig, SimLink::new(setup, Instant::ZERO));
    let mut drive = Drive::new(plan);
    loop {
        let ticked = bench.tick();
        let now = bench.now();
        if let Err(failure) = ticked {
            return drive.abandon(Ending::LinkLost(failure.to_string()));
        }
        if let Some(outcome) = drive.step(now, bench.rig_mut()) {
            return outcome;
        }
    }
}
