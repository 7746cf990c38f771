//! This computer, this process and others.

use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use rustix::process::{Pid, test_kill_process};

/// What this computer is called.
pub fn computer_name() -> String {
    let about = rustix::system::uname();
    about.nodename().to_string_lossy().into_owned()
}

/// The running program, on Linux also where its file was replaced since.
pub fn running_program() -> PathBuf {
    let running = Path::new("/proc/self/exe");
    match running.exists() {
        true => running.to_owned(),
        false => std::env::current_exe().unwrap_or_default(),
    }
}

/// Field 22 of `/proc/PID/stat`: ticks from boot to the process's start. Nothing where a system does not tell it of a
/// process that runs.
pub fn start_of(process: u32) -> Option<String> {
    if !Path::new("/proc/self/stat").exists() {
        let process = Pid::from_raw(i32::try_from(process).ok()?)?;
        return test_kill_process(process).is_ok().then(String::new);
    }
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    let after_name = stat.rsplit_once(')')?.1;
    after_name.split_whitespace().nth(19).map(str::to_owned)
}

/// Terminals need nothing before control sequences.
pub fn ready_output() {}

/// No program has a terminal made for it.
pub fn leave_own_console() {}

/// This process becomes the command's. Returns only if the command cannot be started.
pub fn become_program(command: &mut Command) -> std::io::Error {
    command.exec()
}
