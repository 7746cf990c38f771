//! `ptu campaign merge`: the runs of shards in one file.

use std::path::PathBuf;

use clap::Args;

use super::super::print_out;
use ptu_runs::batch::merge;
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::new_file::kind;
use ptu_runs::stdio;
use ptu_runs::whole_file::write;

/// Merge the runs of the shards of a campaign, or of `ptu drive --monte-carlo`
///
/// The order of the files makes no difference, nor does a file that is named twice: the result is, byte for byte, the
/// file of one process that made all runs. Then give the shards' command without --shard and with --runs FILE: it
/// prints the result of all runs.
///
/// Examples:
///   ptu campaign merge shard-*.zst --out runs.zst
///   ptu campaign --runs runs.zst
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct MergeArguments {
    /// Files of runs
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// File to write; it may be one of the files to merge
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

impl MergeArguments {
    /// Merges the files, and says how many runs there are and are missing.
    pub fn run(self) -> Result<Exit, Failure> {
        let merged = merge(&self.files)?;
        write(&self.out, kind::RUNS, &merged.bytes)?;
        if merged.runs < merged.all {
            stdio::note(&format!(
                "{} of {} runs are missing; `ptu campaign missing {}` lists their shards",
                merged.all - merged.runs,
                merged.all,
                self.out.display()
            ));
        }
        print_out(&format!(
            "{} of {} runs are in {}",
            merged.runs,
            merged.all,
            self.out.display()
        ))
    }
}
