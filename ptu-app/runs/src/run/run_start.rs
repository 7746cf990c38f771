//! When a run began, from which all its dates follow.

use fault_db::{RunEnd, Verdict};

use crate::clock;

/// When a run began. All dates of the run follow from this one and the time since, so that a clock that is set meanwhile
/// changes none of them.
#[derive(Clone, Copy)]
pub struct RunStart {
    /// Microseconds since 1970.
    pub(super) at_us: i64,
    at: std::time::Instant,
}

impl RunStart {
    /// A run that begins now.
    pub fn now() -> Self {
        Self {
            at_us: clock::now_us(),
            at: std::time::Instant::now(),
        }
    }

    /// The present time, microseconds since 1970.
    pub(super) fn now_us(&self) -> i64 {
        let since_us = i64::try_from(self.at.elapsed().as_micros()).unwrap_or(i64::MAX);
        self.at_us.saturating_add(since_us)
    }

    /// The end of the run, now.
    pub fn end(&self, verdict: Verdict, bench_time_us: i64) -> RunEnd {
        let finished_at_us = self.now_us();
        RunEnd {
            verdict,
            finished_at_us,
            bench_time_us,
            wall_time_us: finished_at_us - self.at_us,
        }
    }
}
