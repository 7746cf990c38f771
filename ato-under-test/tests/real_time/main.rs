//! What the program that serves the unit promises: command line, ports and clients, by the clock.

mod command_line;
mod independent_client;
mod tcp;
