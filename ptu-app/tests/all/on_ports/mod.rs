//! Units and trains on ports, terminals and displays. They go by the clock, and however long anything takes, the result is
//! the same: nothing here judges a time.

mod display;
mod field;
mod line;
mod older_unit;
mod runs;
mod train;
mod unit_memory;
mod window;
