//! A copy of the live data for one frame, so that the bench thread is blocked for a moment only.

use protocol::message::SelfTestItem;
use protocol::signal::{Sample, Signal};

use ptu_runs::bench_worker::{BenchWorker, Phase};

/// The bench as it was at the beginning of the frame.
#[derive(Debug, Default)]
pub struct BenchSnapshot {
    pub phase: Phase,
    /// Bench epoch: counts up when the bench is connected again or made safe.
    pub bench_epoch: u64,
    pub sample: Sample,
    /// Results of the last requested self-test.
    pub self_test: Vec<SelfTestItem>,
}

impl BenchSnapshot {
    /// A copy of the latest cycle.
    pub fn of(worker: &BenchWorker) -> Self {
        let live = worker.live();
        Self {
            phase: live.phase,
            bench_epoch: live.bench_epoch,
            sample: live.sample.clone(),
            self_test: live.self_test.clone(),
        }
    }

    /// Value of a signal; `None` while it is unknown.
    pub fn value(&self, signal: Signal) -> Option<f64> {
        self.sample.get(signal)
    }

    /// State of a bit or two-position contact; `None` while it is unknown.
    pub fn on(&self, signal: Signal) -> Option<bool> {
        self.value(signal).map(|value| value != 0.0)
    }

    /// Whether a signal is known to have this value.
    pub fn is(&self, signal: Signal, value: f64) -> bool {
        self.value(signal) == Some(value)
    }

    pub fn bits(&self, signal: Signal) -> Option<u16> {
        self.value(signal).map(|value| value as u16)
    }
}
