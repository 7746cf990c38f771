//! The program `ptu`: its command line and its window.
//!
//! * [`cli`]: the command line, one file per verb;
//! * [`gui`]: the technician's window.
//!
//! Only `ptu-app` and its crates `ptu-bench` and `ptu-report` read clocks, start threads and open files other than
//! the database.

pub mod cli;
mod console;
pub mod gui;
mod sparkline;
