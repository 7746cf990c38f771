//! The application of the maintenance test unit: command line, window, ports, clocks, files and reports.
//!
//! * [`cli`]: the command line, one file per verb;
//! * [`gui`]: the technician's window, and [`words`], its texts in two languages;
//! * [`bench_worker`]: one unit under test and its bench thread, for the window;
//! * [`run`]: runs procedures on benches, and stores and forwards their events;
//! * [`link`]: links to the embedded unit and to units on ports;
//! * [`drive`]: automatic runs from station to station, and manual runs;
//! * [`replay`]: repeats recorded stimuli and compares traces;
//! * [`field`]: imports a unit's own event log into the fault history;
//! * [`campaign`]: runs the suite against every fault mode, for the fault dictionary;
//! * [`diagnosis`]: finds the part to replace from the results of a run;
//! * [`report`]: reports of runs as HTML, PDF, JSON, JUnit XML and CSV; [`limits`]: values and limits in them;
//! * [`trace_view`]: prepares traces for drawing, independent of the window; [`trace_io`]: trace files;
//! * [`data`]: the scripts directory.
//!
//! Only this crate reads clocks, starts threads and opens files other than the database.

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
mod ticks;
pub mod trace_io;
pub mod trace_view;
pub mod words;
