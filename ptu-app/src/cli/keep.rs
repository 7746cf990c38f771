//! Options of commands that make many runs: where they are kept, and which are made here.

use std::path::PathBuf;

use clap::Args;
use fault_db::Address;

use super::print_out;
use ptu_runs::data::check_writable;
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::kept::{Keep, QueueAt, Shard};
use ptu_runs::new_file::kind;

/// Where runs are kept, and which are made here.
#[derive(Debug, Args)]
pub struct KeepOptions {
    /// Keep the runs in a file; those that it holds are not made again
    #[arg(long, value_name = "FILE")]
    runs: Option<PathBuf>,
    /// Make only the k-th of n parts of the runs and keep them with --runs; auto or auto/n takes the number of the task
    /// from Slurm or Kubernetes
    #[arg(long, value_name = "k/n", requires = "runs")]
    shard: Option<String>,
    /// Take the runs from a queue on a PostgreSQL server, beside any number of workers that are given the same command;
    /// with --runs the runs of all of them are kept, and the result is made
    #[arg(long, value_name = "ADDRESS", conflicts_with = "shard")]
    queue: Option<Address>,
    /// Time after which a run that a worker took and did not bring is given to another, s
    #[arg(long, value_name = "SECONDS", default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    lease: u32,
}

impl KeepOptions {
    /// Refuses what does not go together: only `many` runs are kept.
    pub fn check(&self, many: bool) -> Result<(), Failure> {
        if !many && (self.runs.is_some() || self.queue.is_some()) {
            return Err(Failure::usage("--runs and --queue go with --monte-carlo"));
        }
        self.keep()?;
        let check = |file| check_writable(file, kind::OWN);
        self.runs.as_deref().map_or(Ok(()), check)
    }

    /// What was asked for.
    pub fn keep(&self) -> Result<Keep, Failure> {
        let shard = self.shard.as_deref().map(str::parse::<Shard>).transpose();
        Ok(Keep {
            file: self.runs.clone(),
            shard: shard.map_err(|why| Failure::usage(format!("--shard: {why}")))?,
            queue: self.queue.clone().map(|address| QueueAt {
                address,
                lease_s: self.lease,
            }),
        })
    }

    /// Whether only a part of the runs is made, and no result of all.
    pub fn is_part(&self) -> bool {
        self.shard.is_some() || (self.queue.is_some() && self.runs.is_none())
    }

    /// Says that the runs of a shard are kept, or that a queue is empty.
    pub fn told(&self, runs: usize) -> Result<Exit, Failure> {
        let keep = self.keep()?;
        let (Some(shard), Some(file)) = (keep.shard, keep.file) else {
            return print_out(&format!(
                "all runs of the queue are there, {runs} of them from here; the same command with --runs FILE gives the \
                 result"
            ));
        };
        print_out(&format!(
            "shard {shard}: {runs} runs are in {}; `ptu campaign merge` puts the shards together",
            file.display()
        ))
    }
}
