//! Options of commands that make many runs: the file that keeps the runs, and the shard of runs to make.

use std::path::PathBuf;

use clap::Args;

use super::print_out;
use ptu_runs::batch::{Keep, Shard};
use ptu_runs::failure::{Exit, Failure, KeepTrouble};
use ptu_runs::new_file::kind;
use ptu_runs::whole_file::check_writable;

/// Options for the file that keeps the runs, and for the shard to make.
#[derive(Debug, Args)]
pub struct KeepOptions {
    /// Keep the runs in a file; runs that the file already holds are not made again
    #[arg(long, value_name = "FILE")]
    runs: Option<PathBuf>,
    /// Make only the k-th of n parts of the runs and keep them with --runs; auto or auto/n takes the number of the task
    /// from Slurm or Kubernetes
    #[arg(long, value_name = "k/n", requires = "runs")]
    shard: Option<String>,
}

impl KeepOptions {
    /// Refuses --runs for a command that makes only one run, a wrong shard, and a file that cannot be written.
    pub fn check(&self, many: bool) -> Result<(), Failure> {
        if !many && self.runs.is_some() {
            return Err(Failure::usage(KeepTrouble::RunsOfMany));
        }
        self.keep()?;
        let check = |file| check_writable(file, kind::OWN);
        self.runs.as_deref().map_or(Ok(()), check)
    }

    /// The file that keeps the runs, and the shard to make, as the options say.
    pub fn keep(&self) -> Result<Keep, Failure> {
        let shard = self.shard.as_deref().map(str::parse::<Shard>).transpose();
        Ok(Keep {
            file: self.runs.clone(),
            shard: shard.map_err(|why| Failure::usage(KeepTrouble::Shard(why)))?,
        })
    }

    /// Whether only one shard of the runs is made, which gives no result of all runs.
    pub fn is_part(&self) -> bool {
        self.shard.is_some()
    }

    /// Prints that the runs of a shard are kept, and in which file.
    pub fn told(&self, runs: usize) -> Result<Exit, Failure> {
        let keep = self.keep()?;
        // `--shard` requires `--runs`, so there is a file.
        let (shard, file) = (keep.shard, keep.file);
        let shard = shard.map(|shard| shard.to_string()).unwrap_or_default();
        print_out(&format!(
            "shard {shard}: {runs} runs are in {}; `ptu campaign merge` puts the shards together",
            file.unwrap_or_default().display()
        ))
    }
}
