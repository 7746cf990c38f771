//! A stored run as evidence: what it showed, held against a dictionary.

use std::collections::BTreeMap;

use btu_rig::procedure::plan::Connection;
use diagnosis::{Cause, CheckName, Dictionary, Observation, Sign};
use fault_db::{Id, RunDetail, RunOccurrence, Store};
use protocol::lru::from_stored;

use crate::failure::{DiagnosisTrouble, Failure};
use crate::replay::{Original, first_traces};
use crate::run::{CHECK_FAILED, of_run};
use crate::stored::DEPARTURE;
use crate::words::Warning;

/// A stored run with its faults and the traces that can be repeated.
pub(super) struct StoredRun {
    pub run: RunDetail,
    pub occurrences: Vec<RunOccurrence>,
    pub traces: Vec<Original>,
}

impl StoredRun {
    /// The run that is asked about, then those of the same unit that are evidence, too.
    ///
    /// # Errors
    /// There is no such run, or one is no evidence about the same unit.
    pub fn read_all(store: &Store, asked: Id, with: &[Id]) -> Result<Vec<Self>, Failure> {
        let mut runs = vec![Self::read(store, store.run(asked)?)?];
        for id in with {
            let other = store.run(*id)?;
            runs[0].same_unit(&other)?;
            runs.push(Self::read(store, other)?);
        }
        Ok(runs)
    }

    fn read(store: &Store, run: RunDetail) -> Result<Self, Failure> {
        let occurrences = store.run_occurrences(run.run.id)?;
        Ok(Self {
            traces: first_traces(store, &occurrences),
            run,
            occurrences,
        })
    }

    /// Refuses another run that is no evidence about the same unit.
    ///
    /// # Errors
    /// It is of another unit, or this very run.
    fn same_unit(&self, other: &RunDetail) -> Result<(), Failure> {
        let (this, that) = (&self.run.run, &other.run);
        if this.id == that.id {
            return Err(Failure::usage(DiagnosisTrouble::RunTwice(that.id)));
        }
        if this.unit_serial != that.unit_serial
            || this.unit_config_sha256 != that.unit_config_sha256
        {
            return Err(Failure::usage(DiagnosisTrouble::OtherUnit(
                that.id,
                that.unit_serial.clone(),
                that.unit_config_name.clone(),
                this.unit_serial.clone(),
                this.unit_config_name.clone(),
            )));
        }
        Ok(())
    }

    /// What the run showed, with the signals that deviate first in its traces, as far as it can be compared with a
    /// dictionary: without departure tests, steps of scripts that have changed since, and steps that the dictionary
    /// does not know. Warns of what is left out, and of a run on another bench. The train is known where there is a
    /// trace.
    pub fn evidence(
        &self,
        residuals: Vec<String>,
        dictionary: &Dictionary,
        warnings: &mut Vec<Warning>,
    ) -> Observation {
        let run = &self.run;
        let mut seen = Observation {
            residuals,
            ..of_run(run, &self.occurrences)
        };
        let basis = &dictionary.basis;
        if run.run.unit_config_sha256 != basis.unit_config_sha256 {
            let name = run.run.unit_config_name.clone();
            warnings.push(Warning::OtherConfiguration(name));
        }
        if !run.steps.is_empty() && run.run.line != basis.line {
            warnings.push(Warning::OtherLine(run.run.line.clone(), basis.line.clone()));
        }
        let train = self.traces.first().map(|trace| &trace.made.train.name);
        if let Some(train) = train.filter(|train| **train != basis.train) {
            warnings.push(Warning::OtherTrain(train.clone(), basis.train.clone()));
        }
        let others = run.scripts.iter().filter(|script| {
            let name = script.path.trim_end_matches(".star");
            let sum = basis.procedures.get(name);
            sum.is_some_and(|sum| *sum != script.sha256)
        });
        let others: Vec<_> = others
            .map(|script| script.path.trim_end_matches(".star").to_owned())
            .collect();
        if !others.is_empty() {
            let scripts = others.join(", ");
            warnings.push(Warning::OtherScripts(scripts));
            seen.steps
                .retain(|step| !others.contains(&step.check.procedure));
        }
        let (departure, others): (Vec<_>, Vec<_>) = (std::mem::take(&mut seen.steps).into_iter())
            .partition(|step| step.check.procedure.starts_with(DEPARTURE));
        seen.steps = others;
        if !departure.is_empty() {
            warnings.push(Warning::Departure);
        }
        let before = seen.steps.len();
        seen.steps
            .retain(|step| dictionary.place(&step.check).is_some());
        let steps = before - seen.steps.len();
        if steps > 0 {
            warnings.push(Warning::UnknownSteps(steps));
        }
        seen
    }

    /// Faults of the run that come from a cause: those that name its part, and those of which the cause explains all that the
    /// run saw.
    pub fn faults_of(&self, cause: &Cause) -> Vec<Id> {
        let mut seen: BTreeMap<Id, Vec<&RunOccurrence>> = BTreeMap::new();
        for occurrence in &self.occurrences {
            seen.entry(occurrence.fault).or_default().push(occurrence);
        }
        let is_of = |seen: &[&RunOccurrence]| {
            let lru = seen.first().and_then(|one| from_stored(&one.lru));
            lru.as_ref() == Some(&cause.lru)
                || seen.iter().all(|one| explains(cause, &self.run, one))
        };
        let faults = seen.iter().filter(|(_, seen)| is_of(seen));
        faults.map(|(fault, _)| *fault).collect()
    }
}

/// A stored run, and what it showed as far as that can be compared with a dictionary; its traces are left aside.
///
/// # Errors
/// There is no such run, or the database cannot be read.
pub(super) fn observed(
    store: &Store,
    run: Id,
    dictionary: &Dictionary,
) -> Result<(RunDetail, Observation), Failure> {
    let run = StoredRun {
        run: store.run(run)?,
        occurrences: store.run_occurrences(run)?,
        traces: Vec::new(),
    };
    let seen = run.evidence(Vec::new(), dictionary, &mut Vec::new());
    Ok((run.run, seen))
}

/// How the unit of a run was reached; where no tester led it, it counts as on a bench.
pub(super) fn connection_of(run: &RunDetail) -> Connection {
    let said = run.run.connection.as_deref();
    match said == Some(Connection::Ptu.word()) {
        true => Connection::Ptu,
        false => Connection::Btu,
    }
}

/// Whether a cause explains an occurrence: a failed check by the step, any other fault by its sign.
fn explains(cause: &Cause, run: &RunDetail, seen: &RunOccurrence) -> bool {
    if seen.code != i64::from(CHECK_FAILED) {
        let sign = Sign {
            fault: seen.code_name.clone(),
            lru: from_stored(&seen.lru),
        };
        return cause.signs.contains(&sign);
    }
    let step = run
        .steps
        .iter()
        .find(|step| Some(step.index) == seen.step_index);
    step.is_some_and(|step| {
        cause.checks.contains(&CheckName {
            procedure: step.procedure.clone(),
            step: step.name.clone(),
        })
    })
}
