//! Decides at which procedure a run with `--stop-on-fail` ends.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::SyncSender;

use btu_rig::procedure::{RunEvent, Verdict};

use super::event::SessionEvent;

/// The first procedure, in the order of the run, that did not pass.
///
/// A worker notes a failure before the stream of the failed procedure ends, and asks before it begins the next
/// procedure. The collector asks when the streams of all procedures before have ended, so that the record ends with the
/// failed one however many benches work side by side: procedures after it that a bench has begun are given up.
pub(super) struct FirstFailure {
    ends_run: bool,
    place: AtomicUsize,
}

impl FirstFailure {
    /// No failure so far; `ends_run` = the run ends with the first failure.
    pub(super) fn new(ends_run: bool) -> Self {
        Self {
            ends_run,
            place: AtomicUsize::new(usize::MAX),
        }
    }

    /// Whether the procedure with this place belongs to the run, as far as is known now; the answer is final once all
    /// procedures before it are over.
    pub(super) fn admits(&self, place: usize) -> bool {
        place <= self.place.load(Ordering::Acquire)
    }

    /// Runs the procedure with this place, noting whether it passes. `run` is given where its events go, and
    /// what says after each step whether to go on.
    pub(super) fn run_noting_failure(
        &self,
        place: usize,
        sender: SyncSender<SessionEvent>,
        run: impl FnOnce(&mut dyn FnMut(SessionEvent), &dyn Fn() -> bool),
    ) {
        let mut sink = |event: SessionEvent| {
            if self.ends_run && is_failure(&event) {
                self.place.fetch_min(place, Ordering::AcqRel);
            }
            // The collector listens until the stream ends, or wants no more of it.
            drop(sender.send(event));
        };
        run(&mut sink, &|| self.admits(place));
    }
}

/// A fault that was found while a unit was brought up fails no step, but the run.
fn is_failure(event: &SessionEvent) -> bool {
    match event {
        SessionEvent::Run(RunEvent::ProcedureFinished { verdict, .. }) => {
            !matches!(verdict, Verdict::Passed | Verdict::Skipped)
        }
        SessionEvent::Fault(_) => true,
        _ => false,
    }
}
