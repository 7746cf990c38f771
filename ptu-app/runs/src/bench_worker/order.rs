//! Orders of the window to the bench thread.

use btu_rig::stimulus::Stimulus;

use crate::run::{BenchSetup, RunPlan};
use crate::stop::Stop;

/// What is to be run and where it is recorded.
pub struct RunOrder {
    /// Procedures and steps.
    pub plan: RunPlan,
    /// The database the run is recorded in, open: a bench does not wait for one.
    pub store: fault_db::Store,
    /// The embedded unit runs at the wall clock's pace.
    pub realtime: bool,
}

/// An order of the window to the bench thread.
pub(super) enum Order {
    Connect(Box<BenchSetup>, Stop),
    Disconnect,
    /// A manual stimulus, and the bench epoch in which it was given.
    Apply(Stimulus, u64),
    Arm(u64),
    MakeSafe,
    Run(Box<RunOrder>, Stop),
}
