//! What a person chooses to test, by name, made into what benches are made of.

use std::path::PathBuf;
use std::sync::Arc;

use btu_rig::rig::check_places;
use protocol::message::Identity;

use super::BenchSetup;
use crate::data::ScriptsDirectory;
use crate::drive::train::train;
use crate::drive::{Setting, unit_config};
use crate::failure::Failure;
use crate::link::Endpoint;

/// A unit and its surroundings, by name.
#[derive(Clone, Debug)]
pub struct Choice {
    /// Where the unit is.
    pub unit: Endpoint,
    /// Line, `lines/NAME.toml`.
    pub line: String,
    /// Unit configuration, `units/NAME.toml`.
    pub unit_config: String,
    /// Train, `trains/NAME.toml` or a file.
    pub train: String,
    /// Changed keys of the unit configuration.
    pub settings: Vec<Setting>,
    /// Serial number: of the embedded unit, or expected of a real one.
    pub serial: Option<String>,
    /// Faults injected.
    pub faults: Vec<String>,
    /// Seed of everything random.
    pub seed: u64,
    /// Good units, trains and benches differ, as in this file or in the usual one.
    pub scatter: Option<Option<PathBuf>>,
    /// The wall clock's pace also for the embedded unit.
    pub realtime: bool,
    /// Times slower than the clock.
    pub slower: u32,
}

impl Choice {
    /// Reads and checks everything that is named.
    ///
    /// # Errors
    /// Something named is not there or wrong, or does not go together.
    pub fn setup(&self, directory: &ScriptsDirectory) -> Result<BenchSetup, Failure> {
        let faults = directory.chosen_faults(&self.faults)?;
        if self.unit != Endpoint::Sim && faults.iter().any(|fault| !fault.place.on_train()) {
            return Err(Failure::usage(
                "--inject puts faults of a unit into the embedded one only; inject into a served one with `ato-under-test --inject`",
            ));
        }
        if let Some(serial) = &self.serial {
            let longest = size_of_val(&Identity::default().serial);
            if serial.is_empty() || serial.len() > longest || !serial.is_ascii() {
                return Err(Failure::usage(format!(
                    "--serial-no must be 1 to {longest} ASCII characters"
                )));
            }
        }
        let config = unit_config(directory, &self.unit_config, &self.settings)?;
        let line = directory.line(&self.line)?;
        let train = train(directory, &self.train)?;
        check_places(&faults, &train).map_err(|wrong| Failure::usage(wrong.to_string()))?;
        let scatter = match &self.scatter {
            Some(given) => Some(Arc::new(directory.bench_scatter(given.as_deref())?)),
            None => None,
        };
        Ok(BenchSetup {
            endpoint: self.unit.clone(),
            config,
            line,
            train,
            faults,
            seed: self.seed,
            scatter,
            serial: self.serial.clone(),
            realtime: self.realtime,
            slower: self.slower,
            run_control: None,
        })
    }
}
