//! `ptu diagnose`: what the results say.

use std::path::PathBuf;

use clap::Args;

use super::diagnose_matrix::{MatrixOptions, diagnose_matrix};
use crate::failure::{Exit, Failure};

/// Find what is at fault, and the next best test
///
/// Examples:
///   ptu diagnose --matrix pump.json                            cheapest order of tests
///   ptu diagnose --matrix pump.json --outcomes flow=1,noise=0  what these outcomes leave
///   ptu diagnose --matrix pump.json --outcomes found.json --json
///
/// Exit codes: 0 answered, 2 wrong matrix or outcomes.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct DiagnoseArguments {
    /// Dependency matrix of states and tests; its format is in scripts/README.md
    #[arg(long, value_name = "FILE")]
    matrix: PathBuf,
    #[command(flatten)]
    matrix_options: MatrixOptions,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl DiagnoseArguments {
    /// Does it.
    pub fn run(self) -> Result<Exit, Failure> {
        diagnose_matrix(&self.matrix, &self.matrix_options, self.json)
    }
}
