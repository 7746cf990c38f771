//! Stop requests: Ctrl-C, termination, a closed terminal, or the tester itself; presses are counted.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, OnceLock};

use btu_rig::procedure::{Finding, Verdict};

use crate::platform::StopSignals;

/// Counts the presses of stop; clones share the count.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<StopRequests>);

#[derive(Debug, Default)]
struct StopRequests {
    count: AtomicU32,
    /// The reason, if the tester itself pressed first.
    because: OnceLock<Finding>,
}

impl Stop {
    pub fn press(&self) {
        self.0.count.fetch_add(1, Ordering::Relaxed);
    }

    /// Presses stop, if it was not pressed: a second press would cut clean-up short.
    pub fn press_once(&self) {
        let (count, relaxed) = (&self.0.count, Ordering::Relaxed);
        let _ = count.compare_exchange(0, 1, relaxed, relaxed);
    }

    /// Presses stop for the tester itself, which cannot go on, unless somebody has pressed: a second press would cut
    /// clean-up short.
    pub fn press_because(&self, reason: Finding) {
        // The reason first: who sees the press asks for it.
        if self.presses() == 0 && self.0.because.set(reason).is_ok() {
            self.press_once();
        }
    }

    /// Reason for which the tester itself ended the run; `None` if the operator did.
    pub fn reason(&self) -> Option<&Finding> {
        self.0.because.get()
    }

    /// The verdict on what was still due when stop was pressed, and why; `None` if nobody pressed.
    pub fn left_out(&self) -> Option<(Verdict, Finding)> {
        let left_out = match self.reason() {
            Some(why) => (Verdict::Error, why.clone()),
            None => (Verdict::Aborted, Finding::Stopped),
        };
        (self.presses() > 0).then_some(left_out)
    }

    pub fn presses(&self) -> u32 {
        self.0.count.load(Ordering::Relaxed)
    }

    /// Whether the next procedure may begin.
    pub fn may_begin(&self) -> bool {
        self.presses() == 0
    }

    /// Listens to the system's requests to stop (interrupt, termination, a closed terminal) on a thread of its own, from before this returns.
    /// Without it (no runtime, no signals) the process ends at once, and the unit's own time-out makes its
    /// outputs safe.
    pub fn listen(&self) {
        self.listen_and(|| {});
    }

    /// As [`Self::listen`]; `then` runs at each signal.
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
            let Ok(mut signals) = StopSignals::listen() else {
                return;
            };
            let _ = listens.send(());
            loop {
                signals.next().await;
                self.press();
                then();
            }
        });
    }
}
