//! The window on units on ports, and on a display. They go by the clock, and however long anything takes, the result is
//! the same: nothing here judges a time.

mod display;
mod window;
