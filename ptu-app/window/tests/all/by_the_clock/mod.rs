//! Tests that judge times by the clock: one after the other, when nothing else runs.

mod idle;
mod question;
