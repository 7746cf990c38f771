//! From results to the part that failed.
//!
//! Two rooms. [`matrix`] works on any dependency matrix of states and tests and builds the cheapest
//! decision tree. The rest reads what a run found against a dictionary of what each fault mode does
//! to each check, in this order: [`Observation`] (what was seen) → [`Dictionary`] (what campaigns
//! counted, `cell` by `cell`) → `likelihood` → [`Model`] (hypotheses and priors) → [`Belief`]
//! (Bayes' rule, step by step) → [`NextCheck`] and [`Diagnosis`].
//!
//! Nothing here knows which fault, if any, was injected.

mod belief;
mod cell;
mod dictionary;
mod likelihood;
pub mod matrix;
mod model;
mod next_check;
mod observation;
mod pairs;
mod reasons;
mod settings;
mod strategy;
mod verdict;

pub use belief::Belief;
pub use cell::{Cell, Signature, Values};
pub use dictionary::{Basis, Column, Dictionary, Mode, ModeName};
pub use model::{Hypothesis, Model};
pub use next_check::NextCheck;
pub use observation::{CheckName, Observation, Result, Sign, StepSeen};
pub use settings::Settings;
pub use strategy::{Effort, Strategy, fixed_order, replayed};
pub use verdict::{Candidate, Diagnosis, Finding, PartProbability, TwoFaults};
