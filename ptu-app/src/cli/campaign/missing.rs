//! `ptu campaign missing`: lists the shards that have to be run again.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::super::{Json, answered};
use ptu_runs::batch::{Missing, missing};
use ptu_runs::failure::{Exit, Failure};

/// List the shards that lack runs, of a campaign or of `ptu drive --monte-carlo`
///
/// Exit codes: 0 no run is missing, 1 some are missing.
///
/// Examples:
///   ptu campaign missing shard-*.zst
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct MissingArguments {
    /// Files of runs
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Number of shards [default: the number in the files]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    shards: Option<u32>,
    #[command(flatten)]
    json: Json,
}

impl MissingArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        let missing = missing(&self.files, self.shards)?;
        let told = self.json.answer(|| &missing, || text(&missing));
        let exit = if missing.missing == 0 {
            Exit::Passed
        } else {
            Exit::Failed
        };
        answered(told, exit)
    }
}

fn text(missing: &Missing) -> String {
    let mut text = format!("{}\n", missing.what);
    for damage in &missing.damage {
        let _ = writeln!(text, "{damage}");
    }
    for shard in &missing.of_shards {
        let _ = writeln!(
            text,
            "shard {}/{}: {} of {} runs are missing",
            shard.shard, missing.shards, shard.missing, shard.runs
        );
    }
    let _ = writeln!(
        text,
        "{} of {} runs are missing",
        missing.missing, missing.runs
    );
    if missing.missing > 0 {
        let numbers: Vec<_> = (missing.of_shards.iter())
            .map(|one| one.shard.to_string())
            .collect();
        let _ = writeln!(
            text,
            "give the command once more for these shards; in a Slurm array with `--shard auto/{}`: --array={}",
            missing.shards,
            numbers.join(",")
        );
    }
    text.trim_end().to_owned()
}
