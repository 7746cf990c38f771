//! Runs the whole suite on one embedded unit in memory and keeps only what diagnosis reads.

use btu_rig::procedure::plan::Connection;
use btu_rig::procedure::{RunEvent, Verdict};
use btu_rig::rig::Harness;
use diagnosis::{CheckName, Dictionary, Model, Observation};
use protocol::LruId;
use protocol::injection::FaultCatalogue;
use serde::{Deserialize, Serialize};

use super::samples::Sample;
use crate::data::ScriptsDirectory;
use crate::failure::{Failure, RunTrouble};
use crate::replay::first_deviation;
use crate::run::{
    BenchChoice, BenchSetup, ObservationBuilder, SessionEvent, TO_THE_END, Task, isolate, loading,
    run_on_fresh,
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

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SuiteRun {
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
            return Err(Failure::usage(RunTrouble::Script(error.to_string())));
        }
        let procedures = loaded
            .procedures
            .into_iter()
            .filter(|p| !p.on_request && p.needs.lacks(connection).is_none());
        let catalogue = directory.faults()?;
        Ok(Self {
            setup,
            connection,
            tasks: procedures.map(Task::from).collect(),
            structure: Structure::load(directory, &catalogue)?,
            catalogue,
        })
    }

    /// How the suite reaches the units.
    pub fn connection(&self) -> Connection {
        self.connection
    }

    /// Steps that fail in this suite's dictionary off the way of the fault's part, and that the structure does not
    /// list.
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
            let steps = procedure.steps.iter();
            let named: Vec<_> = steps
                .map(|step| (step.name.clone(), step.suspect.clone()))
                .collect();
            named.into_iter().map(move |(step, suspect)| {
                let procedure = procedure.id.clone();
                (CheckName { procedure, step }, suspect)
            })
        };
        self.tasks.iter().flat_map(of_task).collect()
    }

    /// Runs the suite on the unit of a sample, which is powered up anew for each procedure; `None` if it was stopped.
    pub fn run(&self, sample: &Sample, stop: &Stop) -> Option<SuiteRun> {
        let mut unit = UnitUnderTest::new(self, sample, stop);
        for task in self.tasks.iter().take_while(|_| stop.may_begin()) {
            unit.perform(task, &mut |_| {}, &TO_THE_END);
        }
        (stop.presses() == 0).then_some(unit.run)
    }

    /// Tests a unit in an adaptive run by this model; also the bench time that the run took, s. `None` if it was
    /// stopped.
    pub fn run_adaptively(
        &self,
        sample: &Sample,
        model: &Model<'_>,
        stop: &Stop,
    ) -> Option<(SuiteRun, f64)> {
        let mut unit = UnitUnderTest::new(self, sample, stop);
        let time_s = isolate(model, &self.tasks, &mut |task, saw, go_on| {
            unit.perform(task, saw, go_on);
            stop.may_begin()
        });
        (stop.presses() == 0).then_some((unit.run, time_s))
    }
}

/// A unit with its faults, tested one procedure after the other, and the results.
struct UnitUnderTest<'a> {
    setup: BenchSetup,
    /// When each fault sets in at the next power-up, s.
    own_onset_s: Vec<f64>,
    stop: &'a Stop,
    run: SuiteRun,
}

impl<'a> UnitUnderTest<'a> {
    fn new(suite: &Suite, sample: &Sample, stop: &'a Stop) -> Self {
        let mut setup = BenchSetup {
            faults: sample.faults.clone(),
            seed: sample.seed,
            ..suite.setup.clone()
        };
        let own_onset_s = setup.faults.iter().map(|fault| fault.onset_s).collect();
        for fault in &mut setup.faults {
            fault.onset_s += sample.sets_in_s;
        }
        let run = SuiteRun {
            passed: true,
            ..SuiteRun::default()
        };
        Self {
            setup,
            own_onset_s,
            stop,
            run,
        }
    }

    /// Powers the unit up and runs a procedure.
    fn perform(
        &mut self,
        task: &Task,
        saw: &mut dyn FnMut(&SessionEvent),
        go_on: &dyn Fn() -> bool,
    ) {
        let Self {
            setup, stop, run, ..
        } = self;
        let procedure = &task.procedure.id;
        let mut observation = ObservationBuilder::new(procedure);
        let (mut first_trace, mut recorded) = (None, None);
        let mut sink = |event| {
            observation.take(&event);
            saw(&event);
            let wrong = match event {
                SessionEvent::Trace(cut) => {
                    first_trace.get_or_insert(cut);
                    return;
                }
                SessionEvent::Recording(stimuli) => {
                    recorded = Some(stimuli);
                    return;
                }
                SessionEvent::Fault(fault) => fault.finding.to_string(),
                SessionEvent::Run(RunEvent::ProcedureFinished {
                    verdict, findings, ..
                }) if !matches!(verdict, Verdict::Passed | Verdict::Skipped) => {
                    format!("{verdict} {findings}")
                }
                _ => return,
            };
            run.passed = false;
            run.not_passed.push(format!("{procedure}: {wrong}"));
        };
        run_on_fresh(setup, task, stop, &mut sink, go_on);
        run.seen.steps.extend(observation.finish());
        if let (Some(cut), Some(stimuli)) = (first_trace, recorded) {
            let first = first_deviation(setup, procedure, (&cut, &stimuli), stop);
            run.seen.residuals.extend(first);
        }
        for (fault, onset_s) in self.setup.faults.iter_mut().zip(&self.own_onset_s) {
            fault.onset_s = *onset_s;
        }
    }
}
