//! Choices that a tester makes by name: the unit, its configuration, the line, the train and the injected
//! faults.
//!
//! Command line and window fill in the same [`BenchChoice`]; [`BenchChoice::setup`] reads the named files and
//! checks that they fit together.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use btu_rig::procedure::plan::Connection;
use btu_rig::rig::{ExpectedIdentity, Harness, check_places};
use protocol::injection::FaultMode;
use protocol::message::Identity;
use serde::{Deserialize, Serialize};

use super::bench_setup::BenchSetup;
use super::signals::Signals;
use crate::data::ScriptsDirectory;
use crate::drive::{Setting, unit_config};
use crate::failure::{Asked, Failure, RunTrouble};
use crate::fleet;
use crate::link::Endpoint;
use crate::places::Places;

/// A unit and the bench around it, by name. Its JSON form is part of the window's settings file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct BenchChoice {
    /// `sim`, `serial:PATH[@BAUD]`, `tcp:HOST:PORT` or `lockstep:PATH`.
    pub endpoint: String,
    /// Connection of the bench harness.
    pub harness: Harness,
    /// Line, `lines/NAME.toml`.
    pub line: String,
    /// Unit configuration, `units/NAME.toml`.
    pub unit_config: String,
    /// Train, `trains/NAME.toml` or a file.
    pub train: String,
    /// Serial number given to the embedded unit or expected of a real one; empty = any.
    pub serial: String,
    /// Software version that the unit should have; none = any.
    #[serde(skip)]
    pub software: Option<[u8; 3]>,
    /// The train that the unit belongs to, as the depot names it; empty = not stated.
    pub train_no: String,
    /// Injected faults, by id; not saved, so that no later test starts with a forgotten one.
    #[serde(skip)]
    pub faults: Vec<String>,
    /// Seed of everything random.
    pub seed: u64,
    /// Whether units, trains and benches differ as good ones do.
    pub scatter: bool,
    /// Numbers or waveforms between bench and unit.
    #[serde(skip)]
    pub signals: Signals,
    /// Whether the embedded unit runs at the pace of the wall clock.
    pub realtime: bool,
    /// Changed keys of the unit configuration.
    #[serde(skip)]
    pub settings: Vec<Setting>,
    /// File of the scatter; none = `bench_scatter.toml` of the scripts directory.
    #[serde(skip)]
    pub scatter_file: Option<PathBuf>,
    /// How many times slower than the wall clock the bench runs.
    #[serde(skip)]
    pub slower: u32,
    /// Bench file, `benches/NAME.toml`; empty = everything is in the frames.
    #[serde(skip)]
    pub places: String,
}

impl Default for BenchChoice {
    fn default() -> Self {
        Self {
            endpoint: "sim".into(),
            harness: Harness::Auto,
            line: "line8".into(),
            unit_config: "sg100".into(),
            train: "line6".into(),
            serial: String::new(),
            software: None,
            train_no: String::new(),
            faults: Vec::new(),
            seed: 1,
            scatter: false,
            signals: Signals::Values,
            realtime: false,
            settings: Vec::new(),
            scatter_file: None,
            slower: 1,
            places: String::new(),
        }
    }
}

impl BenchChoice {
    /// Whether the unit is the embedded one.
    pub fn is_simulated(&self) -> bool {
        self.endpoint == "sim"
    }

    /// How the unit is reached, as far as is known before it is.
    pub fn connection(&self) -> Connection {
        match self.harness {
            Harness::None => Connection::Ptu,
            Harness::Auto | Harness::Bench => Connection::Btu,
        }
    }

    /// This choice without faults if the unit is on a port. The window offers faults for the embedded unit alone;
    /// faults chosen before a port was entered do not apply.
    pub fn with_offered_faults(mut self) -> Self {
        if !self.is_simulated() {
            self.faults.clear();
        }
        self
    }

    /// Whether procedures are evaluated from the same unit configuration, line and train.
    pub fn same_files(&self, other: &Self) -> bool {
        let names =
            |choice: &Self| [&choice.unit_config, &choice.line, &choice.train].map(Clone::clone);
        names(self) == names(other)
    }

    /// The bench file, if one is named: for a unit that goes by the clock.
    fn bench(
        &self,
        directory: &ScriptsDirectory,
        endpoint: &Endpoint,
    ) -> Result<Option<Arc<Places>>, Failure> {
        let by_the_clock = matches!(endpoint, Endpoint::Serial { .. } | Endpoint::Tcp(_));
        match self.places.as_str() {
            "" => Ok(None),
            name if self.slower == 1 && by_the_clock => {
                Ok(Some(Arc::new(directory.bench_places(name)?)))
            }
            _ => Err(Failure::usage(Asked::BenchByTheClock)),
        }
    }

    /// Reads and checks all named files.
    ///
    /// # Errors
    /// A name is wrong, a file is missing or wrong, or the files do not fit together.
    pub fn setup(&self, directory: &ScriptsDirectory) -> Result<BenchSetup, Failure> {
        let endpoint = Endpoint::from_str(&self.endpoint).map_err(Failure::usage)?;
        let faults = directory.chosen_faults(&self.faults)?;
        if endpoint != Endpoint::Sim && faults.iter().any(|fault| fault.place.in_unit()) {
            return Err(Failure::usage(RunTrouble::InjectElsewhere));
        }
        let by_numbers = self.signals == Signals::Values
            && self.harness != Harness::None
            && self.places.is_empty();
        check_bench_faults(&faults, by_numbers)?;
        let serial = Some(self.serial.clone()).filter(|serial| !serial.is_empty());
        if let Some(serial) = &serial {
            check_serial(serial)?;
        }
        if self.signals != Signals::Values && matches!(endpoint, Endpoint::Serial { .. }) {
            return Err(Failure::usage(RunTrouble::SampledOnSerial));
        }
        let places = self.bench(directory, &endpoint)?;
        let config = unit_config(directory, &self.unit_config, &self.settings)?;
        let line = directory.line(&self.line)?;
        let train = directory.train(&self.train)?;
        check_places(&faults, &train)
            .map_err(|wrong| Failure::usage(RunTrouble::Misplaced(wrong.to_string())))?;
        let scatter = match self.scatter {
            true => Some(Arc::new(
                directory.bench_scatter(self.scatter_file.as_deref())?,
            )),
            false => None,
        };
        let of_train = Some(self.train_no.trim().to_owned()).filter(|train| !train.is_empty());
        let records = match endpoint == Endpoint::Sim && of_train.is_none() {
            true => fleet::records_of_embedded(directory, config.crc, line.crc)?,
            false => fleet::unit_records(directory)?,
        };
        Ok(BenchSetup {
            harness: self.harness,
            config,
            line,
            train,
            faults,
            seed: self.seed,
            scatter,
            waveforms: self.signals.channel()?,
            expected: ExpectedIdentity {
                records,
                train: of_train,
                // The embedded unit is given its number.
                serial: serial.clone().filter(|_| endpoint != Endpoint::Sim),
                software: self.software,
            },
            endpoint,
            serial,
            realtime: self.realtime,
            slower: self.slower,
            record_whole: false,
            run_control: None,
            places,
        })
    }
}

/// Reads a software version, `MAJOR.MINOR.PATCH`.
///
/// # Errors
/// The text is not three numbers up to 255.
pub fn software_version(text: &str) -> Result<[u8; 3], RunTrouble> {
    let parts: Option<Vec<u8>> = text.split('.').map(|part| part.parse().ok()).collect();
    let version = parts.and_then(|parts| parts.try_into().ok());
    version.ok_or_else(|| RunTrouble::NoVersion(text.to_owned()))
}

/// Checks a serial number that was given.
///
/// # Errors
/// The number is empty, too long for the unit's identity, or not ASCII.
pub fn check_serial(serial: &str) -> Result<(), Failure> {
    let longest = size_of_val(&Identity::default().serial);
    if serial.is_empty() || serial.len() > longest || !serial.is_ascii() {
        return Err(Failure::usage(RunTrouble::SerialNumber(longest)));
    }
    Ok(())
}

/// Checks that faults of the simulated bench have numbers in frames between bench and unit to act on.
///
/// # Errors
/// A fault of the bench, and no such numbers.
pub fn check_bench_faults(faults: &[FaultMode], by_numbers: bool) -> Result<(), Failure> {
    match faults.iter().find(|fault| fault.place.on_bench()) {
        Some(fault) if !by_numbers => Err(Failure::usage(RunTrouble::BenchFault(fault.id.clone()))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saved_settings_may_leave_the_harness_out() {
        for (saved, harness) in [
            (r#"{"harness": "bench"}"#, Harness::Bench),
            ("{}", Harness::Auto),
        ] {
            let read: BenchChoice = serde_json::from_str(saved).expect("a choice");
            assert_eq!(read.harness, harness, "{saved}");
        }
    }

    #[test]
    fn a_saved_choice_leaves_out_faults_and_what_only_the_command_line_sets() {
        let choice = BenchChoice {
            endpoint: "tcp:bench:4000".into(),
            faults: vec!["tra.dead".into()],
            slower: 5,
            ..BenchChoice::default()
        };
        let saved = serde_json::to_value(&choice).expect("JSON");
        let mut keys: Vec<_> = saved.as_object().expect("an object").keys().collect();
        keys.sort();
        assert_eq!(
            keys,
            [
                "endpoint",
                "harness",
                "line",
                "realtime",
                "scatter",
                "seed",
                "serial",
                "train",
                "train_no",
                "unit_config"
            ]
        );
        let read: BenchChoice = serde_json::from_value(saved).expect("a choice");
        assert_eq!(
            read,
            BenchChoice {
                endpoint: "tcp:bench:4000".into(),
                ..BenchChoice::default()
            }
        );
    }
}
