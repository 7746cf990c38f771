//! What to bear in mind with the answer of a diagnosis.

use thiserror::Error;

/// What a dictionary was made of, where that is not what there is now.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Differs {
    /// Another unit, line or train, other scatter or other faults.
    #[error("made of another unit configuration, line, train, scatter or fault catalogue")]
    Configuration,
    /// Scripts that are not there now: how many.
    #[error("made with {0} scripts that are gone")]
    Gone(usize),
    /// Scripts that are otherwise now: the first three, separated by commas.
    #[error("made before {0} changed")]
    Changed(String),
    /// The first three of more, and how many are left.
    #[error("made before {0} and {1} more scripts changed")]
    ManyChanged(String, usize),
}

/// Why an answer is worth less than others.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Warning {
    /// The dictionary was made on another connection.
    #[error(
        "the fault dictionary was made on another connection: make one with `ptu campaign{how}`"
    )]
    OtherConnection {
        /// Options of the command that makes one.
        how: &'static str,
    },
    /// The dictionary was made of other scripts, or another configuration.
    #[error("the fault dictionary is stale, {differs}: make a new one with `ptu campaign{how}`")]
    Stale {
        /// In what it differs.
        differs: Differs,
        /// Options of the command that makes one.
        how: &'static str,
    },
    /// The dictionary does not know all fault modes of the catalogue.
    #[error("the fault dictionary knows {modes} of {of} fault modes only")]
    KnowsPart {
        /// How many it knows.
        modes: usize,
        /// How many there are.
        of: usize,
    },
    /// The run has nothing to weigh.
    #[error("the run has no step and no fault that could be diagnosed")]
    NothingToDiagnose,
    /// The file of relations between parts cannot be read.
    #[error("parts that are hard to tell apart are not known: {why}")]
    NoRelations {
        /// Why.
        why: String,
    },
    /// The run's unit is configured otherwise.
    #[error("the run's unit configuration, {name}, is not the one the dictionary was made with")]
    OtherConfiguration {
        /// Its configuration.
        name: String,
    },
    /// The run is on another line.
    #[error("the run is on {line}, the dictionary was made on {of_dictionary}")]
    OtherLine {
        /// Of the run.
        line: String,
        /// Of the dictionary.
        of_dictionary: String,
    },
    /// Scripts have changed.
    #[error(
        "scripts of the run differ from those the dictionary was made with; their steps are left out: {scripts}"
    )]
    OtherScripts {
        /// Which.
        scripts: String,
    },
    /// Steps are not in the dictionary.
    #[error("{steps} steps are not in the dictionary and say nothing")]
    UnknownSteps {
        /// How many.
        steps: usize,
    },
}
