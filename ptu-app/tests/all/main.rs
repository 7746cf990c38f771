//! What the program promises, tried as its users do, in virtual time.

#[path = "../common/mod.rs"]
mod common;

mod automatic_runs;
mod bad_database;
mod bad_input;
mod bad_scripts;
mod bench_page;
mod care;
mod cases;
mod diagnose;
mod diagnose_matrix;
mod documents;
mod drive;
mod fault_months;
mod faults;
mod figures;
mod history;
mod history_page;
mod questions;
mod report;
mod report_page;
mod saved_questions;
mod scatter;
mod server;
mod suite;
mod trace_files;
mod traces_page;
mod twin;
