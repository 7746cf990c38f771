//! Stop requests: Ctrl-C, termination, a closed terminal, or the tester itself; presses are counted.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, OnceLock};

/// Counts the presses of stop; clones share the count.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<StopRequests>);

#[derive(Debug, Default)]
struct StopRequests {
    count: AtomicU32,
    /// The reason, if the tester itself pressed first.
    because: OnceLock<String>,
}

impl Stop {
    /// One more press.
    pub fn press(&self) {
        self.0.count.fetch_add(1, Ordering::Relaxed);
    }

    /// Pressed, if it was not: a second press would cut clean-up short.
    pub fn press_once(&self) {
        let (count, relaxed) = (&self.0.count, Ordering::Relaxed);
        let _ = count.compare_exchange(0, 1, relaxed, relaxed);
    }

    /// Pressed by the tester itself, which cannot go on, unless somebody has pressed: a second press would cut
    /// clean-up short.
    pub fn press_because(&self, reason: String) {
        // The reason first: who sees the press asks for it.
        if self.presses() == 0 && self.0.because.set(reason).is_ok() {
            self.press_once();
        }
    }

    /// Why the tester itself ended the run; `None` if the operator did.
    pub fn reason(&self) -> Option<&str> {
        self.0.because.get().map(String::as_str)
    }

    /// Presses so far.
    pub fn presses(&self) -> u32 {
        self.0.count.load(Ordering::Relaxed)
    }

    /// Whether another procedure may begin.
    pub fn may_begin(&self) -> bool {
        self.presses() == 0
    }

    /// Listens to interrupt, termination and hang-up signals on a thread of its own, from before this returns.
    /// Without it (no runtime, no signals) the process ends at once, and the unit's own time-out makes its
    /// outputs safe.
    pub fn listen(&self) {
        self.listen_and(|| {});
    }

    /// The same, and does something at each signal.
    pub fn listen_and(&self, then: impl Fn() + Send + 'static) {
        let stop = self.clone();
        let (listens, heard) = std::sync::mpsc::sync_channel(1);
        let _ = std::thread::Builder::new()
            .name("signals".into())
            .spawn(move || stop.wait(listens, &then));
        // Nothing comes from a thread that cannot listen, nor from one that could not be made.
        let _ = heard.recv();
    }

    fn wait(&self, listens: SyncSender<()>, then: &dyn Fn()) {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_io()
            .build();
        let Ok(runtime) = runtime else { return };
        runtime.block_on(async {
            use tokio::signal::unix::{SignalKind, signal};
            let (Ok(mut interrupt), Ok(mut terminate)) = (
                signal(SignalKind::interrupt()),
                signal(SignalKind::terminate()),
            ) else {
                return;
            };
            let mut hang_up = heeds_hang_up()
                .then(|| signal(SignalKind::hangup()).ok())
                .flatten();
            let _ = listens.send(());
            loop {
                tokio::select! {
                    _ = interrupt.recv() => {}
                    _ = terminate.recv() => {}
                    () = received(hang_up.as_mut()) => {}
                }
                self.press();
                then();
            }
        });
    }
}

/// Lets a write beyond the largest size that files may have (`ulimit -f`) fail with the system's words, where the
/// process would end without any. For good, from before this returns.
pub fn survive_file_limit() {
    /// Of Linux, macOS and the BSDs.
    const SIGXFSZ: i32 = 25;
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_io()
        .build();
    if let Ok(runtime) = runtime {
        let kind = tokio::signal::unix::SignalKind::from_raw(SIGXFSZ);
        // What is installed stays when this is dropped.
        drop(runtime.block_on(async { tokio::signal::unix::signal(kind) }));
    }
}

/// Waits for a signal, for ever if there is none to wait for.
async fn received(signal: Option<&mut tokio::signal::unix::Signal>) {
    match signal {
        Some(signal) => drop(signal.recv().await),
        None => std::future::pending().await,
    }
}

/// Whether a closed terminal is to end this process: not if it was started to outlive it (`nohup`).
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
