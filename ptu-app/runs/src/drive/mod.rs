//! Runs of a whole train on the embedded unit: station to station by ATO in virtual time.
//!
//! * [`Request`]: what is asked for, as commands name it;
//! * [`Case`]: one section under one controller, ready to be driven;
//! * [`monte_carlo`]: a case driven thousands of times, each with another train and day;
//! * [`Setting`]: unit configuration keys changed for the purpose.

mod bench;
mod case;
mod choice;
pub mod monte_carlo;
mod settings;
pub mod train;

pub use bench::{DriveBench, drive};
pub use case::{Case, Driven, Request, drive_all};
pub use choice::{Fixed, S1, SectionChoice, disturbance};
pub use settings::{Setting, unit_config};
