//! `ptu campaign`: the suite against every fault mode.

mod merge;
mod missing;

use std::path::PathBuf;

use btu_rig::procedure::plan::Connection;
use btu_rig::rig::Harness;
use clap::{Args, Subcommand};
use fault_db::DictionaryRecord;
use glob::Pattern;

use super::keep::KeepOptions;
use super::{Database, Json, ScriptsOption};
use ptu_report::campaign::{campaign_json, campaign_text};
use ptu_runs::campaign::{self, Ran, Request, Suite, figures, redundancy};
use ptu_runs::clock;
use ptu_runs::failure::{Exit, Failure, FileTrouble, Why};
use ptu_runs::new_file::kind;
use ptu_runs::pool::cores;
use ptu_runs::progress::Progress;
use ptu_runs::run_diagnosis::settings;
use ptu_runs::stdio;
use ptu_runs::stop::Stop;

/// Make a fault dictionary: run the suite against every fault mode, and say what the dictionary is worth
///
/// Every fault mode is run at all its levels, with different times of onset, on units that differ as good units do
/// (bench_scatter.toml). Runs with other seeds then assess the dictionary: detection, isolation, false alarms.
///
/// Examples:
///   ptu campaign                             all fault modes, 5 seeds each
///   ptu campaign --faults 'eb_relay.*' --seeds 2
///   ptu campaign --held-out 2 --good 1000    the figures of docs/figures.md
///   ptu campaign --harness none              what a laptop alone on a train can find
///   ptu campaign --leave-out-modes 5         what the dictionary is worth for faults that it does not know
///   ptu campaign --pairs 100                 what the dictionary is worth for two faults at once
///   ptu campaign --common-causes 100         what the dictionary is worth for one cause at several parts
///   ptu campaign --runs runs.zst             goes on where a stopped campaign ended
///   ptu campaign --shard 3/64 --runs shard-3.zst
///   ptu campaign merge shard-*.zst --out runs.zst
#[derive(Debug, Args)]
#[command(verbatim_doc_comment, args_conflicts_with_subcommands = true)]
pub struct CampaignArguments {
    #[command(subcommand)]
    verb: Option<Verb>,
    /// With `none`, as a laptop alone on a train: only procedures that need no bench harness
    #[arg(long, value_name = "WHICH", default_value = "bench")]
    harness: Harness,
    /// Only fault modes whose name matches; the dictionary then knows no other modes
    #[arg(long, value_name = "GLOB")]
    faults: Option<Pattern>,
    /// Seeds of each level of a mode, for the dictionary
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,
    /// Seeds of each level of a mode for runs that assess the dictionary and are not part of it
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(0..=1000))]
    held_out: u32,
    /// Good units to assess the dictionary with, for false alarms
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    good: u32,
    /// Diagnose each mode also by a dictionary without every K-th mode of each part, and by one without the mode's part
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(2..=20))]
    leave_out_modes: Option<u32>,
    /// Units with two random faults of different parts, to assess the dictionary with
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=10_000))]
    pairs: u32,
    /// Units with one cause at several parts that share it, such as their supply, to assess the dictionary with
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=10_000))]
    common_causes: u32,
    /// Lot of units: each number gives other simulated units, all with other seeds
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1000))]
    lot: u32,
    #[command(flatten)]
    keep: KeepOptions,
    /// Simulated units to test side by side [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    jobs: Option<u32>,
    /// Write the dictionary to a file, too
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    database: Database,
    #[command(flatten)]
    scripts: ScriptsOption,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Merge(merge::MergeArguments),
    Missing(missing::MissingArguments),
}

impl CampaignArguments {
    /// Makes and assesses a dictionary, merges shards, or lists the shards that lack runs.
    pub fn run(mut self) -> Result<Exit, Failure> {
        match self.verb.take() {
            None => self.run_suite(),
            Some(Verb::Merge(arguments)) => arguments.run(),
            Some(Verb::Missing(arguments)) => arguments.run(),
        }
    }

    fn run_suite(self) -> Result<Exit, Failure> {
        self.keep.check(true)?;
        let directory = self.scripts.find()?;
        let connection = match self.harness {
            Harness::None => Connection::Ptu,
            Harness::Auto | Harness::Bench => Connection::Btu,
        };
        let suite = Suite::load(&directory, connection)?;
        let settings = settings(&directory)?;
        let asked = Request {
            faults: self.faults.clone(),
            seeds: self.seeds,
            held_out: self.held_out,
            good: self.good,
            leave_out: self.leave_out_modes,
            pairs: self.pairs,
            common: self.common_causes,
            units: self.lot,
            keep: self.keep.keep()?,
            jobs: self.jobs.map_or_else(cores, |jobs| jobs as usize),
        };
        let modes = campaign::chosen(&suite, &asked)?;
        let count = campaign::samples(&modes, &suite.structure.relations.shared, &asked).len();
        let count = asked.keep.ours(count).count();
        if let Some(file) = &self.out {
            ptu_runs::whole_file::check_writable(file, kind::DICTIONARY)?;
        }
        // A shard makes no dictionary: nodes of a cluster need no database.
        let store = match self.keep.is_part() {
            true => None,
            false => {
                self.database.check_named()?;
                Some(self.database.open_file()?)
            }
        };
        let stop = Stop::default();
        stop.listen();
        let mut progress = Progress::new(count, format!("{} fault modes", modes.len()));
        let ran = campaign::run(&directory, &suite, &asked, &settings, &stop, &mut |done| {
            progress.tell(done);
        })?;
        drop(progress);
        let outcome = match (ran, store) {
            (Ran::All(outcome), Some(store)) => (outcome, store),
            (Ran::Part(runs), _) => return self.keep.told(runs),
            (Ran::All(_), None) | (Ran::Stopped, _) => {
                stdio::note("stopped; no dictionary was made");
                return Ok(Exit::Aborted);
            }
        };
        let (outcome, store) = outcome;
        let dictionary = &outcome.dictionary;
        let data = dictionary.to_bytes().map_err(|why| {
            Failure::bench(FileTrouble::NotPrinted(
                "the fault dictionary",
                Why::Said(why),
            ))
        })?;
        if let Some(file) = &self.out {
            ptu_runs::whole_file::write(file, kind::DICTIONARY, &data)?;
        }
        store.put_dictionary(&DictionaryRecord {
            made_at_us: clock::now_us(),
            app_version: dictionary.basis.app_version.clone(),
            basis_sha256: dictionary.basis.sha256.clone(),
            modes: dictionary.modes.len(),
            data,
        })?;
        let figures = figures(&outcome.assessments, &outcome.good);
        let redundancy = redundancy(&outcome.dictionary);
        store.close()?;
        let text = || campaign_text(&outcome, &figures, &redundancy);
        self.json
            .answer(|| campaign_json(&outcome, &figures, &redundancy), text)
    }
}
