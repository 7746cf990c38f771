//! Words in which a bench tells what it changes in procedures.

use btu_rig::procedure::plan::Condition;
use protocol::signal::Signal;

use crate::words::BenchNote;

/// Functions that put into words what a bench changes in procedures.
#[derive(Clone, Copy)]
pub struct Teller<'a> {
    /// Text of a note.
    pub note: &'a dyn Fn(BenchNote) -> String,
    /// Name of a signal for people.
    pub signal: &'a dyn Fn(Signal) -> String,
    /// Text of what a person is to do, or of an input's key.
    pub text: &'a dyn Fn(&str) -> String,
    /// Question whether a signal has the value that a step expects.
    pub condition: &'a dyn Fn(&Condition) -> String,
}
