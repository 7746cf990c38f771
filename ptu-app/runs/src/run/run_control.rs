//! Observation of a bench and control of its runs by the window.

use btu_rig::procedure::Runner;
use btu_rig::rig::Rig;
use protocol::Instant;

/// Observes a bench after each cycle and controls the runner before each scan. Both are called on the bench's
/// thread and must not block.
pub trait RunControl: Send + Sync {
    /// Called after each 50 ms cycle of the bench.
    fn after_cycle(&self, now: Instant, rig: &Rig);

    /// Called before each scan of a procedure: pauses and resumes the runner and answers its prompts.
    fn before_scan(&self, runner: &mut Runner);
}
