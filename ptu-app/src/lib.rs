//! The program `ptu`: its command line and its window.
//!
//! * [`cli`]: the command line, one file per verb;
//! * [`gui`]: the technician's window.
//!
//! Of the workspace only `ptu-app`, its crates `ptu-bench` and `ptu-report` and the served unit's program read clocks;
//! the database crate opens its own files and connections.

pub mod cli;
mod console;
mod distances;
mod event_stream;
mod fault_months;
#[cfg(feature = "window")]
pub mod gui;
mod operator;
mod run_recording;
mod sound_file;
mod sparkline;
mod trend;
