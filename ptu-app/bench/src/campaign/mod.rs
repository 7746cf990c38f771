//! Campaigns: the suite against every fault mode, for the fault dictionary, and against fault modes and
//! good units with other seeds, for what the dictionary is worth.
//!
//! ```text
//! catalogue → samples (mode, level, onset, seed) → suite runs → dictionary
//!                       held-out samples → suite runs → diagnosis → figures
//! ```

mod evaluate;
mod redundant;
mod samples;
mod suite;
#[cfg(test)]
mod tests;

use diagnosis::{Basis, Dictionary, ModeName, Settings};
use glob::Pattern;
use protocol::injection::FaultMode;

pub use evaluate::{Assessment, Figures, Share, Shortfall, figures};
pub use redundant::{Redundancy, redundancy};
pub use samples::{Purpose, Sample, samples};
pub use suite::{Suite, SuiteRun};

use crate::data::ScriptsDirectory;
use crate::failure::{Failure, did_you_mean};
use crate::pool;
use crate::run_diagnosis::basis;
use crate::stop::Stop;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct Request {
    /// Fault modes, by glob.
    pub faults: Option<Pattern>,
    /// Seeds of each level of a mode, for the dictionary.
    pub seeds: u32,
    /// Seeds of each level of a mode, to assess it.
    pub held_out: u32,
    /// Runs of good units to assess it.
    pub good: u32,
    /// Embedded units to test side by side.
    pub jobs: usize,
}

/// The result of a campaign.
pub struct Outcome {
    /// The dictionary.
    pub dictionary: Dictionary,
    /// Held-out runs with a fault, each with its diagnosis.
    pub assessments: Vec<Assessment>,
    /// Good runs, and what did not pass in those that did not.
    pub good: Vec<Vec<String>>,
    /// Suite runs made.
    pub runs: usize,
}

/// Fault modes that are asked for.
///
/// # Errors
/// There are none.
pub fn chosen<'a>(suite: &'a Suite, asked: &Request) -> Result<Vec<&'a FaultMode>, Failure> {
    let all = &suite.catalogue.faults;
    let Some(pattern) = &asked.faults else {
        return Ok(all.iter().collect());
    };
    let chosen: Vec<_> = all
        .iter()
        .filter(|mode| pattern.matches(&mode.id))
        .collect();
    if chosen.is_empty() {
        let known = all.iter().map(|mode| mode.id.as_str());
        return Err(Failure::usage(format!(
            "no fault mode matches \"{pattern}\"{}; `ptu catalog faults` lists them",
            did_you_mean(pattern.as_str(), known)
        )));
    }
    Ok(chosen)
}

/// Runs the campaign; `tell` hears how many of all runs are done. A stop gives none.
///
/// # Errors
/// Scripts or data files are wrong.
pub fn run(
    directory: &ScriptsDirectory,
    suite: &Suite,
    asked: &Request,
    settings: &Settings,
    stop: &Stop,
    tell: &mut dyn FnMut(usize),
) -> Result<Option<Outcome>, Failure> {
    let modes = chosen(suite, asked)?;
    let samples = samples(&modes, asked);
    let run_one = |i: usize| suite.run(&samples[i], stop);
    let runs = pool::run(samples.len(), asked.jobs, stop, tell, run_one);
    if stop.presses() > 0 || runs.len() < samples.len() {
        return Ok(None);
    }
    let runs: Vec<SuiteRun> = runs.into_iter().map(|(_, run)| run).collect();
    let made_of = basis(directory, suite.connection())?;
    let outcome = conclude(
        made_of, suite, &modes, settings, &samples, &runs, asked.jobs,
    );
    Ok(Some(outcome))
}

/// Makes the dictionary of the runs that are for it, and assesses it by the others.
pub fn conclude(
    made_of: Basis,
    suite: &Suite,
    modes: &[&FaultMode],
    settings: &Settings,
    samples: &[Sample],
    runs: &[SuiteRun],
    jobs: usize,
) -> Outcome {
    let dictionary = dictionary(made_of, suite, modes, samples, runs);
    let (assessments, good) = evaluate::assess(&dictionary, settings, samples, runs, jobs);
    Outcome {
        dictionary,
        assessments,
        good,
        runs: samples.len(),
    }
}

fn dictionary(
    made_of: Basis,
    suite: &Suite,
    modes: &[&FaultMode],
    samples: &[Sample],
    runs: &[SuiteRun],
) -> Dictionary {
    let seeds = samples.iter().filter(|s| s.purpose == Purpose::Dictionary);
    let seeds: std::collections::BTreeSet<_> = seeds.map(|s| s.seed).collect();
    let mut dictionary = Dictionary::new(made_of, seeds.into_iter().collect(), suite.checks());
    let of = |mode: Option<&str>, level: usize| {
        let chosen = samples.iter().zip(runs).filter(|(sample, _)| {
            sample.purpose == Purpose::Dictionary && sample.mode() == mode && sample.level == level
        });
        chosen.map(|(_, run)| run.seen.clone()).collect::<Vec<_>>()
    };
    dictionary.set_healthy(&of(None, 0));
    for mode in modes {
        let name = ModeName {
            id: mode.id.clone(),
            lru: mode.lru.clone(),
            text: mode.mode.clone(),
            kind: mode.kind().word().to_owned(),
            unsafe_: mode.unsafe_,
            weight: mode.weight,
        };
        for level in 0..=mode.levels.len() {
            let label = match level.checked_sub(1) {
                None => "nominal".to_owned(),
                Some(listed) => mode.levels[listed].to_string(),
            };
            dictionary.add(&name, label, &of(Some(&mode.id), level));
        }
    }
    dictionary
}
