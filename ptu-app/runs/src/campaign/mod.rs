//! Campaigns: the suite against every fault mode, for the fault dictionary, and against fault modes and good units with
//! other seeds, to assess the dictionary.
//!
//! ```text
//! catalogue → samples (modes, level, onset, seed) → suite runs → dictionary
//!                       held-out samples → suite runs → diagnosis → figures
//! ```

mod adaptive;
mod baselines;
mod by_mode;
mod evaluate;
mod left_out;
mod pairs;
mod redundant;
mod samples;
mod suite;
#[cfg(test)]
mod tests;

use btu_rig::procedure::plan::Connection;
use diagnosis::{Basis, Dictionary, ModeName, Settings};
use glob::Pattern;
use protocol::injection::{FaultCatalogue, FaultMode};

pub use adaptive::{AdaptiveFigures, Effort};
pub use baselines::Baseline;
pub use evaluate::{Assessment, Figures, Share, Shortfall, figures};
use left_out::Evidence;
pub use left_out::{LeftOut, OtherFaults, UnseenFigures};
pub use pairs::PairFigures;
pub use redundant::{Redundancy, redundancy};
pub use samples::{Purpose, Sample, samples};
pub use suite::{Suite, SuiteRun};

use crate::batch::{self, BatchResult, Head, Keep, Plan};
use crate::data::ScriptsDirectory;
use crate::failure::{Failure, Unknown, did_you_mean};
use crate::run_diagnosis::basis;
use crate::stop::Stop;
use crate::structure::OffWay;

#[derive(Clone, Debug)]
pub struct Request {
    /// Fault modes, by glob.
    pub faults: Option<Pattern>,
    /// Seeds of each level of a mode, for the dictionary.
    pub seeds: u32,
    /// Seeds of each level of a mode, to assess the dictionary.
    pub held_out: u32,
    /// Runs of good units to assess the dictionary.
    pub good: u32,
    /// One in so many modes of each part is left out of the dictionary at a time, to see whether the others find its
    /// part.
    pub leave_out: Option<u32>,
    /// Runs of units with two faults to assess the dictionary.
    pub pairs: u32,
    /// Runs of units with one cause at several parts to assess the dictionary.
    pub common: u32,
    /// Which units: another number means other seeds for everything.
    pub units: u32,
    /// Simulated units to test side by side.
    pub jobs: usize,
    /// Where the runs are kept, and which of them are made here.
    pub keep: Keep,
}

impl Request {
    /// The runs that are asked for, for people.
    fn what(&self, connection: Connection) -> String {
        let alone = match connection {
            Connection::Ptu => " --harness none",
            Connection::Btu => "",
        };
        let mut what = format!(
            "ptu campaign{alone} --seeds {} --held-out {} --good {} --lot {}",
            self.seeds, self.held_out, self.good, self.units
        );
        if let Some(faults) = &self.faults {
            what += &format!(" --faults '{faults}'");
        }
        for (option, count) in [("--pairs", self.pairs), ("--common-causes", self.common)] {
            if count > 0 {
                what += &format!(" {option} {count}");
            }
        }
        what
    }
}

/// The result of a campaign.
pub struct Outcome {
    pub dictionary: Dictionary,
    /// Held-out runs with a fault, each with its diagnosis.
    pub assessments: Vec<Assessment>,
    /// Figures of adaptive runs on the units of `assessments`; `None` where there are no such units.
    pub adaptive: Option<AdaptiveFigures>,
    /// How well the dictionary tells two faults at once, if that was asked for.
    pub pairs: Option<PairFigures>,
    /// How well the dictionary tells one cause at several parts, if that was asked for.
    pub common: Option<OtherFaults>,
    /// For each held-out run of a good unit, what did not pass.
    pub good: Vec<Vec<String>>,
    /// How well the dictionary tells faults that it does not know, if that was asked for.
    pub left_out: Option<LeftOut>,
    /// Steps that a mode fails though its part is not on their way.
    pub off_way: Vec<OffWay>,
    /// Suite runs made.
    pub runs: usize,
}

/// The fault modes in a dictionary for units on this connection: a laptop alone has no bench that could be at fault.
pub fn known_on(
    catalogue: &FaultCatalogue,
    connection: Connection,
) -> impl Iterator<Item = &FaultMode> {
    let modes = catalogue.faults.iter();
    modes.filter(move |mode| connection == Connection::Btu || !mode.place.on_bench())
}

/// Fault modes that are asked for.
///
/// # Errors
/// No fault mode matches.
pub fn chosen<'a>(suite: &'a Suite, asked: &Request) -> Result<Vec<&'a FaultMode>, Failure> {
    let all = || known_on(&suite.catalogue, suite.connection());
    let Some(pattern) = &asked.faults else {
        return Ok(all().collect());
    };
    let chosen: Vec<_> = all().filter(|mode| pattern.matches(&mode.id)).collect();
    if chosen.is_empty() {
        let known = all().map(|mode| mode.id.as_str());
        return Err(Failure::usage(Unknown::FaultGlob(
            pattern.to_string(),
            did_you_mean(pattern.as_str(), known),
        )));
    }
    Ok(chosen)
}

/// How a campaign ended.
pub enum Ran {
    All(Box<Outcome>),
    /// The runs of one shard are kept, so many; a dictionary is made of the runs of all shards.
    Part(usize),
    Stopped,
}

/// Runs the campaign; `tell` hears how many of its runs are done.
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
) -> Result<Ran, Failure> {
    let modes = chosen(suite, asked)?;
    let samples = samples(&modes, &suite.structure.relations.shared, asked);
    let basis = basis(directory, suite.connection())?;
    let plan = Plan {
        what: asked.what(suite.connection()),
        names: samples.iter().map(Sample::name).collect(),
        seeds: None,
    };
    let head = Head::new(&basis.sha256, plan);
    let made = batch::make(&asked.keep, head, (asked.jobs, stop), tell, |i| {
        suite.run(&samples[i], stop)
    })?;
    let runs = match made {
        BatchResult::All(runs) => runs,
        BatchResult::Part(runs) => return Ok(Ran::Part(runs)),
        BatchResult::Stopped(_) => return Ok(Ran::Stopped),
    };
    let evidence = Evidence {
        basis: &basis,
        suite,
        modes: &modes,
        settings,
        samples: &samples,
        runs: &runs,
        jobs: asked.jobs,
    };
    Ok(Ran::All(Box::new(conclude(&evidence, asked.leave_out))))
}

/// Makes the dictionary of the runs that are for it, and assesses it by the others.
fn conclude(evidence: &Evidence<'_>, leave_out: Option<u32>) -> Outcome {
    let Evidence {
        basis,
        suite,
        modes,
        settings,
        samples,
        runs,
        jobs,
    } = *evidence;
    let dictionary = dictionary(basis.clone(), suite, modes, samples, runs);
    let judged_by = (settings, &suite.structure.relations);
    let held_out = samples.iter().zip(runs);
    let of = |purpose: Purpose, faults: usize| -> Vec<_> {
        let is_of =
            |(sample, _): &(&Sample, _)| sample.purpose == purpose && sample.faults.len() == faults;
        held_out.clone().filter(is_of).collect()
    };
    let single = of(Purpose::Assessment, 1);
    let pairs = of(Purpose::Assessment, 2);
    let common: Vec<_> = held_out
        .clone()
        .filter(|(sample, _)| sample.purpose == Purpose::CommonCause)
        .collect();
    Outcome {
        adaptive: (!single.is_empty()).then(|| {
            let units: Vec<_> = single.iter().map(|(sample, _)| *sample).collect();
            AdaptiveFigures::of(&dictionary, judged_by, suite, &units, jobs)
        }),
        assessments: evaluate::assess(&dictionary, judged_by, &single, jobs),
        pairs: (!pairs.is_empty()).then(|| PairFigures::of(&dictionary, judged_by, &pairs)),
        common: (!common.is_empty())
            .then(|| OtherFaults::of(&evaluate::assess(&dictionary, judged_by, &common, jobs))),
        good: evaluate::not_passed(&of(Purpose::Assessment, 0)),
        left_out: leave_out.map(|folds| LeftOut::of(evidence, folds.max(2) as usize)),
        off_way: suite.off_way(&dictionary),
        dictionary,
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
    let (checks, suspects) = suite.checks().into_iter().unzip();
    let mut dictionary = Dictionary::new(made_of, seeds.into_iter().collect(), checks);
    dictionary.suspects = suspects;
    let lrus = suite.catalogue.lrus.iter();
    dictionary.parts = lrus
        .filter(|part| suite.connection() == Connection::Btu || !part.of_bench)
        .map(|part| part.id.clone())
        .collect();
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
        mode.next_levels()
            .into_iter()
            .for_each(|two| dictionary.add_between(&mode.id, two));
    }
    dictionary
}
