//! Limits of memory and time of this process, and whether another process was ended by the limit of time.

use std::io::Result;
use std::os::unix::process::ExitStatusExt as _;
use std::process::{Command, ExitStatus};

use rustix::process::{Resource, Rlimit, Signal, setrlimit};

/// This process gets no more memory than so many bytes, and leaves no core dump. A system other than Linux may refuse
/// the limit of memory, because libraries alone may take more.
pub fn limit_memory(bytes: u64) -> Result<()> {
    let limited = limit(Resource::As, bytes, bytes);
    if cfg!(target_os = "linux") {
        limited?;
    }
    limit(Resource::Core, 0, 0)
}

/// This process gets no more processor time than so many seconds: SIGXCPU, by which [`ended_by_time`] knows the cause,
/// comes first, and SIGKILL, which cannot be ignored, a second later.
pub fn limit_time(seconds: u64) -> Result<()> {
    limit(Resource::Cpu, seconds, seconds + 1)
}

/// Whether a process was ended by [`limit_time`].
pub fn ended_by_time(status: ExitStatus) -> bool {
    status.signal() == Some(Signal::XCPU.as_raw())
}

/// Leaves the command as it is: here every program starts without a console. Windows needs more.
pub fn without_window(command: &mut Command) -> &mut Command {
    command
}

fn limit(resource: Resource, current: u64, maximum: u64) -> Result<()> {
    let limit = Rlimit {
        current: Some(current),
        maximum: Some(maximum),
    };
    Ok(setrlimit(resource, limit)?)
}
