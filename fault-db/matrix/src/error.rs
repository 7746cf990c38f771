//! Errors in a matrix, in outcomes, or in the question asked of them.

/// A matrix, outcomes or options that cannot be worked with.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MatrixError {
    /// No JSON, or not of this shape; the cause says where.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    #[error("\"states\" is empty; at least one is needed")]
    NoStates,
    /// Nothing to tell apart with.
    #[error("\"tests\" is empty; at least one is needed")]
    NoTests,
    /// More cells than memory should be spent on.
    #[error("{states} states × {tests} tests are too many; at most {limit} cells")]
    TooManyCells {
        /// States given.
        states: usize,
        /// Tests given.
        tests: usize,
        /// Cells allowed.
        limit: usize,
    },
    /// An id that nobody could name.
    #[error("a {kind} has an empty id")]
    EmptyId {
        /// `state` or `test`.
        kind: &'static str,
    },
    /// Two states or two tests have the same name.
    #[error("{kind} \"{id}\" is there twice")]
    DuplicateId {
        /// `state` or `test`.
        kind: &'static str,
        id: String,
    },
    /// Negative, above 1, or no number.
    #[error("state \"{state}\" has the probability {p}; it must lie in 0..1")]
    Probability { state: String, p: f64 },
    /// Probabilities of all states together.
    #[error(
        "the probabilities of the {states} states sum to {sum}, not 1; exactly one state holds, so add what is missing (\"no fault\"?) or scale them"
    )]
    ProbabilitySum { states: usize, sum: f64 },
    /// Zero, negative, or no number.
    #[error("test \"{test}\" has the cost {cost}; it must be above 0 and finite")]
    Cost { test: String, cost: f64 },
    /// A cell outside 0..1.
    #[error(
        "test \"{test}\" fails in state \"{state}\" with the probability {value}; it must lie in 0..1"
    )]
    Cell {
        test: String,
        state: String,
        value: f64,
    },
    /// The number of cells is not states times tests.
    #[error("{found} cells for {states} states × {tests} tests")]
    CellCount {
        /// Cells given.
        found: usize,
        /// States given.
        states: usize,
        /// Tests given.
        tests: usize,
    },
    /// A test that is not in the matrix.
    #[error("\"outcomes\" name the test \"{test}\", which is not among \"tests\"")]
    UnknownTest { test: String },
    /// A state that is not in the matrix.
    #[error(
        "the outcomes of test \"{test}\" name the state \"{state}\", which is not among \"states\""
    )]
    UnknownState {
        /// The test whose cells name it.
        test: String,
        state: String,
    },
    /// The outcomes of a test are given twice.
    #[error("the outcomes of test \"{test}\" are there twice")]
    TestTwice { test: String },
    #[error("the outcomes of test \"{test}\" name the state \"{state}\" twice")]
    CellTwice { test: String, state: String },
    /// An outcome that was found, of a test nobody knows.
    #[error("an outcome is given for the test \"{test}\", which the matrix does not have")]
    OutcomeUnknown { test: String },
    /// Two outcomes of one test.
    #[error("two outcomes are given for the test \"{test}\"; give the one that holds")]
    OutcomeTwice { test: String },
    /// An outcome that the test does not have.
    #[error("test \"{test}\" has the outcome {found}; it must be {known}")]
    OutcomeWord {
        test: String,
        found: String,
        /// The outcomes that the test has.
        known: String,
    },
    /// A line of a table, or a cell in it, cannot be read.
    #[error("line {line}: {what}")]
    Table {
        /// Line of the file, from 1.
        line: u64,
        /// The reason why the line cannot be read.
        what: String,
    },
    #[error(
        "the outcomes contradict each other: {before}no state is left in which \"{test}\" {outcome}; a fault that is not among the states, two at once, or an intermittent one would explain it"
    )]
    Contradiction {
        /// The outcomes that went before, as words, empty or ending in a blank.
        before: String,
        /// The test whose outcome no remaining state explains.
        test: String,
        outcome: String,
    },
    /// A confidence that means nothing.
    #[error("the confidence {0} must be above 0.5 and at most 1")]
    Confidence(f64),
    /// Too large to ask for the optimum.
    #[error(
        "an optimal tree is made for at most {limit} states that differ and {limit} tests, here are {states} and {tests}; ask for a greedy one"
    )]
    TooLargeForOptimal {
        /// Groups of states that are left.
        states: usize,
        /// Tests that are left.
        tests: usize,
        /// Both may be this many.
        limit: usize,
    },
}

impl MatrixError {
    /// What is wrong in a line of a table.
    pub(super) fn table(line: u64, what: &str) -> Self {
        let what = what.to_owned();
        Self::Table { line, what }
    }

    /// An outcome that a test with these words, or without any, does not have.
    pub(super) fn no_outcome(test: &str, found: &str, words: &[String]) -> Self {
        let known = match words {
            [] => "0 or \"pass\", 1 or \"fail\"".to_owned(),
            words => format!("one of {}", words.join(", ")),
        };
        Self::OutcomeWord {
            test: test.to_owned(),
            found: format!("{found:?}"),
            known,
        }
    }
}
