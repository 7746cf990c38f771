//! What the program promises, tried as its users do: in virtual time or lock step but for [`on_ports`] and [`by_the_clock`].

#[path = "../common/mod.rs"]
mod common;

mod adaptive;
mod at_hand;
mod automatic_runs;
mod bad_database;
mod bad_input;
mod bad_scripts;
mod bench_page;
mod by_the_clock;
mod care;
mod case_page;
mod cases;
mod compare_runs;
mod diagnose;
mod diagnose_matrix;
mod documents;
mod drive;
mod drive_by_hand;
mod fault_months;
mod faults;
mod figures;
mod history;
mod history_page;
mod layout;
mod lock_step;
mod locked_window;
mod no_unit;
mod on_ports;
mod questions;
mod repair_sheet;
mod report;
mod report_page;
mod resume;
mod saved_questions;
mod scatter;
mod server;
mod statistics_page;
mod suite;
mod symptoms;
mod trace_files;
mod traces_page;
mod train_faults;
mod twin;
mod window;
