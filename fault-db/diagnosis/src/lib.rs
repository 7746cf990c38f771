//! Diagnosis: from test results to the replaceable part (LRU) that failed.
//!
//! [`matrix`] works on any dependency matrix of states and tests and builds the cheapest decision tree. The
//! other modules compare one run with a dictionary that holds the effect of each fault mode on each check,
//! in this order: [`Observation`] (what the run showed) → [`Dictionary`] (counts from campaigns, one `cell`
//! for each mode and check) → `likelihood` → [`Model`] (hypotheses and priors) → [`Belief`] (Bayes' rule,
//! step by step) → [`NextCheck`] and [`Diagnosis`].
//!
//! [`process`] is statistical process control of measured values over time, and forecasts.
//!
//! The crate knows no database and no bench; of `protocol` it uses the identifiers of parts and the
//! verdict. No function here is given the faults that were injected.

mod belief;
mod cell;
mod conclusion;
mod dictionary;
mod explained;
mod groups;
mod hidden;
mod likelihood;
pub mod matrix;
mod model;
mod next_check;
mod observation;
mod outlook;
mod pairs;
pub mod process;
mod proof;
mod reasons;
mod residuals;
mod settings;
mod signs;
mod spells;
mod strategy;
mod suspects;
mod unseen;
mod verdict;
mod weights;

pub use belief::{Belief, Settled};
pub use cell::{Cell, StepOutcome, Values};
pub use conclusion::Conclusion;
pub use dictionary::{Basis, Column, Dictionary, Mode, ModeName};
pub use explained::Cause;
pub use groups::{Group, Measure, Relations, Shared};
pub use model::{Hypothesis, Model};
pub use next_check::NextCheck;
pub use observation::{CLOCK_WRONG, CheckName, Observation, ObservedStep, Sign, is_observed};
pub use proof::Proof;
pub use reasons::{Known, Reason, Repaired, StepReason, ValueReason};
pub use settings::{ConclusionSettings, LikelihoodSettings, LogSettings, Settings};
pub use strategy::{Strategy, suite_s};
pub use verdict::{Assessment, Candidate, Diagnosis, Finding, PartProbability, TwoFaults};
pub use weights::FaultText;
