//! Diagnoses a stored run.

use std::collections::BTreeMap;

use btu_rig::procedure::Finding;
use btu_rig::procedure::plan::Connection;
use diagnosis::{
    Assessment, Candidate, Cause, Conclusion, Diagnosis, Model, Observation, Relations,
};
use fault_db::{Id, RepairsOf, RunDetail, StepRecord, Store, Verdict};
use protocol::LruId;
use protocol::injection::Lru;

use super::cars::name_cars;
use super::confirmed::take_confirmed;
use super::dictionary::{Chosen, Origin, choose};
use super::history::OwnHistory;
use super::stored_run::{StoredRun, connection_of};
use super::{UNIT_CONFIG, settings};
use crate::clock::now_us;
use crate::data::ScriptsDirectory;
use crate::failure::{DiagnosisTrouble, Failure, Trouble, Unknown, did_you_mean};
use crate::replay::residuals;
use crate::run::Adaptive;
use crate::stop::Stop;
use crate::stored::findings;
use crate::structure::Structure;
use crate::symptoms::{self, Symptom};
use crate::words::Warning;

/// Configuration, line, train and connection, which decide what a healthy unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bench<'a> {
    pub unit_config_sha256: &'a str,
    pub line: &'a str,
    pub train: &'a str,
    /// How the unit is reached.
    pub connection: Connection,
    /// The unit is a simulated one, or faults are injected into it.
    pub practice: bool,
}

/// The diagnosis of a run.
pub struct Answer {
    pub run: RunDetail,
    pub diagnosis: Diagnosis,
    /// The likeliest fault of the part that was asked about, with what speaks for it and against it.
    pub why_not: Option<Candidate>,
    /// The part that was found, with the run's faults that come from it.
    pub cause: Option<(Cause, Vec<Id>)>,
    /// Traces that show a part's faults, by part.
    pub traces: BTreeMap<String, Vec<Id>>,
    /// What to bear in mind.
    pub warnings: Vec<Warning>,
    /// What people call the parts; empty where the catalogue cannot be read.
    pub names: Vec<Lru>,
    pub dictionary_from: Origin,
    /// The dictionary was made of what the scripts directory holds now.
    pub dictionary_current: bool,
}

/// What is asked of a stored run.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    pub run: Id,
    /// Runs of the same unit that are evidence, too: the fault is there in all of them.
    pub with: &'a [Id],
    /// A part of which to tell why it is not the answer.
    pub why_not: Option<&'a LruId>,
}

/// Diagnoses a stored run.
///
/// # Errors
/// There is no such run or dictionary, or a file cannot be read.
pub fn diagnose_run(
    store: &Store,
    directory: &ScriptsDirectory,
    id: Id,
) -> Result<Answer, Failure> {
    let question = Question {
        run: id,
        with: &[],
        why_not: None,
    };
    diagnose(store, directory, &question)
}

/// Answers a question about a stored run.
///
/// # Errors
/// There is no such run, part or dictionary, a run is of another unit, or a file cannot be read.
pub fn diagnose(
    store: &Store,
    directory: &ScriptsDirectory,
    asked: &Question<'_>,
) -> Result<Answer, Failure> {
    let Question {
        run: id,
        with,
        why_not,
    } = *asked;
    let mut runs = StoredRun::read_all(store, id, with)?;
    let settings = settings(directory)?;
    let (chosen, residuals) = dictionary_and_residuals(store, directory, &runs)?;
    let Chosen {
        mut dictionary,
        from,
        mut warnings,
        current,
    } = chosen;
    let mut seen = Observation::default();
    for (run, residuals) in runs.iter().zip(residuals) {
        let shown = run.evidence(residuals, &dictionary, &mut warnings);
        seen.steps.extend(shown.steps);
        seen.signs.extend(shown.signs);
        seen.residuals.extend(shown.residuals);
    }
    let StoredRun {
        run, occurrences, ..
    } = &runs[0];
    if seen.is_empty() {
        warnings.push(Warning::NothingToDiagnose);
    }
    let mut history = OwnHistory::before(run, occurrences, store, &settings)?;
    let of = RepairsOf {
        before_us: run.run.started_at_us,
        unit_type: &run.run.unit_config_name,
        practice: run.run.is_practice(),
    };
    take_confirmed((&mut history, &mut dictionary), store, of, &settings)?;
    let catalogue = directory.faults();
    let relations = match &catalogue {
        Ok(catalogue) => Structure::load(directory, catalogue).map(|structure| structure.relations),
        Err(_) => Ok(Relations::default()),
    };
    let relations = relations.unwrap_or_else(|failure| {
        let why = failure.to_string();
        warnings.push(Warning::NoRelations(why));
        Relations::default()
    });
    let mut names = catalogue.map(|all| all.lrus).unwrap_or_default();
    name_cars(&mut names, runs.iter().flat_map(|run| &run.occurrences));
    // A symptom that this directory's file no longer has says nothing.
    let said = run.run.symptom.as_deref();
    if let Some(symptom) = said.and_then(|id| symptoms::find(directory, &names, id).ok()) {
        history.add_symptom(&symptom, &settings);
    }
    let model = Model::new(&dictionary, &settings, &history.factors).with_relations(&relations);
    let assessed = Assessment::of(&model, &seen);
    let mut diagnosis = assessed.diagnosis();
    let cause = assessed.cause();
    let why_not = why_not.map(|part| {
        let fault = assessed.likeliest_of(part);
        fault.ok_or_else(|| no_such_part(part, &model))
    });
    history.explain(&mut diagnosis);
    let why_not = why_not.transpose()?;
    cannot_tell_unless_passed(run, &mut diagnosis);
    let mut traces: BTreeMap<String, Vec<Id>> = BTreeMap::new();
    for occurrence in occurrences {
        let of_part = traces.entry(occurrence.lru.clone()).or_default();
        of_part.extend(occurrence.trace_id.filter(|id| !of_part.contains(id)));
    }
    Ok(Answer {
        cause: cause.map(|cause| {
            let faults = runs[0].faults_of(&cause);
            (cause, faults)
        }),
        run: runs.swap_remove(0).run,
        diagnosis,
        why_not,
        traces,
        warnings,
        names,
        dictionary_from: from,
        dictionary_current: current,
    })
}

/// The dictionary for the first of `runs`, and of each run the signals that deviate first in its traces: repeating what was
/// recorded takes as long as reading the dictionary, so both are done at once.
fn dictionary_and_residuals(
    store: &Store,
    directory: &ScriptsDirectory,
    runs: &[StoredRun],
) -> Result<(Chosen, Vec<Vec<String>>), Failure> {
    let stop = Stop::default();
    let repeat = |run: &StoredRun| residuals(&run.traces, directory, &stop);
    let repeat_all = || runs.iter().map(repeat).collect();
    std::thread::scope(|scope| {
        let repeating = scope.spawn(repeat_all);
        let chosen = choose(Some(store), directory, connection_of(&runs[0].run));
        if chosen.is_err() {
            stop.press();
        }
        let repeated = repeating.join();
        let repeated = repeated.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        Ok((chosen?, repeated))
    })
}

fn no_such_part(part: &LruId, model: &Model<'_>) -> Failure {
    let known = model.parts().iter().map(|part| part.as_str());
    Failure::usage(Unknown::Part(
        part.to_string(),
        did_you_mean(part.as_str(), known),
    ))
}

/// A run that did not pass is not called healthy because its failed steps could not be weighed.
fn cannot_tell_unless_passed(run: &RunDetail, diagnosis: &mut Diagnosis) {
    let passed = matches!(
        run.run.verdict,
        Some(Verdict::Passed | Verdict::Skipped | Verdict::Inconclusive) | None
    );
    // A step that no fault dictionary counts tests something, too.
    let tested = |verdict: Verdict| matches!(verdict, Verdict::Passed | Verdict::Failed);
    let tested = run.steps.iter().any(|step| tested(step.verdict));
    let nothing_wrong = match diagnosis.conclusion {
        Conclusion::NoFault { .. } => true,
        Conclusion::NothingSeen { made, .. } => {
            made > 0 || tested || run.run.verdict == Some(Verdict::Aborted)
        }
        _ => false,
    };
    let nothing_made = matches!(diagnosis.conclusion, Conclusion::NothingSeen { .. });
    if let Some(bench) = failed_bench(run).filter(|_| nothing_wrong || nothing_made) {
        diagnosis.conclusion = Conclusion::BenchFailed { bench };
    } else if !passed && !run.steps.is_empty() && nothing_wrong {
        diagnosis.conclusion = match (run.run.verdict, &diagnosis.next_check) {
            (Some(Verdict::Aborted), Some(_)) => Conclusion::BrokenOff,
            _ => Conclusion::NotWeighed,
        };
    }
}

/// Name of the bench one of whose instruments ended the run.
fn failed_bench(run: &RunDetail) -> Option<String> {
    let named = |finding: &Finding| match finding {
        Finding::LinkLostAt {
            instrument: Some(_),
            bench,
            ..
        } => bench.clone(),
        _ => None,
    };
    let of = |step: &StepRecord| {
        findings(&step.findings)
            .iter()
            .find_map(|found| named(&found.finding))
    };
    run.steps.iter().find_map(of)
}

/// What an adaptive run on the unit called `serial`, which was brought with this symptom, decides by.
///
/// # Errors
/// There is no dictionary, or one of another bench or other scripts only.
pub fn adaptive(
    store: &Store,
    directory: &ScriptsDirectory,
    (serial, symptom): (&str, Option<&Symptom>),
    bench: &Bench<'_>,
) -> Result<Adaptive, Failure> {
    let chosen = choose(Some(store), directory, bench.connection)?;
    if !chosen.current {
        // A step that was changed since would mislead the run at every turn.
        let stale = chosen.warnings.into_iter().map(Trouble::from);
        return Err(Failure::usage(Trouble::All(stale.collect())));
    }
    let basis = &chosen.dictionary.basis;
    let made_on = Bench {
        unit_config_sha256: &basis.unit_config_sha256,
        line: &basis.line,
        train: &basis.train,
        ..*bench
    };
    if *bench != made_on {
        return Err(Failure::usage(DiagnosisTrouble::OtherBench(
            UNIT_CONFIG,
            basis.line.clone(),
            basis.train.clone(),
        )));
    }
    let settings = settings(directory)?;
    let mut history = OwnHistory::up_to_now(serial, store, &settings)?;
    let mut dictionary = chosen.dictionary;
    let of = RepairsOf {
        before_us: now_us(),
        unit_type: UNIT_CONFIG,
        practice: bench.practice,
    };
    take_confirmed((&mut history, &mut dictionary), store, of, &settings)?;
    if let Some(symptom) = symptom {
        history.add_symptom(symptom, &settings);
    }
    Ok(Adaptive {
        dictionary,
        settings,
        lru_factors: history.factors,
        warnings: chosen.warnings,
    })
}
