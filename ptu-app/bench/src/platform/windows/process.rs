//! This computer, this process and others.

use std::path::PathBuf;

use super::calls;

/// What this computer is called.
pub fn computer_name() -> String {
    let name = std::env::var_os("COMPUTERNAME").unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// The running program: its file cannot be replaced while it runs.
pub fn running_program() -> PathBuf {
    std::env::current_exe().unwrap_or_default()
}

/// When a process that runs was started.
pub fn start_of(process: u32) -> Option<String> {
    calls::started_at(process).map(|ticks| ticks.to_string())
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
