//! Events of a procedure that runs on a bench: one type, stored and shown.

use btu_rig::procedure::RunEvent;
use btu_rig::recorded::StimulusRecord;
use btu_rig::recorder::{RecordedWindow, Row};
use btu_rig::rig::LinkTrouble;
use protocol::{Duration, Instant};

use super::fault_watch::FaultSeen;

/// Event of a procedure that runs on a bench. Times are bench times.
#[derive(Clone, Debug)]
pub enum SessionEvent {
    /// From the runner.
    Run(RunEvent),
    /// A fault was found; its number counts from 0 in this procedure.
    Fault(FaultSeen),
    /// The window around faults is complete.
    Trace(Box<RecordedWindow>),
    /// Rows since the last event of this kind, of a run that is recorded whole.
    Rows(Vec<Row>),
    /// Stimuli of a procedure whose traces came before.
    Recording(Box<RecordedStimuli>),
    /// Nothing can be judged any more: the unit cannot be reached, another one answers, or its log cannot
    /// be read.
    LinkLost(LinkTrouble),
    Ended {
        /// Bench time this procedure took, bring-up included.
        bench_time: Duration,
    },
}

/// Stimuli of one procedure, on the bench's clock.
#[derive(Clone, Debug)]
pub struct RecordedStimuli {
    /// When the procedure began.
    pub began: Instant,
    pub record: StimulusRecord,
}
