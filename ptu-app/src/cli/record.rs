//! `ptu record`: a unit's own record of automatic runs.

mod compare;
mod pull;

use clap::{Args, Subcommand};

use super::Database;
use ptu_runs::failure::{Exit, Failure};

/// Read a unit's own record of automatic runs, and compare such a run with a sound unit's run
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
    pub fn run(self) -> Result<Exit, Failure> {
        match self.verb {
            // What is pulled is stored as a run, and runs are recorded in a file, not on a server.
            Verb::Pull(arguments) => {
                self.database.check_named()?;
                arguments.run(self.database.open_file()?)
            }
            Verb::Compare(arguments) => arguments.run(&self.database.open_read_only()?),
        }
    }
}
