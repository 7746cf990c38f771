//! Runs procedures on units under test. Nothing here knows the window, and nothing writes a report.
//!
//! * [`aboard`]: the embedded unit aboard a simulated train, reached at its maintenance port;
//! * [`link`]: links to the embedded unit and to units on ports;
//! * [`run`]: runs procedures on benches, and stores and forwards their events;
//! * [`bench_worker`]: one unit under test and its bench thread, for the window;
//! * [`drive`]: automatic runs from station to station;
//! * [`train_server`]: serves the unit aboard a train on a port;
//! * [`replay`]: repeats recorded stimuli and compares traces;
//! * [`unit_log`]: imports a unit's own event log into the fault history;
//! * [`signal`]: waveforms made, and recordings read; [`sound`]: to and from a sound card;
//! * [`record`]: pulls a unit's own run record as traces, and compares them with a sound unit's run;
//! * [`run_diagnosis`]: finds the part to replace from the results of a run;
//! * [`campaign`]: runs the suite against every fault mode, for the fault dictionary;
//! * [`keys`]: keys of technicians and benches, and the list of those that are trusted;
//! * [`batch`]: many runs kept in a file, divided among machines, and put together;
//! * [`stored`]: the columns of the database for verdicts and faults;
//! * [`data`]: the scripts directory; `fleet`: the unit that each train should have; [`clock`]: the computer's time; [`failure`]: what a person reads;
//!   [`words`]: what is refused, in both languages; [`typed`]: lines of standard input; [`stop`]: interruption by a signal; [`terminal`]: its width and colours; [`platform`]: what operating systems do
//!   differently.

pub mod aboard;
pub mod batch;
pub mod bench_worker;
pub mod campaign;
pub mod clauses;
pub mod clock;
pub mod coverage;
pub mod data;
pub mod drive;
mod endpoint;
pub mod failure;
mod fleet;
pub mod keys;
pub mod link;
pub mod new_file;
pub mod owner_only;
pub mod places;
pub mod platform;
pub mod pool;
pub mod progress;
pub mod record;
pub mod replay;
pub mod run;
pub mod run_diagnosis;
pub mod schemas;
pub mod signal;
pub mod sound;
pub mod stdio;
pub mod stop;
pub mod stored;
pub mod structure;
pub mod symptoms;
pub mod table;
pub mod terminal;
#[cfg(test)]
mod test_support;
pub mod train_server;
pub mod typed;
pub mod unit_log;
pub mod whole_file;
pub mod words;
