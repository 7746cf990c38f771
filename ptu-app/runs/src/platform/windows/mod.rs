//! Windows.

mod calls;
pub mod files;
pub mod limits;
pub mod pipes;
pub mod ports;
pub mod process;
pub mod signals;
