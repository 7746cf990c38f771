//! Content of a bench, kept with its stimuli: enough to make the same bench again, without injected
//! faults.

use std::sync::Arc;

use btu_rig::bench_scatter::BenchScatter;
use btu_rig::procedure::plan::Connection;
use btu_rig::recorded::StimulusRecord;
use btu_rig::rig::{ExpectedIdentity, Harness};
use btu_rig::train::TrainData;
use btu_rig::waveform::ChannelConfig;
use fault_db::{Recording, RecordingRecord};
use protocol::Instant;
use serde::{Deserialize, Serialize};

use super::bench_setup::BenchSetup;
use super::event::RecordedStimuli;
use crate::data::{DataFile, ScriptsDirectory, sha256};
use crate::drive::{Setting, unit_config};
use crate::failure::{Exit, Failure, RecordTrouble};
use crate::fleet;
use crate::link::Endpoint;

/// A data file a bench was made of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BenchFile {
    pub name: String,
    /// Changes to the file by `--set`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub settings: Vec<String>,
    /// SHA-256 of the file with its changes, in hex; of a train, of the train's content.
    pub sha256: String,
}

impl BenchFile {
    fn of<T>(file: &DataFile<T>) -> Self {
        Self {
            name: file.name.clone(),
            settings: file.settings.clone(),
            sha256: file.sha256.clone(),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BenchContents {
    /// Where the unit was: `sim`, `serial:…`, `tcp:…`.
    pub source: String,
    /// Serial number of the unit.
    pub serial: String,
    pub unit_config: BenchFile,
    /// Track database.
    pub line: BenchFile,
    /// Train around the unit.
    pub train: BenchFile,
    /// Seed of the run; the seed of a procedure follows from it and the procedure's name.
    pub seed: u64,
    /// Scatter of units, trains and benches.
    pub scatter: Option<BenchScatter>,
    /// Disturbances of the waveforms that were used in place of numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub waveforms: Option<ChannelConfig>,
    /// The bench file that said where stimuli go and readings come from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub places: Option<BenchFile>,
    /// The bench runs at the wall clock's pace.
    pub realtime: bool,
    /// Only the maintenance port was connected: the train did all else by itself.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub on_train: bool,
}

/// Stimuli of a bench, as they are kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stimuli {
    /// When the procedure began, µs on the bench's clock: 0 where the unit was powered up for it.
    pub began_us: u64,
    #[serde(rename = "tape")]
    pub record: StimulusRecord,
}

impl BenchContents {
    /// Content of the benches that `setup` makes for a unit of this serial number and connection.
    pub fn of(setup: &BenchSetup, serial: String, connection: Connection) -> Self {
        Self {
            source: setup.endpoint.to_string(),
            serial,
            unit_config: BenchFile::of(&setup.config),
            line: BenchFile::of(&setup.line),
            train: BenchFile {
                name: setup.train.name().to_owned(),
                settings: Vec::new(),
                sha256: train_sha256(&setup.train),
            },
            seed: setup.seed,
            scatter: setup.scatter.as_deref().copied(),
            waveforms: setup.waveforms.clone(),
            places: setup.places.as_ref().map(|places| BenchFile {
                name: places.name.clone(),
                settings: Vec::new(),
                sha256: places.sha256.clone(),
            }),
            realtime: setup.realtime,
            on_train: connection == Connection::Ptu,
        }
    }

    /// Recording of a procedure's stimuli on such a bench; its place in the run is left open.
    pub fn recording(&self, procedure: &str, recorded: &RecordedStimuli) -> RecordingRecord {
        let stimuli = Stimuli {
            began_us: recorded.began.since(Instant::ZERO).as_us(),
            record: recorded.record.clone(),
        };
        // Structs of numbers and texts always have a JSON form.
        let json = |written: serde_json::Result<String>| written.unwrap_or_default();
        RecordingRecord {
            ordinal: 0,
            procedure: procedure.to_owned(),
            t0_bench_us: 0,
            bench_json: json(serde_json::to_string(self)),
            stimuli_json: json(serde_json::to_string(&stimuli)),
        }
    }

    /// Reads a recording back.
    ///
    /// # Errors
    /// The recording is of another version, or has lost stimuli.
    pub fn read(recording: &Recording) -> Result<(Self, Stimuli), Failure> {
        let other = |error: serde_json::Error| {
            Failure::bench(RecordTrouble::OtherVersion(
                recording.procedure.clone(),
                error.to_string(),
            ))
        };
        let made = serde_json::from_str(&recording.bench_json).map_err(other)?;
        let stimuli: Stimuli = serde_json::from_str(&recording.stimuli_json).map_err(other)?;
        if stimuli.record.lost > 0 {
            return Err(Failure::bench(RecordTrouble::NotWhole(
                recording.procedure.clone(),
                stimuli.record.lost,
            )));
        }
        Ok((made, stimuli))
    }

    /// A bench of this content with the embedded unit, without fault, in virtual time.
    ///
    /// # Errors
    /// A data file is no longer there, or differs from the recorded one.
    pub fn setup(&self, directory: &ScriptsDirectory) -> Result<BenchSetup, Failure> {
        let settings: Vec<Setting> = self
            .unit_config
            .settings
            .iter()
            .map(|text| text.parse().map_err(Failure::usage))
            .collect::<Result<_, _>>()?;
        let config = gone(
            "unit configuration",
            &self.unit_config,
            unit_config(directory, &self.unit_config.name, &settings),
        )?;
        let line = gone("line", &self.line, directory.line(&self.line.name))?;
        let train = gone("train", &self.train, directory.train(&self.train.name))?;
        for (what, made, found) in [
            ("unit configuration", &self.unit_config, &config.sha256),
            ("line", &self.line, &line.sha256),
            ("train", &self.train, &train_sha256(&train)),
        ] {
            same(what, made, found)?;
        }
        let expected = ExpectedIdentity {
            records: fleet::records_of_embedded(directory, config.crc, line.crc)?,
            ..ExpectedIdentity::default()
        };
        Ok(BenchSetup {
            endpoint: Endpoint::Sim,
            harness: match self.connection() {
                Connection::Ptu => Harness::None,
                Connection::Btu => Harness::Bench,
            },
            config,
            line,
            train,
            faults: Vec::new(),
            seed: self.seed,
            scatter: self.scatter.map(Arc::new),
            waveforms: self.waveforms.clone(),
            serial: Some(self.serial.clone()),
            expected,
            realtime: false,
            slower: 1,
            record_whole: false,
            run_control: None,
            places: None,
        })
    }

    pub fn connection(&self) -> Connection {
        match self.on_train {
            true => Connection::Ptu,
            false => Connection::Btu,
        }
    }

    /// The unit was on a port: its clock is not the bench's, and what it had been through before is not
    /// in the recording.
    pub fn on_port(&self) -> bool {
        self.source != Endpoint::Sim.to_string()
    }
}

fn gone<T>(what: &'static str, made: &BenchFile, found: Result<T, Failure>) -> Result<T, Failure> {
    found.map_err(|why| Failure {
        exit: Exit::Usage,
        ..why.because_of(RecordTrouble::Gone(what, made.name.clone()))
    })
}

fn same(what: &'static str, made: &BenchFile, found: &str) -> Result<(), Failure> {
    if made.sha256 == found {
        return Ok(());
    }
    Err(Failure::usage(RecordTrouble::Changed(
        what,
        made.name.clone(),
        beginning(&made.sha256).to_owned(),
        beginning(found).to_owned(),
    )))
}

/// Enough of a hash to tell two apart.
fn beginning(sha256: &str) -> &str {
    sha256.get(..12).unwrap_or(sha256)
}

/// SHA-256 over all that a train is, in hex; trains from files and built-in ones alike.
pub(super) fn train_sha256(train: &TrainData) -> String {
    sha256(&format!("{train:?}"))
}
