//! Matrices and outcomes from JSON.

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};

use super::error::MatrixError;
use super::model::{Matrix, State, Test, check_size};
use super::posterior::Outcome;

#[derive(Deserialize)]
struct MatrixFile<'a> {
    states: Vec<StateEntry>,
    tests: Vec<TestEntry>,
    #[serde(borrow)]
    outcomes: Pairs<'a, Pairs<'a, f64>>,
}

#[derive(Deserialize)]
struct StateEntry {
    id: String,
    p: f64,
}

#[derive(Deserialize)]
struct TestEntry {
    id: String,
    cost: f64,
}

impl Matrix {
    /// Reads `{"states":[{"id","p"}], "tests":[{"id","cost"}], "outcomes":{TEST:{STATE:p}}}`. A cell
    /// that is not there is 0; other keys are let be.
    ///
    /// # Errors
    /// As [`Matrix::new`]; and no JSON, keys that are missing or doubled, names that are not known.
    pub fn from_json(text: &str) -> Result<Self, MatrixError> {
        let file: MatrixFile<'_> = serde_json::from_str(text)?;
        check_size(file.states.len(), file.tests.len())?;
        let state_index = index(file.states.iter().map(|state| state.id.as_str()));
        let test_index = index(file.tests.iter().map(|test| test.id.as_str()));
        let tests = file.tests.len();
        let mut cells: Vec<Option<f64>> = vec![None; file.states.len() * tests];
        let mut seen = vec![false; tests];
        for (test, row) in &file.outcomes.0 {
            let Some(&column) = test_index.get(test.0.as_ref()) else {
                return Err(MatrixError::UnknownTest {
                    test: test.0.to_string(),
                });
            };
            if std::mem::replace(&mut seen[column], true) {
                return Err(MatrixError::TestTwice {
                    test: test.0.to_string(),
                });
            }
            for (state, value) in &row.0 {
                let Some(line) = state_index.get(state.0.as_ref()) else {
                    return Err(MatrixError::UnknownState {
                        test: test.0.to_string(),
                        state: state.0.to_string(),
                    });
                };
                if cells[line * tests + column].replace(*value).is_some() {
                    return Err(MatrixError::CellTwice {
                        test: test.0.to_string(),
                        state: state.0.to_string(),
                    });
                }
            }
        }
        let states = file.states.into_iter().map(|entry| State {
            id: entry.id,
            probability: entry.p,
        });
        let tests = file.tests.into_iter().map(|entry| Test {
            id: entry.id,
            cost: entry.cost,
        });
        Self::new(
            states.collect(),
            tests.collect(),
            cells.into_iter().map(|cell| cell.unwrap_or(0.0)).collect(),
        )
    }
}

/// Reads outcomes that were found: `{TEST: 0 | 1 | "pass" | "fail"}`, in the order of the file.
///
/// # Errors
/// No JSON of this shape, or another word. Whether the tests are known is seen when they are used.
pub fn read_outcomes(text: &str) -> Result<Vec<(String, Outcome)>, MatrixError> {
    let pairs: Pairs<'_, serde_json::Value> = serde_json::from_str(text)?;
    let outcome = |(test, value): (Name<'_>, serde_json::Value)| {
        let word = match &value {
            serde_json::Value::String(word) => word.clone(),
            other => other.to_string(),
        };
        match Outcome::parse(&word) {
            Some(outcome) => Ok((test.0.into_owned(), outcome)),
            None => Err(MatrixError::OutcomeWord {
                test: test.0.into_owned(),
                found: value.to_string(),
            }),
        }
    };
    pairs.0.into_iter().map(outcome).collect()
}

fn index<'a>(ids: impl Iterator<Item = &'a str>) -> BTreeMap<&'a str, usize> {
    ids.enumerate().map(|(i, id)| (id, i)).collect()
}

/// An object as a list, so that a key that is there twice is seen.
struct Pairs<'a, V>(Vec<(Name<'a>, V)>);

impl<'de: 'a, 'a, V: Deserialize<'de>> Deserialize<'de> for Pairs<'a, V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Read<'a, V>(PhantomData<(&'a (), V)>);
        impl<'de: 'a, 'a, V: Deserialize<'de>> Visitor<'de> for Read<'a, V> {
            type Value = Pairs<'a, V>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(Pairs(pairs))
            }
        }
        deserializer.deserialize_map(Read(PhantomData))
    }
}

/// A name that stays where it is in the text unless it has escapes: a large matrix has millions.
struct Name<'a>(std::borrow::Cow<'a, str>);

impl<'de: 'a, 'a> Deserialize<'de> for Name<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Read;
        impl<'de> Visitor<'de> for Read {
            type Value = Name<'de>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a name")
            }

            fn visit_borrowed_str<E>(self, text: &'de str) -> Result<Name<'de>, E> {
                Ok(Name(text.into()))
            }

            fn visit_str<E>(self, text: &str) -> Result<Name<'de>, E> {
                Ok(Name(text.to_owned().into()))
            }
        }
        deserializer.deserialize_str(Read)
    }
}
