//! Promises of the program, tried as its users do: in virtual time or lock step but for [`on_ports`] and
//! [`by_the_clock`].

#[path = "../common/mod.rs"]
mod common;

mod adaptive;
mod automatic_runs;
mod bad_database;
mod bad_input;
mod bad_scripts;
mod by_the_clock;
mod campaigns;
mod departure;
mod diagnose;

mod documents;
mod event_lines;
mod fault_months;
mod faults;
mod figures;
mod first_steps;
mod forged;
mod history_files;
mod json_promise;
mod korean_terminal;
mod lock_step;
mod long_service;
mod no_unit;
mod on_a_terminal;
mod on_ports;
mod outputs;
mod package;
mod questions;
mod readers;
mod repair_sheet;
mod report;
mod resume;
mod scatter;
mod server;
mod sessions;
mod shards;
mod small_files;
mod suite;
mod trace_files;
mod train_faults;
mod twin;
mod worlds;
