//! This computer, this process and others.

use std::path::PathBuf;
use std::process::Command;

use super::calls;

pub fn computer_name() -> String {
    let name = std::env::var_os("COMPUTERNAME").unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// The running program: its file cannot be replaced while it runs.
pub fn running_program() -> PathBuf {
    std::env::current_exe().unwrap_or_default()
}

/// Reading a console stops no process.
pub fn in_foreground() -> bool {
    true
}

/// Consoles of Windows 10 act on control sequences once that is switched on.
pub fn ready_output() {
    let _ = anstyle_query::windows::enable_ansi_colors();
}

/// A window that was opened from a link takes away the console that was made for it. One that was opened from a
/// console leaves it there.
pub fn leave_own_console() {
    calls::leave_own_console();
}

/// This process stays until the command ends, leaves the console that was made for it, and ends as the command does.
/// Returns only if the command cannot be started.
pub fn become_program(command: &mut Command) -> std::io::Error {
    match command.spawn() {
        Err(error) => error,
        Ok(mut child) => {
            leave_own_console();
            match child.wait() {
                Err(error) => error,
                Ok(status) => std::process::exit(status.code().unwrap_or(1)),
            }
        }
    }
}
