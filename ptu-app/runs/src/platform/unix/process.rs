//! This computer, this process and others.

use std::io::{IsTerminal as _, stdin};
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use rustix::process::getpgrp;
use rustix::termios::tcgetpgrp;

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

/// Whether reading standard input would not stop this process: it is no terminal, or this process is in front of it.
pub fn in_foreground() -> bool {
    !stdin().is_terminal() || tcgetpgrp(stdin()).is_ok_and(|group| group == getpgrp())
}

/// Terminals need nothing before control sequences.
pub fn ready_output() {}

/// No program has a terminal made for it.
pub fn leave_own_console() {}

/// This process becomes the command's. Returns only if the command cannot be started.
pub fn become_program(command: &mut Command) -> std::io::Error {
    command.exec()
}
