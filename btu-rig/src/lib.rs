//! The bench around a unit under test: generators, train, TCMS, wayside, tester and check procedures.
//!
//! * [`conditions`]: deviations of train, track and sensors from the unit's configuration;
//! * [`bench_scatter`]: scatter of good units, trains and benches, drawn for each run;
//! * [`stimulus`]: everything that can be done to a unit, as typed values;
//! * [`recorded`]: the stimuli of a run with their times, to repeat it;
//! * [`lever`]: positions of the master controller;
//! * [`tcms`]: train control and monitoring system, from cabs and unit to each car's demands;
//! * [`train`]: the train models;
//! * [`rig`]: generators, train, TCMS, wayside and tester session, stepped in virtual time; it sees
//!   the unit only through frames;
//! * [`waveform`]: what is in the coils, as samples: codes, TWC, noise;
//! * [`recorder`]: the 50 ms row of every signal, the ring of the latest, and windows around triggers;
//! * [`drive`]: a station-to-station automatic run with its figures;
//! * [`procedure`]: check procedures built by Starlark at load, checked, and run by a polled state
//!   machine.
//!
//! No clock, no thread, no port: the caller steps everything.

pub mod bench_scatter;
pub mod conditions;
pub mod drive;
pub mod lever;
pub mod procedure;
mod random;
pub mod recorded;
pub mod recorder;
pub mod rig;
pub mod stimulus;
mod stored;
pub mod tcms;
pub mod train;
pub mod waveform;
