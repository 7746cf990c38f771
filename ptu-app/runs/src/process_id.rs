//! Identifies this process so that another process can tell whether it still runs.

use crate::platform::start_of;

/// `pid:start` of this process; the start time keeps a reused pid apart.
pub fn this_process() -> String {
    let pid = std::process::id();
    format!("{pid}:{}", start_of(pid).unwrap_or_default())
}

/// Whether the process named by [`this_process`] still lives, as far as it is known.
pub fn is_alive(owner: &str) -> bool {
    let Some((pid, start)) = owner.split_once(':') else {
        return false;
    };
    let Ok(pid) = pid.parse() else { return false };
    start_of(pid).is_some_and(|found| found == start)
}
