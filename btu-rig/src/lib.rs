//! Everything around the unit under test.
//!
//! * [`conditions`]: how train, track and sensors differ from what the unit is told;
//! * [`bench_scatter`]: how good units, trains and benches differ, drawn for many runs;
//! * [`stimulus`]: what a procedure may do to the unit, as typed values;
//! * [`recorded`]: the stimuli of a run with their times, to repeat it;
//! * [`lever`]: positions of the master controller;
//! * [`tcms`]: train control and monitoring system, from cabs and unit to each car's demands;
//! * [`train`]: the train models;
//! * [`rig`]: generators, train, TCMS, wayside and tester session, stepped in virtual time; it sees
//!   the unit only through frames;
//! * [`drive`]: a station-to-station automatic run with its figures;
//! * [`procedure`]: check procedures built by Starlark at load, checked, and run by a polled state
//!   machine.
//!
//! No clock, no thread, no port: the edge steps everything.

pub mod bench_scatter;
pub mod conditions;
pub mod drive;
pub mod lever;
pub mod procedure;
pub mod recorded;
pub mod rig;
pub mod stimulus;
mod stored;
pub mod tcms;
pub mod train;
