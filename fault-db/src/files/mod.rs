//! Files of the operating system, whatever they hold.

pub(crate) mod databases;
pub(crate) mod held_file;
pub(crate) mod platform;
pub(crate) mod regular_file;
