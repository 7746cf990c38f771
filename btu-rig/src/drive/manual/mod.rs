//! Driving by hand: notches and switches in sequence, with the unit in the loop. Sans-IO as
//! [`super::Drive`]: stepped once a scan after [`crate::rig::Bench::tick`].
//!
//! * `sequence`, `keys`, `file`: what is done when, and its file;
//! * `plan`: on which train, under which code;
//! * `player`: plays the sequence, scan by scan;
//! * `settle`, `figures`, `outcome`: what it came to.
//!
//! Terms: a *step* waits for its condition and then performs its actions; [`StepDone`] is a step performed.

mod figures;
mod file;
mod keys;
mod outcome;
mod plan;
mod player;
mod sequence;
mod settle;

pub use figures::Figures;
pub use file::{MAX_AFTER_S, MAX_STEPS, file_schema};
pub use keys::{names as key_names, stimulus, words};
pub use outcome::{AtpBrake, Ending, Outcome, StepDone};
pub use plan::{ManualError, Plan};
pub use player::Player;
pub use sequence::{Sequence, SequenceError, Step, When};
pub use settle::{Settled, WITHIN, settled};
