//! Errors of a sequence file.

use thiserror::Error;

use super::file::MAX_STEPS;

/// What is wrong with a sequence, and where.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("line {line}: {wrong}")]
pub struct SequenceError {
    /// Line of the file, counted from 1.
    pub line: usize,
    /// What.
    pub wrong: Wrong,
}

/// What can be wrong with a sequence.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Wrong {
    /// No TOML, or an unknown key, or a value of another kind.
    #[error("{0}")]
    Syntax(String),
    /// No step at all.
    #[error("no [[steps]]: nothing is done")]
    NoSteps,
    /// Too many.
    #[error("more than {MAX_STEPS} steps")]
    TooManySteps,
    /// A step does not say when.
    #[error("the step says not when: give it one of after_s, at_kmh and at_standstill")]
    NoCondition,
    /// A step says when twice.
    #[error("the step says when twice: {0}; keep one")]
    TwoConditions(String),
    /// `at_standstill = false`.
    #[error("at_standstill can only be true: leave it out to wait for something else")]
    NotAtStandstill,
    /// A step does nothing.
    #[error("the step does nothing: give it a lever, a switch or a cut-out")]
    NoAction,
    /// A position the master controller does not have.
    #[error("no lever position \"{0}\"; it has EB, B7 to B1, N, P0.5, P1 to P4")]
    NoLever(String),
    /// A position the reverser does not have.
    #[error("no reverser position \"{0}\"; it has forward, neutral, backward")]
    NoReverser(String),
    /// A load that is none.
    #[error("no load \"{0}\": use a mass in kg, \"empty\" or \"full\"")]
    NoLoad(String),
    /// A number out of range.
    #[error("{key} = {value} is outside {low} .. {high}")]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// Its value as written.
        value: String,
        /// Least.
        low: String,
        /// Most.
        high: String,
    },
    /// It waits for a train that nothing has moved.
    #[error("the step waits for {0}, but no step before it powers: the train stands")]
    NothingMoves(String),
    /// ATP brakes before that speed.
    #[error("{kmh} km/h is never reached: ATP brakes above {limit_kmh} km/h (code {code})")]
    BeyondLimit {
        /// Speed waited for, km/h.
        kmh: String,
        /// Limit of the code, km/h.
        limit_kmh: String,
        /// The code.
        code: String,
    },
    /// A car the train does not have.
    #[error("car {car}: train {train} has cars 1 to {count}")]
    NoCar {
        /// The car.
        car: u8,
        /// The train.
        train: String,
        /// How many it has.
        count: usize,
    },
    /// A car without inverter.
    #[error("car {car} ({name}) of train {train} has no inverter; {motors} have one")]
    NoInverter {
        /// The car.
        car: u8,
        /// Its name.
        name: String,
        /// The train.
        train: String,
        /// Cars that have one.
        motors: String,
    },
}
