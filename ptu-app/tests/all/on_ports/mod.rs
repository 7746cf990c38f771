//! Units and trains on ports and terminals. They go by the clock, and however long anything takes, the result is
//! the same: nothing here judges a time.

mod line;
mod older_unit;
mod runs;
mod train;
mod unit_log;
mod unit_memory;
