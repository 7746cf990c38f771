//! Requests to stop, as signals.

use std::io::Result;

use tokio::signal::unix::{Signal, SignalKind, signal};

/// Interrupt, termination, and hang-up unless the process was started to outlive its terminal.
pub struct StopSignals {
    interrupt: Signal,
    terminate: Signal,
    hang_up: Option<Signal>,
}

impl StopSignals {
    /// From now on none of these signals ends the process.
    ///
    /// # Errors
    /// The system's.
    pub fn listen() -> Result<Self> {
        Ok(Self {
            interrupt: signal(SignalKind::interrupt())?,
            terminate: signal(SignalKind::terminate())?,
            hang_up: heeds_hang_up()
                .then(|| signal(SignalKind::hangup()).ok())
                .flatten(),
        })
    }

    /// Waits for the next signal.
    pub async fn next(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
            () = received(self.hang_up.as_mut()) => {}
        }
    }
}

/// Waits for a signal, for ever if there is none to wait for.
async fn received(signal: Option<&mut Signal>) {
    match signal {
        Some(signal) => drop(signal.recv().await),
        None => std::future::pending().await,
    }
}

/// Lets a write beyond the largest size that files may have (`ulimit -f`) fail with the system's words, where the
/// process would end without any. For good, from before this returns.
pub fn survive_file_limit() {
    /// Number of the signal on Linux, macOS and the BSDs.
    const SIGXFSZ: i32 = 25;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_io()
        .build();
    if let Ok(runtime) = runtime {
        let kind = SignalKind::from_raw(SIGXFSZ);
        // What is installed stays when this is dropped.
        drop(runtime.block_on(async { signal(kind) }));
    }
}

/// Whether a closed terminal is to end this process: not if the process was started to outlive the terminal (`nohup`).
fn heeds_hang_up() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    !ignores_hang_up(&status)
}

/// Whether SIGHUP, number 1 and so bit 0, is ignored, by what Linux tells of a process.
fn ignores_hang_up(status: &str) -> bool {
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored
        .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
        .is_some_and(|mask| mask & 1 != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_started_with_nohup_ignores_a_closed_terminal() {
        let status = |mask| format!("Name:\tptu\nSigBlk:\t0000000000000001\nSigIgn:\t{mask}\n");
        assert!(ignores_hang_up(&status("0000000000001001")));
        assert!(!ignores_hang_up(&status("0000000000001000")));
        assert!(!ignores_hang_up("no Linux"));
    }
}
