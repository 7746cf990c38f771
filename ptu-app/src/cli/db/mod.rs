//! `ptu db`: care of the database.

mod check;
mod maintenance;
mod query;
mod server;
mod sync;
mod watch;

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{Database, Json, print_out};
use ptu_runs::failure::{Exit, Failure};

/// Check, back up, prune, merge, sync or query the database
#[derive(Debug, Args)]
pub struct DbArguments {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    database: Database,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Look for damage and for what was changed by hand, in a file or on a server; writes nothing
    Check {
        #[command(flatten)]
        json: Json,
    },
    /// Compute derived counts and search words again from the other rows
    Rebuild,
    /// Copy the database while it is in use
    Backup {
        /// The new file
        to: PathBuf,
    },
    /// Add everything of another database that this database does not have
    ///
    /// A run that has ended in both files is not changed. If its two copies differ, the run is named, and the exit code
    /// is 3. A run that does not fit its seal, and a row with impossible content, are named and left out, with the same
    /// exit code; the rest is added.
    Import {
        /// The other file
        from: PathBuf,
        #[command(flatten)]
        json: Json,
    },
    /// Add everything of this database to another database, or write it as Parquet files
    ///
    /// A run that has ended in both files is not changed. If its two copies differ, the run is named, and the exit code
    /// is 3. With --parquet the views of `ptu db schema` are written for DuckDB, Polars and Spark, a file for each
    /// month; the file of a month that has not changed is left as it is.
    Export {
        /// The other file, made if need be
        #[arg(required_unless_present = "parquet", conflicts_with = "parquet")]
        to: Option<PathBuf>,
        /// Folder for Parquet files, made if need be
        #[arg(long, value_name = "DIR")]
        parquet: Option<PathBuf>,
        #[command(flatten)]
        json: Json,
    },
    /// Delete old traces that no open fault needs; runs and faults stay
    Prune(maintenance::PruneArguments),
    Sync(sync::SyncArguments),
    /// Look after a server for many laptops
    Server(server::ServerArguments),
    Query(query::QueryArguments),
    /// Print the views and columns that `ptu db query` can ask about
    Schema,
}

impl DbArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        match self.verb {
            Verb::Check { json } => check::check(&self.database, json),
            Verb::Rebuild => maintenance::rebuild(&self.database),
            Verb::Backup { to } => maintenance::backup(&self.database, &to),
            Verb::Import { from, json } => maintenance::import(&self.database, &from, json),
            Verb::Export { to, parquet, json } => match (to, parquet) {
                (Some(to), _) => maintenance::export(&self.database, &to, json),
                (None, folder) => {
                    maintenance::export_parquet(&self.database, &folder.unwrap_or_default(), json)
                }
            },
            Verb::Prune(arguments) => maintenance::prune(&self.database, &arguments),
            Verb::Sync(arguments) => arguments.run(&self.database),
            Verb::Server(arguments) => arguments.run(),
            Verb::Query(arguments) => arguments.query(&self.database),
            Verb::Schema => print_out(fault_db::VIEWS_PAGE.trim_end()),
        }
    }
}
