//! Linux, and macOS by reading only. What only Linux has is asked for when the program runs, or behind
//! `target_os`.

pub mod files;
pub mod limits;
pub mod pipes;
pub mod ports;
pub mod process;
pub mod signals;
