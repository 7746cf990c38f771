//! What the window promises, tried as its users do: in virtual time or lock step but for [`on_ports`] and
//! [`by_the_clock`].

#[path = "../common/mod.rs"]
mod common;

mod at_hand;
mod bench_page;
mod by_the_clock;
mod care_dialog;
mod case_page;
mod compare_runs;
mod drive_page;
mod find;
mod history_page;
mod internal_names;
mod layout;
mod locked_window;
mod nothing_lost;
mod on_ports;
mod readers;
mod report_page;
mod server;
mod signals_page;
mod statistics_page;
mod traces_page;
mod window;
