//! What judges times by the clock: one after the other, when nothing else runs.

mod acceptance;
mod pace;
mod standstill;
