//! The operator's stop: Ctrl-C or a polite kill, counted; and a run's own decision to end early.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Counts the presses of stop; clones share the count.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<State>);

#[derive(Debug, Default)]
struct State {
    presses: AtomicU32,
    ended: AtomicBool,
}

impl Stop {
    /// One more press.
    pub fn press(&self) {
        self.0.presses.fetch_add(1, Ordering::Relaxed);
    }

    /// Presses so far.
    pub fn presses(&self) -> u32 {
        self.0.presses.load(Ordering::Relaxed)
    }

    /// No further procedure is begun; the present one goes on.
    pub fn end(&self) {
        self.0.ended.store(true, Ordering::Relaxed);
    }

    /// Whether another procedure may begin.
    pub fn may_begin(&self) -> bool {
        self.presses() == 0 && !self.0.ended.load(Ordering::Relaxed)
    }

    /// Listens to interrupt and termination signals on a thread of its own. Without it (no runtime,
    /// no signals) the process ends at once, and the unit's own time-out makes its outputs safe.
    pub fn listen(&self) {
        self.listen_and(|| {});
    }

    /// The same, and does something at each signal.
    pub fn listen_and(&self, then: impl Fn() + Send + 'static) {
        let stop = self.clone();
        let _ = std::thread::Builder::new()
            .name("signals".into())
            .spawn(move || stop.wait(&then));
    }

    fn wait(&self, then: &dyn Fn()) {
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
            loop {
                tokio::select! {
                    _ = interrupt.recv() => self.press(),
                    _ = terminate.recv() => self.press(),
                }
                then();
            }
        });
    }
}
