//! Runs the whole suite on one embedded unit in memory and keeps only what diagnosis reads.

use btu_rig::procedure::plan::Connection;
use btu_rig::procedure::{RunEvent, RunOptions, Verdict};
use btu_rig::rig::Harness;
use diagnosis::{CheckName, Dictionary, Observation};
use protocol::LruId;
use protocol::injection::FaultCatalogue;
use serde::{Deserialize, Serialize};

use super::samples::Sample;
use crate::data::ScriptsDirectory;
use crate::failure::Failure;
use crate::run::{
    BenchChoice, BenchSetup, ObservationBuilder, SessionEvent, Task, loading, run_here,
};
use crate::run_diagnosis::{LINE, TRAIN, UNIT_CONFIG};
use crate::stop::Stop;
use crate::structure::{OffWay, Structure};

/// All procedures of the default suite that a connection can run, and the bench they run on.
pub struct Suite {
    setup: BenchSetup,
    connection: Connection,
    tasks: Vec<Task>,
    /// Parts and fault modes.
    pub catalogue: FaultCatalogue,
    /// The parts that each signal comes through.
    pub structure: Structure,
}

/// A run of the suite.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SuiteRun {
    /// What was seen.
    pub seen: Observation,
    /// All procedures passed and no fault was found.
    pub passed: bool,
    /// What did not pass, for people.
    pub not_passed: Vec<String>,
}

impl Suite {
    /// Loads all procedures that are not on request and need nothing that the connection lacks.
    ///
    /// # Errors
    /// A file is missing or wrong.
    pub fn load(directory: &ScriptsDirectory, connection: Connection) -> Result<Self, Failure> {
        let choice = BenchChoice {
            unit_config: UNIT_CONFIG.into(),
            line: LINE.into(),
            train: TRAIN.into(),
            scatter: true,
            harness: match connection {
                Connection::Ptu => Harness::None,
                Connection::Btu => Harness::Bench,
            },
            ..BenchChoice::default()
        };
        let setup = choice.setup(directory)?;
        let texts = directory.procedures()?;
        let (config, line) = (&setup.config.content, &setup.line.content);
        let loaded = loading::load(&texts, config, line, &setup.train)?;
        if let Some(error) = loaded.errors.first() {
            return Err(Failure::usage(format!(
                "{error}; `ptu run --check` shows all errors"
            )));
        }
        let procedures = loaded
            .procedures
            .into_iter()
            .filter(|p| !p.on_request && p.needs.lacks(connection).is_none());
        let catalogue = directory.faults()?;
        Ok(Self {
            setup,
            connection,
            tasks: procedures
                .map(|procedure| Task {
                    procedure,
                    options: RunOptions::default(),
                })
                .collect(),
            structure: Structure::load(directory, &catalogue)?,
            catalogue,
        })
    }

    /// How it reaches the units.
    pub fn connection(&self) -> Connection {
        self.connection
    }

    /// What a dictionary of this suite has off the way of a fault's part, and the structure does not list.
    pub fn off_way(&self, dictionary: &Dictionary) -> Vec<OffWay> {
        let procedures: Vec<_> = self
            .tasks
            .iter()
            .map(|task| task.procedure.clone())
            .collect();
        let off_way = self.structure.off_way(&procedures, dictionary);
        self.structure.not_understood(off_way)
    }

    /// All checks in order, each with the part that its script suspects when it fails.
    pub fn checks(&self) -> Vec<(CheckName, Option<LruId>)> {
        let of_task = |task: &Task| {
            let procedure = task.procedure.clone();
            let named = procedure.steps.iter().flat_map(|step| {
                let names = match step.repeat {
                    1 => vec![step.name.clone()],
                    n => (1..=n)
                        .map(|turn| format!("{} ({turn}/{n})", step.name))
                        .collect(),
                };
                names.into_iter().map(|name| (name, step.suspect.clone()))
            });
            let named: Vec<_> = named.collect();
            named.into_iter().map(move |(step, suspect)| {
                let procedure = procedure.id.clone();
                (CheckName { procedure, step }, suspect)
            })
        };
        self.tasks.iter().flat_map(of_task).collect()
    }

    /// Runs it on units of one kind, each procedure on one that is powered up for it; none if it was stopped.
    pub fn run(&self, sample: &Sample, stop: &Stop) -> Option<SuiteRun> {
        let mut setup = BenchSetup {
            faults: sample.faults.clone(),
            seed: sample.seed,
            ..self.setup.clone()
        };
        let own_onset: Vec<_> = setup.faults.iter().map(|fault| fault.onset_s).collect();
        for fault in &mut setup.faults {
            fault.onset_s += sample.sets_in_s;
        }
        let mut run = SuiteRun {
            passed: true,
            ..SuiteRun::default()
        };
        for task in self.tasks.iter().take_while(|_| stop.may_begin()) {
            let mut observation = ObservationBuilder::new(&task.procedure.id);
            run_here(&setup, task, stop, &mut |event| {
                observation.take(&event);
                match event {
                    SessionEvent::Fault(fault) => {
                        run.passed = false;
                        run.not_passed
                            .push(format!("{}: {}", task.procedure.id, fault.message));
                    }
                    SessionEvent::Run(RunEvent::ProcedureFinished {
                        verdict, message, ..
                    }) if !matches!(verdict, Verdict::Passed | Verdict::Skipped) => {
                        run.passed = false;
                        run.not_passed
                            .push(format!("{}: {verdict} {message}", task.procedure.id));
                    }
                    _ => {}
                }
            });
            run.seen.steps.extend(observation.finish());
            for (fault, onset_s) in setup.faults.iter_mut().zip(&own_onset) {
                fault.onset_s = *onset_s;
            }
        }
        (stop.presses() == 0).then_some(run)
    }
}
