//! A dependency matrix that has been checked.

use std::collections::BTreeSet;

use serde::Deserialize;

use super::error::MatrixError;

/// Allowed difference of the sum of probabilities from 1, for each state: they come rounded.
const SUM_TOLERANCE: f64 = 1e-6;

/// Greatest number of cells: 400 MB.
const MAX_CELLS: usize = 50_000_000;

/// A condition that the system may be in.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct State {
    pub id: String,
    /// Probability before any test, 0..1.
    #[serde(rename = "p")]
    pub probability: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Test {
    pub id: String,
    /// Cost of doing the test once, above 0, in any unit.
    pub cost: f64,
}

/// States, tests, and the probability that each test fails in each state.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    states: Vec<State>,
    tests: Vec<Test>,
    /// One row of tests for each state.
    cells: Vec<f64>,
    /// For each test, its outcomes if these are words instead of pass and fail; a cell is then the index of a word.
    words: Vec<Vec<String>>,
    crisp: bool,
}

impl Matrix {
    /// Its tests, in the order given.
    pub fn tests(&self) -> &[Test] {
        &self.tests
    }

    /// Its states, in the order given.
    pub fn states(&self) -> &[State] {
        &self.states
    }

    /// Checks a matrix; `cells` has a row of all tests for each state.
    ///
    /// # Errors
    /// Names that are empty or occur twice, probabilities or costs out of range, probabilities whose sum is not 1,
    /// cells out of range or of the wrong number.
    pub fn new(states: Vec<State>, tests: Vec<Test>, cells: Vec<f64>) -> Result<Self, MatrixError> {
        let words = vec![Vec::new(); tests.len()];
        Self::worded(states, tests, cells, words)
    }

    /// As [`Matrix::new`], with words for the outcomes of some tests. A cell of such a test is the place of a word.
    pub(super) fn worded(
        states: Vec<State>,
        tests: Vec<Test>,
        cells: Vec<f64>,
        words: Vec<Vec<String>>,
    ) -> Result<Self, MatrixError> {
        check_size(states.len(), tests.len())?;
        check_ids("state", states.iter().map(|state| state.id.as_str()))?;
        check_ids("test", tests.iter().map(|test| test.id.as_str()))?;
        check_probabilities(&states)?;
        if let Some(test) = tests
            .iter()
            .find(|test| !(test.cost > 0.0 && test.cost.is_finite()))
        {
            return Err(MatrixError::Cost {
                test: test.id.clone(),
                cost: test.cost,
            });
        }
        if cells.len() != states.len() * tests.len() {
            return Err(MatrixError::CellCount {
                found: cells.len(),
                states: states.len(),
                tests: tests.len(),
            });
        }
        for (state, row) in states.iter().zip(cells.chunks(tests.len())) {
            for ((test, value), words) in tests.iter().zip(row).zip(&words) {
                if words.is_empty() && !(0.0..=1.0).contains(value) {
                    return Err(MatrixError::Cell {
                        test: test.id.clone(),
                        state: state.id.clone(),
                        value: *value,
                    });
                }
            }
        }
        let crisp = cells.iter().all(|cell| cell.fract() == 0.0);
        Ok(Self {
            states,
            tests,
            cells,
            words,
            crisp,
        })
    }

    /// Probabilities that each test fails in a state; empty for a state that is not there.
    pub fn row(&self, state: usize) -> &[f64] {
        self.cells
            .chunks(self.tests.len())
            .nth(state)
            .unwrap_or(&[])
    }

    /// Outcomes of a test that has words for them; empty for a test that passes or fails.
    pub fn words(&self, test: usize) -> &[String] {
        self.words.get(test).map_or(&[], Vec::as_slice)
    }

    pub(super) fn outcomes(&self, test: usize) -> usize {
        self.words(test).len().max(2)
    }

    /// The word for an outcome of a test.
    pub fn outcome(&self, test: usize, outcome: usize) -> &str {
        let word = self.words(test).get(outcome).map(String::as_str);
        word.unwrap_or(if outcome == 0 { "pass" } else { "fail" })
    }

    /// Probability of an outcome of a test where its cell is `cell`.
    pub(super) fn likelihood(&self, test: usize, outcome: usize, cell: f64) -> f64 {
        match outcome {
            _ if !self.words(test).is_empty() => f64::from(cell == outcome as f64),
            0 => 1.0 - cell,
            _ => cell,
        }
    }

    /// Whether every test has one certain outcome in each state: no cell is between 0 and 1.
    pub fn is_crisp(&self) -> bool {
        self.crisp
    }

    /// Groups of at least two states that no test of the matrix tells apart.
    pub fn ambiguity_groups(&self) -> Vec<Vec<usize>> {
        let mut groups = equal_rows(self, &(0..self.tests.len()).collect::<Vec<_>>(), |_| true);
        groups.retain(|group| group.len() > 1);
        groups
    }
}

/// Groups of the states that `keep` accepts, by equal rows in all of `tests`; in the order of the groups' first states.
pub(super) fn equal_rows(
    matrix: &Matrix,
    tests: &[usize],
    keep: impl Fn(usize) -> bool,
) -> Vec<Vec<usize>> {
    let column = |state: usize| {
        let row = matrix.row(state);
        // Adding 0.0 turns −0 into 0, so that both have the same bits.
        tests
            .iter()
            .map(|test| (row.get(*test).copied().unwrap_or(0.0) + 0.0).to_bits())
    };
    let mut order: Vec<usize> = (0..matrix.states.len())
        .filter(|state| keep(*state))
        .collect();
    order.sort_by(|a, b| column(*a).cmp(column(*b)).then(a.cmp(b)));
    let mut groups: Vec<Vec<usize>> = order
        .chunk_by(|a, b| column(*a).eq(column(*b)))
        .map(<[usize]>::to_vec)
        .collect();
    groups.sort();
    groups
}

/// Refuses an empty or too large matrix, before memory is allocated for it.
pub(super) fn check_size(states: usize, tests: usize) -> Result<(), MatrixError> {
    if states == 0 {
        return Err(MatrixError::NoStates);
    }
    if tests == 0 {
        return Err(MatrixError::NoTests);
    }
    if states.saturating_mul(tests) > MAX_CELLS {
        return Err(MatrixError::TooManyCells {
            states,
            tests,
            limit: MAX_CELLS,
        });
    }
    Ok(())
}

fn check_ids<'a>(
    kind: &'static str,
    ids: impl Iterator<Item = &'a str>,
) -> Result<(), MatrixError> {
    let mut seen = BTreeSet::new();
    for id in ids {
        if id.is_empty() {
            return Err(MatrixError::EmptyId { kind });
        }
        if !seen.insert(id) {
            return Err(MatrixError::DuplicateId {
                kind,
                id: id.to_owned(),
            });
        }
    }
    Ok(())
}

fn check_probabilities(states: &[State]) -> Result<(), MatrixError> {
    if let Some(state) = states
        .iter()
        .find(|state| !(0.0..=1.0).contains(&state.probability))
    {
        return Err(MatrixError::Probability {
            state: state.id.clone(),
            p: state.probability,
        });
    }
    let sum: f64 = states.iter().map(|state| state.probability).sum();
    if (sum - 1.0).abs() > SUM_TOLERANCE * states.len() as f64 {
        return Err(MatrixError::ProbabilitySum {
            states: states.len(),
            sum,
        });
    }
    Ok(())
}
