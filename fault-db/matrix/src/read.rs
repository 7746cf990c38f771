//! Matrices from JSON and CSV, outcomes from JSON.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::{Deserializer, Error as _, MapAccess, Visitor};
use serde_json::Value;

use super::error::MatrixError;
use super::model::{Matrix, State, Test, check_size};
use super::posterior::Outcome;

#[derive(Deserialize)]
struct MatrixFile<'a> {
    states: Vec<State>,
    tests: Vec<TestEntry>,
    #[serde(borrow)]
    outcomes: Pairs<'a, Pairs<'a, Cell>>,
}

#[derive(Deserialize)]
struct TestEntry {
    id: String,
    cost: f64,
    #[serde(default)]
    outcomes: Vec<String>,
}

/// A cell: the probability that a test fails, or the word of its outcome.
enum Cell {
    Number(f64),
    Word(String),
}

// An untagged enum does not read the numbers of any length that another crate of the program asks of serde_json.
impl<'de> Deserialize<'de> for Cell {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let wrong = || D::Error::custom("a number is expected, or the word of an outcome");
        match Value::deserialize(deserializer)? {
            Value::Number(number) => number.as_f64().map(Self::Number).ok_or_else(wrong),
            Value::String(word) => Ok(Self::Word(word)),
            _ => Err(wrong()),
        }
    }
}

impl Matrix {
    /// Reads `{"states":[{"id","p"}], "tests":[{"id","cost"}], "outcomes":{TEST:{STATE:p}}}`. A test with
    /// `"outcomes":["ok","low","high"]` has one of these words in each state. A missing cell is 0, or the first word;
    /// other keys are ignored.
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
        let words: Vec<_> = (file.tests.iter())
            .map(|test| test.outcomes.clone())
            .collect();
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
                let value = match value {
                    Cell::Number(number) if words[column].is_empty() => *number,
                    Cell::Number(number) => placed(&test.0, &number.to_string(), &words[column])?,
                    Cell::Word(word) => placed(&test.0, word, &words[column])?,
                };
                if cells[line * tests + column].replace(value).is_some() {
                    return Err(MatrixError::CellTwice {
                        test: test.0.to_string(),
                        state: state.0.to_string(),
                    });
                }
            }
        }
        let tests = file.tests.into_iter().map(|entry| Test {
            id: entry.id,
            cost: entry.cost,
        });
        Self::worded(
            file.states,
            tests.collect(),
            cells.into_iter().map(|cell| cell.unwrap_or(0.0)).collect(),
            words,
        )
    }

    /// Reads a table with a line for each state: its name, its probability if a column is called `p` (else all are
    /// equal), and a cell for each test. A line called `cost` has the tests' costs (else 1). A test whose cells are
    /// words, or whole numbers above 1, has these as outcomes, in the order in which they appear.
    ///
    /// # Errors
    /// As [`Matrix::new`]; and lines of another length than the first, cells that are neither.
    pub fn from_csv(text: &str) -> Result<Self, MatrixError> {
        let first = text.lines().next().unwrap_or_default();
        let separator = [b',', b';', b'\t']
            .into_iter()
            .max_by_key(|separator| first.bytes().filter(|byte| byte == separator).count());
        let separator = separator.unwrap_or(b',');
        let mut table = csv::ReaderBuilder::new();
        table.has_headers(false).delimiter(separator);
        let mut table = (table.trim(csv::Trim::All)).from_reader(text.as_bytes());
        let mut lines = Vec::new();
        for line in table.records() {
            let line = line.map_err(|error| {
                let at = error.position().map_or(1, csv::Position::line);
                MatrixError::table(at, "it has another number of cells than the headings")
            })?;
            let (at, byte) = line.position().map_or((1, 0), |at| (at.line(), at.byte()));
            // Empty lines before this line are skipped, but counted.
            let ahead = text.as_bytes().iter().skip(byte as usize);
            let ends = ahead.take_while(|byte| matches!(byte, b'\r' | b'\n'));
            let empty = ends.filter(|byte| **byte == b'\n').count() as u64;
            lines.push((at + empty, line));
        }
        let mut lines = lines.into_iter();
        let (_, headings) = lines.next().ok_or(MatrixError::NoStates)?;
        let number = |(at, line): &(u64, csv::StringRecord), column: usize| {
            let cell = line.get(column).unwrap_or_default();
            let with_point = cell.replacen(',', ".", 1);
            let what = format!("\"{cell}\" ({}) is no number", &headings[column]);
            (with_point.parse()).map_err(|_| MatrixError::table(*at, &what))
        };
        let p = headings.iter().position(|heading| heading == "p");
        let columns: Vec<_> = (1..headings.len())
            .filter(|place| Some(*place) != p)
            .collect();
        let (costs, lines): (Vec<_>, Vec<_>) = lines.partition(|(_, line)| &line[0] == "cost");
        check_size(lines.len(), columns.len())?;
        let tests = columns.iter().map(|column| {
            let cost = costs
                .first()
                .map_or(Ok(1.0), |line| number(line, *column))?;
            let id = headings[*column].to_owned();
            Ok(Test { id, cost })
        });
        let tests = tests.collect::<Result<Vec<_>, MatrixError>>()?;
        let states = lines.iter().map(|line| {
            let id = line.1[0].to_owned();
            let alike = Ok(1.0 / lines.len() as f64);
            let probability = p.map_or(alike, |p| number(line, p))?;
            Ok(State { id, probability })
        });
        let states = states.collect::<Result<Vec<_>, MatrixError>>()?;
        let mut words = vec![Vec::new(); tests.len()];
        let mut cells = vec![0.0; states.len() * tests.len()];
        for (test, column) in columns.iter().enumerate() {
            let is_share = |line: &(u64, csv::StringRecord)| {
                let share = number(line, *column).is_ok_and(|n: f64| (0.0..=1.0).contains(&n));
                share || line.1[*column].is_empty()
            };
            let has_words = !lines.iter().all(is_share);
            for (state, line) in lines.iter().enumerate() {
                let cell = &line.1[*column];
                let parsed = number(line, *column);
                let is_outcome = parsed
                    .as_ref()
                    .map_or(!cell.is_empty(), |n| n.fract() == 0.0);
                cells[state * tests.len() + test] = match has_words {
                    false if cell.is_empty() => 0.0,
                    false => parsed?,
                    true if !is_outcome => {
                        let of = &headings[*column];
                        let what = format!("\"{cell}\" ({of}) is neither 0 to 1 nor an outcome");
                        return Err(MatrixError::table(line.0, &what));
                    }
                    true => {
                        let known: &mut Vec<String> = &mut words[test];
                        let place = known.iter().position(|word| word == cell);
                        place.unwrap_or_else(|| {
                            known.push(cell.to_owned());
                            known.len() - 1
                        }) as f64
                    }
                };
            }
        }
        Self::worded(states, tests, cells, words)
    }
}

/// The index of an outcome among the words of its test.
fn placed(test: &str, word: &str, words: &[String]) -> Result<f64, MatrixError> {
    let place = Outcome::parse(word).place(words);
    let place = place.ok_or_else(|| MatrixError::no_outcome(test, word, words))?;
    Ok(place as f64)
}

/// Reads outcomes that were found: `{TEST: 0 | 1 | "pass" | "fail" | WORD}`, in the order of the file.
///
/// # Errors
/// No JSON of this shape. Whether tests and words are known is seen when they are used.
pub fn read_outcomes(text: &str) -> Result<Vec<(String, Outcome)>, MatrixError> {
    let pairs: Pairs<'_, Value> = serde_json::from_str(text)?;
    let outcome = |(test, value): (Name<'_>, Value)| {
        let word = match &value {
            Value::String(word) => word.clone(),
            other => other.to_string(),
        };
        match value.is_string() || value.is_u64() {
            true => Ok((test.0.into_owned(), Outcome::parse(&word))),
            false => Err(MatrixError::no_outcome(&test.0, &word, &[])),
        }
    };
    pairs.0.into_iter().map(outcome).collect()
}

fn index<'a>(ids: impl Iterator<Item = &'a str>) -> BTreeMap<&'a str, usize> {
    ids.enumerate().map(|(i, id)| (id, i)).collect()
}

/// A JSON object as a list, so that a key that occurs twice is noticed.
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

/// A name, borrowed from the text unless it has escapes: a large matrix has millions.
#[derive(Deserialize)]
struct Name<'a>(#[serde(borrow)] Cow<'a, str>);
