//! `ptu`: the maintenance test unit for on-board ATC units, from the command line.

#[path = "../../scripts/embedded.rs"]
mod embedded;

use std::process::ExitCode;

use ptu_app::cli::Cli;
use ptu_report::words::tell;
use ptu_runs::platform::{ready_output, survive_file_limit};

fn main() -> ExitCode {
    script_files::embed(embedded::FILES);
    survive_file_limit();
    ready_output();
    match Cli::asked().and_then(Cli::run) {
        Ok(exit) => ExitCode::from(exit.code()),
        Err(failure) => {
            tell(&failure);
            ExitCode::from(failure.exit.code())
        }
    }
}
