//! Errors in a matrix, in outcomes, or in the options of a plan.

/// The reason why a matrix, outcomes or options cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MatrixError {
    /// The text is no JSON, or has another shape; the message says where.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    #[error("\"states\" is empty; at least one is needed")]
    NoStates,
    /// There is no test to tell states apart.
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
    /// An id is empty.
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
    /// A state's probability is negative, above 1, or no number.
    #[error("state \"{state}\" has the probability {p}; it must lie in 0..1")]
    Probability { state: String, p: f64 },
    /// The probabilities of all states do not add up to 1.
    #[error(
        "the probabilities of the {states} states sum to {sum}, not 1; exactly one state holds, so add what is missing (\"no fault\"?) or scale them"
    )]
    ProbabilitySum { states: usize, sum: f64 },
    /// A test's cost is zero, negative, or no number.
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
        /// The test whose cells name the state.
        test: String,
        state: String,
    },
    /// The outcomes of a test are given twice.
    #[error("the outcomes of test \"{test}\" are there twice")]
    TestTwice { test: String },
    #[error("the outcomes of test \"{test}\" name the state \"{state}\" twice")]
    CellTwice { test: String, state: String },
    /// An outcome is given for a test that the matrix does not have.
    #[error("an outcome is given for the test \"{test}\", which the matrix does not have")]
    OutcomeUnknown { test: String },
    /// Two outcomes are given for one test.
    #[error("two outcomes are given for the test \"{test}\"; give the one that holds")]
    OutcomeTwice { test: String },
    /// An outcome is given that the test does not have.
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
        /// The outcomes given before this one, as words; empty, or ending in a blank.
        before: String,
        /// The test whose outcome no remaining state explains.
        test: String,
        outcome: String,
    },
    /// The confidence is out of range.
    #[error("the confidence {0} must be above 0.5 and at most 1")]
    Confidence(f64),
    /// The matrix is too large for an optimal tree.
    #[error(
        "an optimal tree is made for at most {limit} states that differ and {limit} tests, here are {states} and {tests}; ask for a greedy one"
    )]
    TooLargeForOptimal {
        /// Groups of states that are left.
        states: usize,
        /// Tests that are left.
        tests: usize,
        /// Greatest number of groups, and of tests.
        limit: usize,
    },
}

impl MatrixError {
    /// The error for line `line` of a table; `what` is the reason.
    pub(super) fn table(line: u64, what: &str) -> Self {
        let what = what.to_owned();
        Self::Table { line, what }
    }

    /// The error for an outcome that a test does not have; `words` are the test's outcomes, empty for pass and fail.
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
