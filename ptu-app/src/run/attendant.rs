//! Someone at the bench while it works.

use btu_rig::procedure::Runner;
use btu_rig::rig::Rig;
use protocol::Instant;

/// Sees what a bench does and has a hand on its runs. Called from the bench's own thread, which must
/// never wait for it.
pub trait Attendant: Send + Sync {
    /// A 50 ms cycle of the bench is over.
    fn see(&self, now: Instant, rig: &Rig);

    /// Before each scan of a procedure: pauses it, lets it go on, answers its prompts.
    fn direct(&self, runner: &mut Runner);
}
