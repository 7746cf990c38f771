//! Reads and writes sequence files (TOML); an error names the line of the file.

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Deserialize;
use toml::{Spanned, Value};

use super::keys::{self, powers};
use super::{Sequence, SequenceError, Step, When};
use crate::drive::Load;

/// Steps a sequence may have.
pub const MAX_STEPS: usize = 1000;
/// Longest time between two steps, s: that of the longest run.
pub const MAX_AFTER_S: f64 = 3600.0;
/// Highest speed a step may wait for, km/h.
const MAX_KMH: f64 = 150.0;
/// Steepest gradient, ‰.
const MAX_PERMILLE: f64 = 50.0;
/// Keys of a step's condition.
const WHEN: [&str; 3] = ["after_s", "at_kmh", "at_standstill"];

#[derive(Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
struct RawFile {
    title: String,
    line: Option<String>,
    section: Option<u16>,
    #[schemars(with = "Option<RawLoad>")]
    load: Option<Spanned<RawLoad>>,
    code: Option<String>,
    #[schemars(with = "Option<f64>")]
    gradient_permille: Option<Spanned<f64>>,
    #[schemars(with = "Option<f64>")]
    end_after_s: Option<Spanned<f64>>,
    #[serde(default)]
    #[schemars(schema_with = "steps")]
    steps: Vec<Spanned<RawStep>>,
}

#[derive(Deserialize, schemars::JsonSchema)]
#[serde(untagged)]
enum RawLoad {
    Kg(f64),
    Name(String),
}

/// Keys of a step.
type RawStep = BTreeMap<String, Spanned<Value>>;

/// What a file of a sequence looks like.
pub fn file_schema() -> schemars::Schema {
    schemars::SchemaGenerator::default().into_root_schema_for::<RawFile>()
}

/// What a schema says of steps: their keys are those of the commands, which are checked when they are read.
fn steps(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    schemars::json_schema!({ "type": "array", "items": { "type": "object" } })
}

/// A text whose places are given as lines.
struct Lines<'a>(&'a str);

impl Lines<'_> {
    /// Line of a byte, counted from 1.
    fn of(&self, byte: usize) -> usize {
        let before = self.0.as_bytes().iter().take(byte);
        1 + before.filter(|letter| **letter == b'\n').count()
    }

    fn at(&self, byte: usize, message: impl Into<String>) -> SequenceError {
        SequenceError {
            line: self.of(byte),
            message: message.into(),
        }
    }

    fn in_range(
        &self,
        key: &str,
        value: &Spanned<f64>,
        (low, high): (f64, f64),
    ) -> Result<f64, SequenceError> {
        let number = *value.get_ref();
        if (low..=high).contains(&number) {
            return Ok(number);
        }
        let message = format!("{key} = {number} is outside {low} .. {high}");
        Err(self.at(value.span().start, message))
    }
}

impl Sequence {
    /// Reads and checks a sequence file.
    ///
    /// # Errors
    /// The first thing wrong, with its line.
    pub fn from_toml(text: &str) -> Result<Self, SequenceError> {
        let lines = Lines(text);
        let raw: RawFile = toml::from_str(text).map_err(|error| {
            let byte = error.span().map_or(0, |span| span.start);
            lines.at(byte, error.message())
        })?;
        let number = |key, value: &Option<Spanned<f64>>, range| {
            let value = value.as_ref();
            let checked = value.map(|value| lines.in_range(key, value, range));
            checked.transpose()
        };
        let gradients = (-MAX_PERMILLE, MAX_PERMILLE);
        let gradient_permille = number("gradient_permille", &raw.gradient_permille, gradients)?;
        let gradient_permille = gradient_permille.unwrap_or(0.0);
        let end_after_s = number("end_after_s", &raw.end_after_s, (0.0, MAX_AFTER_S))?;
        let load = raw.load.map_or(Ok(Load::Empty), |raw| load(raw, &lines))?;
        let end = text.len();
        match raw.steps.len() {
            0 => return Err(lines.at(end, "no [[steps]]: nothing is done")),
            count if count > MAX_STEPS => {
                return Err(lines.at(end, format!("more than {MAX_STEPS} steps")));
            }
            _ => {}
        }
        let steps = raw.steps.into_iter().map(|raw| step(raw, &lines));
        let steps: Vec<_> = steps.collect::<Result<_, _>>()?;
        // On a gradient a train may roll off by itself.
        if gradient_permille == 0.0 {
            in_order(&steps)?;
        }
        Ok(Self {
            title: raw.title,
            line: raw.line,
            section: raw.section,
            load,
            code: raw.code,
            gradient_permille,
            steps,
            end_after_s,
        })
    }

    /// As a file, which [`Sequence::from_toml`] takes back.
    pub fn to_toml(&self) -> String {
        let mut text = format!("title = {}\n", quoted(&self.title));
        // Writing to a text cannot fail.
        if let Some(line) = &self.line {
            let _ = writeln!(text, "line = {}", quoted(line));
        }
        if let Some(section) = self.section {
            let _ = writeln!(text, "section = {section}");
        }
        let _ = match self.load {
            Load::Empty => writeln!(text, "load = \"empty\""),
            Load::Full => writeln!(text, "load = \"full\""),
            Load::Passengers(kg) => writeln!(text, "load = {kg:?}"),
        };
        if let Some(code) = &self.code {
            let _ = writeln!(text, "code = {}", quoted(code));
        }
        let _ = writeln!(text, "gradient_permille = {:?}", self.gradient_permille);
        if let Some(end_after_s) = self.end_after_s {
            let _ = writeln!(text, "end_after_s = {end_after_s:?}");
        }
        for step in &self.steps {
            let when = match step.when {
                When::After(seconds) => format!("after_s = {seconds:?}"),
                When::AtKmh(kmh) => format!("at_kmh = {kmh:?}"),
                When::AtStandstill => "at_standstill = true".into(),
            };
            let _ = writeln!(text, "\n[[steps]]\n{when}");
            for line in step.actions.iter().filter_map(keys::toml) {
                let _ = writeln!(text, "{line}");
            }
        }
        text
    }
}

fn load(raw: Spanned<RawLoad>, lines: &Lines<'_>) -> Result<Load, SequenceError> {
    let at = raw.span().start;
    let asked = match raw.into_inner() {
        RawLoad::Kg(kg) if kg.is_finite() && kg >= 0.0 => return Ok(Load::Passengers(kg)),
        RawLoad::Name(name) if name == "empty" => return Ok(Load::Empty),
        RawLoad::Name(name) if name == "full" => return Ok(Load::Full),
        RawLoad::Kg(kg) => kg.to_string(),
        RawLoad::Name(name) => name,
    };
    let message = format!("no load \"{asked}\": use a mass in kg, \"empty\" or \"full\"");
    Err(lines.at(at, message))
}

fn step(raw: Spanned<RawStep>, lines: &Lines<'_>) -> Result<Step, SequenceError> {
    let at = raw.span().start;
    let mut raw = raw.into_inner();
    let when = when(&mut raw, lines, at)?;
    let mut actions = Vec::new();
    for name in keys::names() {
        if let Some(value) = raw.remove(name) {
            let action = keys::stimulus(name, value.get_ref());
            actions.push(action.map_err(|wrong| lines.at(value.span().start, wrong))?);
        }
    }
    if let Some((name, value)) = raw.first_key_value() {
        let known = WHEN.into_iter().chain(keys::names());
        let known: Vec<_> = known.map(|name| format!("`{name}`")).collect();
        let known = known.join(", ");
        let message = format!("unknown field `{name}`, expected one of {known}");
        return Err(lines.at(value.span().start, message));
    }
    if actions.is_empty() {
        let message = "the step does nothing: give it a lever, a switch or a cut-out";
        return Err(lines.at(at, message));
    }
    Ok(Step {
        line: lines.of(at),
        when,
        actions,
    })
}

/// Takes a step's condition from its keys.
fn when(raw: &mut RawStep, lines: &Lines<'_>, at: usize) -> Result<When, SequenceError> {
    let given = WHEN.map(|name| Some((name, raw.remove(name)?)));
    let given: Vec<_> = given.into_iter().flatten().collect();
    let (name, value) = match &given[..] {
        [] => {
            let message =
                "the step says not when: give it one of after_s, at_kmh and at_standstill";
            return Err(lines.at(at, message));
        }
        [one] => one,
        several => {
            let names: Vec<_> = several.iter().map(|(name, _)| *name).collect();
            let names = names.join(" and ");
            return Err(lines.at(at, format!("the step says when twice: {names}; keep one")));
        }
    };
    let begin = value.span().start;
    let wrong = |message| lines.at(begin, message);
    let number = |range| {
        let number = keys::of::<f64>(value.get_ref()).map_err(wrong)?;
        lines.in_range(name, &Spanned::new(value.span(), number), range)
    };
    match *name {
        "after_s" => number((0.0, MAX_AFTER_S)).map(When::After),
        "at_kmh" => number((0.1, MAX_KMH)).map(When::AtKmh),
        _ if keys::of::<bool>(value.get_ref()).map_err(wrong)? => Ok(When::AtStandstill),
        _ => {
            let message = "at_standstill can only be true: leave it out to wait for something else";
            Err(lines.at(begin, message))
        }
    }
}

/// A step that waits for motion comes after one that powers.
fn in_order(steps: &[Step]) -> Result<(), SequenceError> {
    for step in steps {
        if !matches!(step.when, When::After(_)) {
            return Err(SequenceError {
                line: step.line,
                message: format!(
                    "the step waits for {}, but no step before it powers: the train stands",
                    step.when
                ),
            });
        }
        if step.actions.iter().any(powers) {
            return Ok(());
        }
    }
    Ok(())
}

/// A text as a basic string of TOML.
fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            letter if letter.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", letter as u32);
            }
            letter => quoted.push(letter),
        }
    }
    quoted.push('"');
    quoted
}
