//! Serves an on-board ATC unit on a pseudo-terminal, a serial port or a TCP socket, in real time.

#[path = "../../scripts/embedded.rs"]
mod embedded;
mod program;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    script_files::embed(embedded::FILES);
    let arguments = program::Arguments::parse();
    match program::serve(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            program::note(&format!("ato-under-test: {error}"));
            ExitCode::from(if error.is::<program::UsageError>() {
                2
            } else {
                3
            })
        }
    }
}
