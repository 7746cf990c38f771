//! Diagnosis: from test results to the replaceable part (LRU) that failed.
//!
//! One run is compared with a dictionary that holds the effect of each fault mode on each check, in this
//! order: [`Observation`] (what the run showed) → [`Dictionary`] (counts from campaigns, one `cell` for each
//! mode and check) → `likelihood` → [`Model`] (hypotheses and priors) → [`Belief`] (Bayes' rule,
//! step by step) → `pool` (all evidence for each part) → [`NextCheck`] and [`Diagnosis`].
//!
//! [`process`] is statistical process control of measured values over time, and forecasts.
//!
//! The crate knows no database and no bench; of `protocol` it uses the identifiers of parts and the
//! verdict. No function here is given the faults that were injected.

mod belief;
mod cell;
mod common;
mod conclusion;
mod counted;
mod dictionary;
mod explained;
mod groups;
mod hidden;
mod likelihood;
mod logarithms;
mod model;
mod next_check;
mod observation;
mod outlook;
mod pool;
pub mod process;
mod proof;
mod reasons;
mod residuals;
mod settings;
mod signs;
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
pub use settings::{
    ConclusionSettings, CountedSettings, LikelihoodSettings, LogSettings, PoolSettings, Settings,
};
pub use strategy::{Strategy, suite_s};
pub use verdict::{Assessment, Candidate, Diagnosis, Finding, PartProbability};
pub use weights::FaultText;
