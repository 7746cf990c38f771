//! What goes by the clock: ports, terminals and displays. A program of its own, so that it runs when nothing
//! else does.

#[path = "../common/mod.rs"]
mod common;

mod bad_link;
mod field;
mod manual;
mod older_unit;
mod pty;
mod real_window;
mod train;
mod train_faults;
mod unit_memory;
mod window;
mod window_on_train;
