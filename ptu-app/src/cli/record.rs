//! `ptu record`: a unit's own record of automatic runs.

mod compare;
mod pull;

use clap::{Args, Subcommand};

use super::Database;
use ptu_runs::failure::{Exit, Failure};

/// Read a unit's own record of automatic runs, and compare a run with a sound unit's
#[derive(Debug, Args)]
pub struct RecordArguments {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    database: Database,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Pull(pull::PullArguments),
    Compare(compare::CompareArguments),
}

impl RecordArguments {
    /// Pulls or compares.
    pub fn run(self) -> Result<Exit, Failure> {
        match self.verb {
            // What is pulled is a run, and runs are recorded in a file.
            Verb::Pull(arguments) => {
                self.database.check_named()?;
                arguments.run(self.database.open_file()?)
            }
            Verb::Compare(arguments) => arguments.run(&self.database.open_read_only()?),
        }
    }
}
