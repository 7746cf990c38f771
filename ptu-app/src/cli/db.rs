//! `ptu db`: care of the database file.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use fault_db::{MergeCounts, PruneRule, SqlValue};

use super::{Database, print_json, print_out, since_argument};
use crate::clock;
use crate::failure::{Exit, Failure};
use crate::table::Table;

/// Rows a query prints at most.
const MAX_ROWS: usize = 10_000;

/// Check, back up, prune, merge or query the database
#[derive(Debug, Args)]
pub struct DbArguments {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    database: Database,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Look for damage
    Check {
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    /// Copy the database while it is in use
    Backup {
        /// The new file
        to: PathBuf,
    },
    /// Add everything of another database that is not here yet
    Import {
        /// The other file
        from: PathBuf,
    },
    /// Add everything that is here to another database
    Export {
        /// The other file, made if need be
        to: PathBuf,
    },
    /// Delete old traces that no open fault needs; runs and faults stay
    Prune {
        /// Older than: 90d, 2026-03, 2026-03-21
        #[arg(long, value_name = "TIME", value_parser = since_argument)]
        older_than: i64,
        /// Count only
        #[arg(long)]
        dry_run: bool,
    },
    /// Ask the database in SQL, reading only
    Query {
        /// The question
        #[arg(value_name = "SELECT …")]
        sql: String,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
}

impl DbArguments {
    /// Does it.
    pub fn run(self) -> Result<Exit, Failure> {
        match self.verb {
            Verb::Check { json } => self.database.check(json),
            Verb::Backup { to } => {
                self.database.open_read_only()?.backup(&to)?;
                print_out(&format!("copied to {}", to.display()))
            }
            Verb::Import { from } => {
                let counts = self.database.open()?.import(&from)?;
                print_out(&merged(&counts))
            }
            Verb::Export { to } => {
                let store = self.database.open_read_only()?;
                print_out(&merged(&store.export(&to, clock::open_options())?))
            }
            Verb::Prune {
                older_than,
                dry_run,
            } => {
                let rule = PruneRule {
                    older_than_us: older_than,
                    dry_run,
                };
                let counts = self.database.open()?.prune(&rule)?;
                print_out(&format!(
                    "{} traces ({} bytes){}, {} kept for faults that are not closed, file {} bytes smaller",
                    counts.traces,
                    counts.trace_bytes,
                    if dry_run { " would go" } else { " deleted" },
                    counts.kept_for_faults,
                    counts.freed_bytes
                ))
            }
            Verb::Query { sql, json } => self.database.query(&sql, json),
        }
    }
}

impl Database {
    fn check(&self, json: bool) -> Result<Exit, Failure> {
        let report = self.open_read_only()?.check()?;
        if json {
            print_json(&report)?;
        } else if report.problems.is_empty() {
            print_out(&format!("no damage; {} traces read", report.traces))?;
        } else {
            let mut table = Table::new(&["KIND", "WHAT"]);
            for problem in &report.problems {
                table.row([problem.kind.into(), problem.detail.clone()]);
            }
            print_out(&table.render())?;
        }
        Ok(if report.problems.is_empty() {
            Exit::Passed
        } else {
            Exit::Bench
        })
    }

    fn query(&self, sql: &str, json: bool) -> Result<Exit, Failure> {
        let answer = self.open_read_only()?.query_read_only(sql, MAX_ROWS)?;
        if json {
            return print_json(&answer);
        }
        let headings: Vec<_> = answer.columns.iter().map(String::as_str).collect();
        let mut table = Table::new(&headings);
        for row in &answer.rows {
            table.row(row.iter().map(|value| match value {
                SqlValue::Null => String::new(),
                SqlValue::Integer(number) => number.to_string(),
                SqlValue::Real(number) => number.to_string(),
                SqlValue::Text(text) => text.clone(),
            }));
        }
        let more = if answer.truncated {
            "\n… more rows; add LIMIT"
        } else {
            ""
        };
        print_out(&format!("{}{more}", table.render()))
    }
}

fn merged(counts: &MergeCounts) -> String {
    format!(
        "added {} runs, {} steps, {} faults, {} occurrences, {} traces",
        counts.runs, counts.steps, counts.faults, counts.occurrences, counts.traces
    )
}
