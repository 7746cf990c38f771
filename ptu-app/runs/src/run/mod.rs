//! Runs procedures on benches, and stores and forwards the events of the run.
//!
//! ```text
//! bench (rig + unit) → Session → SessionEvent → Collector → store thread → fault-db
//!                                                        ↘ console
//! ```
//! Workers run procedures side by side, each with a stream of events. The collector reads the streams in the order
//! of the procedures, so that the record does not depend on the number of workers.

pub(crate) mod adaptive;
mod bench_contents;
pub(crate) mod bench_setup;
mod choice;
mod collector;
mod connect_port;
#[cfg(test)]
mod early_end_tests;
mod event;
mod evidence;
mod fault_watch;
mod first_failure;
mod instruments;
#[cfg(test)]
mod jogging_tests;
pub mod loading;
mod observe;
#[cfg(test)]
mod on_train_tests;
mod plan;
mod repaired;
mod repetitions;
#[cfg(test)]
mod resume_tests;
mod run_control;
mod run_start;
pub mod select;
mod session;
mod settle;
mod signals;
mod store_thread;
mod suite;
pub(crate) mod trace_data;
mod unfinished;
pub mod unit_text;
#[cfg(test)]
mod untrusted_unit_tests;
mod whole_run;
mod workers;

pub(crate) use adaptive::isolate;
pub use bench_contents::{BenchContents, BenchFile, Stimuli};
pub use bench_setup::{BenchSetup, Connected};
pub use choice::{BenchChoice, check_bench_faults, check_serial, software_version};
pub use collector::{Collector, Listener, Outcome};
pub use event::{RecordedStimuli, SessionEvent};
pub use evidence::{ClockEvidence, Evidence, InstrumentEvidence};
pub use fault_watch::{CHECK_FAILED, EB_UNREQUESTED, FaultSeen};
pub(crate) use fault_watch::{is_fault, of_event};
pub use observe::{ObservationBuilder, of_run};
pub use plan::{Adaptive, MeasuringRules, RunPlan, Task, different_steps, steps_of};
pub(crate) use repaired::trace_repaired;
pub use run_control::RunControl;
pub use run_start::RunStart;
pub(crate) use session::{Session, Window};
pub(crate) use settle::{READY_WITHIN, settled};
pub use signals::Signals;
pub use store_thread::{LinePrinter, RunStore};
pub use suite::Suite;
pub use trace_data::{channel, in_steps};
pub use unfinished::{Unfinished, unfinished};
pub use whole_run::{run, run_on, search};
pub(crate) use workers::TO_THE_END;
pub use workers::run_on_fresh;
