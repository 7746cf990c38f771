//! The program `ptu`: its command line.
//!
//! * [`cli`]: one file per verb. `ptu gui` starts the program `ptu-window`; [`console`]: what `ptu run` says.
//!
//! `protocol`, the unit's library, `btu-rig` and `diagnosis` read no clock. `fault-db` opens its own files and
//! connections, and reads a clock only to end the check of a file in time.

pub mod cli;
pub mod console;
mod event_stream;
mod operator;
mod run_recording;
mod sparkline;
pub mod verdict_table;
