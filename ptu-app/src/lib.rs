//! The program `ptu`: its command line.
//!
//! * [`cli`]: one file per verb. `ptu gui` starts the program `ptu-window`; [`console`]: what `ptu run` says.
//!
//! Of the workspace only `ptu-app`, its crates `ptu-runs` and `ptu-report` and the served unit's program read clocks;
//! the database crate opens its own files and connections.

pub mod cli;
pub mod console;
mod event_stream;
mod operator;
mod run_recording;
mod sparkline;
pub mod verdict_table;
