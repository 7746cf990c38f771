//! The edge of the maintenance test unit: command line, ports, clocks, files and reports.
//!
//! * [`cli`]: one file per verb;
//! * [`run`]: procedures on benches, one stream of events, recording;
//! * [`replay`]: what was done to a bench done again: good twins, differences of traces, replays;
//! * [`drive`]: station-to-station automatic runs, one or thousands;
//! * [`link`]: the embedded unit and units on ports;
//! * [`limits`]: measured values between their limits, as people read them;
//! * [`campaign`]: the suite against every fault mode, for the fault dictionary and its worth;
//! * [`diagnosis`]: from a run to the part to replace;
//! * [`field`]: a unit's own event log becomes faults in the history;
//! * [`trace_view`]: recorded signals as lanes of a plot, without anything of a window;
//! * [`trace_io`]: traces to and from other programs' files;
//! * [`report`]: what a run came to, as JSON, JUnit XML and a table;
//! * [`data`]: the scripts directory.
//!
//! Only here are clocks read, threads started and files opened.

pub mod bench_worker;
pub mod campaign;
pub mod cli;
pub mod clock;
mod console;
pub mod data;
pub mod diagnosis;
pub mod drive;
pub mod failure;
pub mod field;
pub mod fonts;
pub mod gui;
pub mod limits;
pub mod link;
mod new_file;
mod owner;
mod pool;
mod private;
mod progress;
pub mod replay;
pub mod report;
pub mod run;
mod sparkline;
pub mod stop;
mod table;
mod tell;
pub mod trace_io;
pub mod trace_view;
pub mod words;
