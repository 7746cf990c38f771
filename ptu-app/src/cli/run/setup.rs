//! The bench of a run, made from the options of `ptu run`.

use std::sync::Arc;

use super::{RunArguments, UNIT_CONFIG};
use crate::cli::signal::sound::full_scale;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::{Asked, Failure};
use ptu_runs::link::Endpoint;
use ptu_runs::run::{BenchChoice, BenchSetup, check_serial};
use ptu_runs::sound::Direction;

impl RunArguments {
    pub(super) fn setup(&self, directory: &ScriptsDirectory) -> Result<BenchSetup, Failure> {
        let unit = self.unit.clone().unwrap_or(Endpoint::Sim);
        if unit != Endpoint::Sim && self.jobs > 1 {
            return Err(Failure::usage(Asked::JobsOnPort));
        }
        if self.slower > 1 && unit == Endpoint::Sim && !self.realtime {
            return Err(Failure::usage(Asked::SlowerWithoutClock));
        }
        if let Some(serial) = &self.serial_no {
            check_serial(serial)?;
        }
        let drives = !self.check && !self.list;
        let bench = self.bench.as_ref().filter(|_| drives);
        let mut setup = BenchChoice {
            endpoint: unit.to_string(),
            harness: self.harness,
            line: self.line().to_owned(),
            unit_config: (self.unit_config.as_deref().unwrap_or(UNIT_CONFIG)).to_owned(),
            train: self.train.clone(),
            settings: self.set.clone(),
            serial: self.serial_no.clone().unwrap_or_default(),
            software: self.software,
            train_no: self.train_no.clone(),
            faults: self.inject.clone(),
            seed: self.seed(),
            scatter: self.scattered.is_some(),
            scatter_file: self.scattered.clone().flatten(),
            signals: self.signals.clone(),
            realtime: self.realtime,
            slower: self.slower,
            places: bench.cloned().unwrap_or_default(),
        }
        .setup(directory)
        .and_then(calibrated)?;
        // Without a run the bench file is only read, for any unit, also the simulated one.
        if let Some(bench) = self.bench.as_ref().filter(|_| !drives) {
            setup.places = Some(Arc::new(directory.bench_places(bench)?));
        }
        Ok(setup)
    }
}

/// Sets the full scale of the bench's sound card to its calibration.
fn calibrated(mut setup: BenchSetup) -> Result<BenchSetup, Failure> {
    if let Some(places) = &mut setup.places
        && let Some((_, device)) = places.sound_card()
    {
        Arc::make_mut(places).full_scale_mv = full_scale(&device, Direction::Output)?;
    }
    Ok(setup)
}
