//! The calls of Windows for which no crate in use has a safe function.
#![expect(
    unsafe_code,
    reason = "the only calls of the system itself, each with its own reason"
)]

use std::io::{Error, Result};
use std::mem::size_of;
use std::ptr::null;

use windows_sys::Win32::System::Console::{FreeConsole, GetConsoleProcessList};
use windows_sys::Win32::System::JobObjects::{
    AssignProcessToJobObject, CreateJobObjectW, JOB_OBJECT_LIMIT_PROCESS_MEMORY,
    JOB_OBJECT_LIMIT_PROCESS_TIME, JOBOBJECT_EXTENDED_LIMIT_INFORMATION,
    JobObjectExtendedLimitInformation, SetInformationJobObject,
};
use windows_sys::Win32::System::Threading::GetCurrentProcess;

/// A limit that Windows puts on this process, and on each of its children.
pub enum JobLimit {
    /// Memory that it may have, bytes.
    Memory(usize),
    /// Processor time that it may take.
    UserTime { seconds: u64 },
}

/// Ticks of the system's clock, 100 ns, in a second.
const TICKS_A_SECOND: u64 = 10_000_000;

/// Binds this process for good: a job within the job that it may be in already.
pub fn join_job(limit: JobLimit) -> Result<()> {
    let mut limits = JOBOBJECT_EXTENDED_LIMIT_INFORMATION::default();
    let basic = &mut limits.BasicLimitInformation;
    match limit {
        JobLimit::Memory(bytes) => {
            basic.LimitFlags = JOB_OBJECT_LIMIT_PROCESS_MEMORY;
            limits.ProcessMemoryLimit = bytes;
        }
        JobLimit::UserTime { seconds } => {
            basic.LimitFlags = JOB_OBJECT_LIMIT_PROCESS_TIME;
            basic.PerProcessUserTimeLimit = (seconds * TICKS_A_SECOND).cast_signed();
        }
    }
    // SAFETY: no name and no attributes are asked for; the handle is checked, and stays open as long as the process.
    // The structure is as long as is said, and read only.
    let joined = unsafe {
        let job = CreateJobObjectW(null(), null());
        !job.is_null()
            && SetInformationJobObject(
                job,
                JobObjectExtendedLimitInformation,
                (&raw const limits).cast(),
                size_of::<JOBOBJECT_EXTENDED_LIMIT_INFORMATION>() as u32,
            ) != 0
            && AssignProcessToJobObject(job, GetCurrentProcess()) != 0
    };
    match joined {
        true => Ok(()),
        false => Err(Error::last_os_error()),
    }
}

/// Gives up a console that this process has to itself.
pub fn leave_own_console() {
    let mut processes = [0u32; 2];
    // SAFETY: the list is as long as is said. Nothing of this process uses the console any more.
    unsafe {
        if GetConsoleProcessList(processes.as_mut_ptr(), 2) == 1 {
            FreeConsole();
        }
    }
}
