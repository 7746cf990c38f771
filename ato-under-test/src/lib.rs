//! The on-board ATC unit under test: a real controller, built from published papers.
//!
//! It has the parts of an SG-100 kind of unit (S2) and talks to the world through encoded frames
//! only:
//! * `kernel`: start-up self-test and event log;
//! * `com`: links, input image, maintenance session;
//! * `atp`: speed code, speed, overspeed supervision, brakes, doors, direction, modes;
//! * `twc`, `psm`, [`ato`]: wayside data, markers and TRA, automatic operation;
//! * `driverless`: what ATO does in place of people: doors, turn-back, put-away and wake-up;
//! * [`flash`]: event log and run record over power-ups;
//! * `test_board`: test signals of an armed tester;
//! * [`receivers`]: from the waveforms in the coils to codes and bytes;
//! * `faults`: injected faults by place;
//! * `front_end`: antennas, sensors and relays, where injected faults act;
//! * `guards`: what injected faults put out of action elsewhere.
//!
//! It has three ports ([`Port`]): the harness carries all, the maintenance port a tester alone, the loop TWC alone.
//! [`Unit`] is stepped every 10 ms of virtual time; nothing here knows a clock, a thread or a file,
//! and `no_std` keeps it so. [`serve`], a feature of its own, needs the standard library: it serves a
//! unit on a port in real time, and `flash::FileFlash` beside it keeps its memory in a file.
#![no_std]

extern crate alloc;
// `std` is named for tests alone. Named here for all builds, it would hide a use of `std` in the controller whenever
// programs are built. Each file of `serve` names it for itself.
#[cfg(test)]
extern crate std;

pub mod ato;
mod atp;
mod com;
mod driverless;
mod faults;
pub mod flash;
#[cfg(test)]
mod for_tests;
mod front_end;
mod guards;
mod kernel;
mod keyed;
mod psm;
pub mod receivers;
#[cfg(feature = "serve")]
pub mod serve;
mod setup;
mod signals;
mod speedometer;
mod test_board;
mod timer;
mod twc;
mod unit;

pub use com::Port;
pub use kernel::{LOG_CAPACITY, RUN_ROWS};
pub use setup::Setup;
pub use unit::Unit;
