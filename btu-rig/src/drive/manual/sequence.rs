//! A sequence of notches and switches: each step's condition and actions, and what is wrong with one.

use std::fmt;

use thiserror::Error;

use crate::drive::Load;
use crate::stimulus::Stimulus;

/// What a step waits for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// So long after the step before, or after the beginning, s.
    After(f64),
    /// The train reaches a speed, rising or falling, km/h.
    AtKmh(f64),
    /// The train stands after having moved.
    AtStandstill,
}

impl fmt::Display for When {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::After(seconds) => write!(f, "{seconds} s after the step before"),
            Self::AtKmh(kmh) => write!(f, "{kmh} km/h"),
            Self::AtStandstill => f.write_str("standstill"),
        }
    }
}

/// A step: a condition, and what the driver does once it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Line of its file, counted from 1; 0 = driven by hand.
    pub line: usize,
    /// What it waits for.
    pub when: When,
    /// What is done then, in this order.
    pub actions: Vec<Stimulus>,
}

/// A sequence, checked as far as it can be without train and unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sequence {
    /// Title of the report.
    pub title: String,
    /// Line it is made for; none = any.
    pub line: Option<String>,
    /// Section of that line.
    pub section: Option<u16>,
    /// Passengers aboard.
    pub load: Load,
    /// Speed code in the antenna; none = the highest.
    pub code: Option<String>,
    /// Added to the track's gradients, ‰, uphill positive.
    pub gradient_permille: f64,
    /// Steps in order.
    pub steps: Vec<Step>,
    /// So long after the last step the run is over, s; none = when the train has stood for 2 s.
    pub end_after_s: Option<f64>,
}

/// What is wrong with a sequence, and where.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("line {line}: {message}")]
pub struct SequenceError {
    /// Line of the file, counted from 1.
    pub line: usize,
    /// What is wrong, and what there is instead.
    pub message: String,
}
