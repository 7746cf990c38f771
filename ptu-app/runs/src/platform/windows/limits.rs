//! Hard limits of this process, by a job that it joins and cannot leave; and whether a process ran into them.

use std::io::Result;
use std::os::windows::process::CommandExt as _;
use std::process::{Command, ExitStatus};

use windows_sys::Win32::Foundation::ERROR_NOT_ENOUGH_QUOTA;
use windows_sys::Win32::System::Threading::CREATE_NO_WINDOW;

use super::calls::{JobLimit, join_job};

/// This process gets no more memory than so many bytes.
pub fn limit_memory(bytes: u64) -> Result<()> {
    join_job(JobLimit::Memory(
        usize::try_from(bytes).unwrap_or(usize::MAX),
    ))
}

/// This process gets no more processor time than so many seconds.
pub fn limit_time(seconds: u64) -> Result<()> {
    join_job(JobLimit::UserTime { seconds })
}

/// Whether a process was ended by [`limit_time`].
pub fn ended_by_time(status: ExitStatus) -> bool {
    status.code() == i32::try_from(ERROR_NOT_ENOUGH_QUOTA).ok()
}

/// Starts without a console, which would flash up where the window has none.
pub fn without_window(command: &mut Command) -> &mut Command {
    command.creation_flags(CREATE_NO_WINDOW)
}
