//! `ptu gui`, and `ptu` alone: start the technician's window, which is a program of its own.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

use ptu_runs::failure::{Asked, Failure, RunTrouble};
use ptu_runs::platform::become_program;

/// Replaces this process by the window's program, with the arguments after `gui`. Returns only if the window is not
/// installed or cannot be started.
pub fn start(arguments: impl Iterator<Item = OsString>) -> Failure {
    let window = window();
    if !window.is_file() {
        return Failure::bench(Asked::NoWindow(window.display().to_string()));
    }
    let error = become_program(Command::new(&window).args(arguments));
    Failure::bench(RunTrouble::NotStarted(
        window.display().to_string(),
        error.to_string(),
    ))
}

/// Path of the window's program, beside this program; the file is there only if the window is installed.
pub fn window() -> PathBuf {
    let here = std::env::current_exe().unwrap_or_default();
    here.with_file_name("ptu-window")
        .with_extension(std::env::consts::EXE_EXTENSION)
}
