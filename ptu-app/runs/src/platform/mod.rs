//! Functions that differ by operating system, under one name for all: the terminal, requests to stop, serial ports,
//! processes, their limits and pipes, and who may read a file. The rest of the program knows no operating system.

#[cfg(unix)]
mod unix;
#[cfg(windows)]
mod windows;

#[cfg(unix)]
use unix as system;
#[cfg(windows)]
use windows as system;

pub use system::files::{identity, readable_by_others};
pub use system::ports::{closed_to_user, is_probed_by_others};
pub use system::process::{
    become_program, computer_name, leave_own_console, ready_output, running_program,
};
pub use system::signals::survive_file_limit;

/// This process, for people.
pub(crate) fn this_process() -> String {
    format!("{}:{}", computer_name(), std::process::id())
}

pub(crate) use system::files::{keep_to_owner, make_folder, real_path, same_file};
pub(crate) use system::limits::{ended_by_time, limit_memory, limit_time, without_window};
pub(crate) use system::pipes::shorten_pipe;
pub(crate) use system::ports::{holder, open_alone};
pub(crate) use system::process::in_foreground;
pub(crate) use system::signals::StopSignals;
