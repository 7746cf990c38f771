//! Probabilities of the states, before any test and after given outcomes.

use super::error::MatrixError;
use super::model::Matrix;

/// The outcome of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The test passed: outcome 0.
    Pass,
    /// The test failed: outcome 1, it detected something.
    Fail,
    /// The outcome is this word, for a test with words.
    Word(String),
}

impl Outcome {
    /// Reads `0`, `pass`, `passed`, `1`, `fail`, `failed`, or the word of another outcome.
    pub fn parse(word: &str) -> Self {
        match word {
            "0" | "pass" | "passed" => Self::Pass,
            "1" | "fail" | "failed" => Self::Fail,
            word => Self::Word(word.to_owned()),
        }
    }

    /// As a verb: `passes`, `fails`.
    fn verb(&self) -> String {
        match self {
            Self::Pass => "passes".to_owned(),
            Self::Fail => "fails".to_owned(),
            Self::Word(word) => format!("is \"{word}\""),
        }
    }

    /// The outcome as files and the command line write it.
    fn word(&self) -> &str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "fail",
            Self::Word(word) => word,
        }
    }

    /// Index of the outcome among the test's words, or, without words, 0 for pass and 1 for fail.
    pub(super) fn place(&self, words: &[String]) -> Option<usize> {
        match self {
            _ if !words.is_empty() => words.iter().position(|word| Self::parse(word) == *self),
            Self::Pass => Some(0),
            Self::Fail => Some(1),
            Self::Word(_) => None,
        }
    }
}

/// Probabilities of the states, given the outcomes of tests.
#[derive(Clone, Debug, PartialEq)]
pub struct Posterior {
    probabilities: Vec<f64>,
    /// States that no outcome rules out; a state of probability 0 may be among them.
    possible: Vec<bool>,
    /// Tests that have been done.
    done: Vec<bool>,
}

impl Posterior {
    /// The probabilities in the matrix, before any test.
    pub fn prior(matrix: &Matrix) -> Self {
        let states = &matrix.states();
        Self {
            probabilities: states.iter().map(|state| state.probability).collect(),
            possible: vec![true; states.len()],
            done: vec![false; matrix.tests().len()],
        }
    }

    /// The probabilities after these outcomes, by Bayes' rule.
    ///
    /// # Errors
    /// A test is unknown or given twice, or no state explains the outcomes.
    pub fn given(matrix: &Matrix, outcomes: &[(String, Outcome)]) -> Result<Self, MatrixError> {
        let mut known = Self::prior(matrix);
        let mut before = Vec::new();
        for (name, outcome) in outcomes {
            let test = matrix
                .tests()
                .iter()
                .position(|test| test.id == *name)
                .ok_or_else(|| MatrixError::OutcomeUnknown { test: name.clone() })?;
            if known.done[test] {
                return Err(MatrixError::OutcomeTwice { test: name.clone() });
            }
            let words = matrix.words(test);
            let Some(place) = outcome.place(words) else {
                return Err(MatrixError::no_outcome(name, outcome.word(), words));
            };
            if !known.learn(matrix, test, place) {
                return Err(MatrixError::Contradiction {
                    before: history(&before),
                    test: name.clone(),
                    outcome: outcome.verb(),
                });
            }
            before.push(format!("\"{name}\" {}", outcome.verb()));
        }
        Ok(known)
    }

    /// Weighs one outcome; `false` if no state explains it.
    fn learn(&mut self, matrix: &Matrix, test: usize, outcome: usize) -> bool {
        let mut likelihoods: Vec<f64> = (0..self.probabilities.len())
            .map(|state| matrix.likelihood(test, outcome, matrix.row(state)[test]))
            .collect();
        let explains = |p: &f64, likelihood: f64| if *p > 0.0 { likelihood } else { 0.0 };
        let largest = self
            .probabilities
            .iter()
            .zip(&likelihoods)
            .map(|(p, likelihood)| explains(p, *likelihood))
            .fold(0.0, f64::max);
        if largest <= 0.0 {
            return false;
        }
        for likelihood in &mut likelihoods {
            // Scaled, so that a product of many small numbers does not become 0.
            *likelihood /= largest;
        }
        for ((p, possible), likelihood) in self
            .probabilities
            .iter_mut()
            .zip(&mut self.possible)
            .zip(&likelihoods)
        {
            *p *= likelihood;
            *possible &= *likelihood > 0.0;
        }
        let total: f64 = self.probabilities.iter().sum();
        for p in &mut self.probabilities {
            *p /= total;
        }
        self.done[test] = true;
        true
    }

    /// Probability of a state; 0 for an unknown state.
    pub fn probability(&self, state: usize) -> f64 {
        self.probabilities.get(state).copied().unwrap_or(0.0)
    }

    /// Whether no outcome rules a state out.
    pub fn is_possible(&self, state: usize) -> bool {
        self.possible.get(state).copied().unwrap_or(false)
    }

    /// Whether a test has been done.
    pub fn is_done(&self, test: usize) -> bool {
        self.done.get(test).copied().unwrap_or(false)
    }

    /// States that are possible, likeliest first.
    pub fn ranked(&self) -> Vec<(usize, f64)> {
        let mut ranked: Vec<_> = (0..self.probabilities.len())
            .filter(|state| self.is_possible(*state))
            .map(|state| (state, self.probability(state)))
            .collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        ranked
    }
}

/// The outcomes given before, at most the first few, as text.
fn history(before: &[String]) -> String {
    const SHOWN: usize = 6;
    match before {
        [] => String::new(),
        few if few.len() <= SHOWN => format!("once {}, ", few.join(" and ")),
        many => format!(
            "once {} and {} more are as given, ",
            many[..SHOWN].join(", "),
            many.len() - SHOWN
        ),
    }
}
