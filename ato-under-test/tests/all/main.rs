//! What the unit promises, in process and in virtual time.

mod as_written;
mod ato_inputs;
mod automatic_operation;
mod brake_release;
mod by_the_clock;
mod command_line;
mod common;
mod crosstalk;
mod driverless;
mod independent_client;
mod journey;
mod maintenance;
mod maintenance_port;
mod orders;
mod plant;
mod protection;
mod robustness;
mod self_test;
mod speed_control;
mod stop_codes;
mod stored_memory;
mod tacho_share;
mod tcms;
mod test_mode;
mod test_signals;
mod wheel_entry;
