//! Texts of scripts and catalogues in Korean: names of steps, measurements, fault modes, signals, reasons of limits.
//!
//! Scripts are written in English; `scripts/korean.toml` beside them has the Korean. A text is looked up with its
//! numbers as `#`, so that `code 25 gives 25 km/h` and the same step of every other code are one entry, unless it
//! has its own. A depot's own `korean.toml` beside its procedures is looked in first. A text that neither file has
//! is shown as written.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::{LazyLock, OnceLock};

use protocol::event::Event;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::{Failure, FileTrouble};
use serde::Deserialize;

/// The file of texts that are built in.
const KOREAN: &str = include_str!("../../../../scripts/korean.toml");
/// Separator of texts that stand in one message and are looked up one by one.
const JOINED: &str = "; ";

static CONTENT: LazyLock<Content> =
    LazyLock::new(|| Content::read(KOREAN).expect("a test reads the file that is built in"));

/// Korean contents of the user and of the depot, those that take precedence first.
static OWN: OnceLock<Vec<Content>> = OnceLock::new();
const FILE: &str = "korean.toml";

/// Takes the Korean texts that lie beside the scripts, for as long as the program runs.
///
/// # Errors
/// A file cannot be read, or is wrong.
pub fn take_own(scripts: &ScriptsDirectory) -> Result<(), Failure> {
    let mut own = Vec::new();
    for (shown, text) in scripts.layers(FILE)? {
        if text != KOREAN {
            let wrong = |error| Failure::usage(FileTrouble::wrong(shown, error));
            own.push(Content::read(&text).map_err(wrong)?);
        }
    }
    OWN.get_or_init(|| own);
    Ok(())
}

fn contents() -> impl Iterator<Item = &'static Content> {
    OWN.get().into_iter().flatten().chain([&*CONTENT])
}

/// The Korean of a text of scripts, catalogues or the runner; the text itself where there is none.
pub(super) fn korean(text: &str) -> Cow<'_, str> {
    said(text).map_or(Cow::Borrowed(text), Cow::Owned)
}

fn said(text: &str) -> Option<String> {
    for name_length in [|_: &str| 0, code_name_length] {
        let (key, numbers) = without(text, name_length);
        let of = |content: &'static Content| content.texts.get(text).or(content.texts.get(&key));
        if let Some(korean) = contents().find_map(of) {
            return Some(with_numbers(korean, &numbers));
        }
    }
    if let Some(event) = Event::from_name(text) {
        return Some(event.definition().text_ko.to_owned());
    }
    if !text.contains(JOINED) {
        return None;
    }
    let parts = text.split(JOINED);
    let said = parts.map(|part| said(part).unwrap_or_else(|| part.to_owned()));
    Some(said.collect::<Vec<_>>().join(JOINED))
}

/// Korean name of a measurement, by the name in its script; `None` where there is none. A number at the end of a
/// name is that of a pair, an input or a speed.
pub(super) fn measurement(name: &str) -> Option<String> {
    let named = |key: &str| contents().find_map(|content| content.measurements.get(key));
    if let Some(korean) = named(name) {
        return Some(korean.clone());
    }
    if let Some(item) = super::KOREAN.bench.self_test_item(name) {
        return Some(item);
    }
    let (key, numbers) = match name.rsplit_once('_') {
        Some((what, number)) if number_length(number) == number.len() => {
            (format!("{what}_#"), vec![number])
        }
        _ => without_numbers(name),
    };
    Some(with_numbers(named(&key)?, &numbers))
}

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct File {
    steps: BTreeMap<String, String>,
    /// Apart from the other texts: `released` is the name of a measurement, and a state, too.
    measurements: BTreeMap<String, String>,
    modes: BTreeMap<String, String>,
    signals: BTreeMap<String, String>,
    reasons: BTreeMap<String, String>,
    phrases: BTreeMap<String, String>,
}

struct Content {
    texts: BTreeMap<String, String>,
    measurements: BTreeMap<String, String>,
}

impl Content {
    fn read(text: &str) -> Result<Self, toml::de::Error> {
        let file: File = toml::from_str(text)?;
        let parts = [
            file.steps,
            file.modes,
            file.signals,
            file.reasons,
            file.phrases,
        ];
        Ok(Self {
            texts: parts.into_iter().flatten().collect(),
            measurements: file.measurements,
        })
    }
}

/// The text with each number that stands alone as `#`, and the numbers.
fn without_numbers(text: &str) -> (String, Vec<&str>) {
    without(text, |_| 0)
}

/// Length of the name of a code at the beginning of the text, as `L5`: letters and digits that begin with a capital
/// or a digit.
fn code_name_length(text: &str) -> usize {
    let name = text.split([' ', ',', ':']).next().unwrap_or_default();
    let is_name = name.starts_with(|c: char| c.is_ascii_uppercase() || c.is_ascii_digit())
        && name.chars().all(|c| c.is_ascii_alphanumeric());
    if is_name { name.len() } else { 0 }
}

/// The text with each number that stands alone, and what `name_length` takes for the name of a code, as `#`.
fn without(text: &str, name_length: fn(&str) -> usize) -> (String, Vec<&str>) {
    let (mut key, mut numbers) = (String::with_capacity(text.len()), Vec::new());
    let mut rest = text;
    let mut before = ' ';
    while let Some(next) = rest.chars().next() {
        let alone = !(before.is_alphanumeric() || before == '_' || before == '.');
        let length = match number_length(rest) {
            _ if !alone => 0,
            0 if key.ends_with("code ") => name_length(rest),
            length => length,
        };
        if length == 0 {
            key.push(next);
            before = next;
            rest = &rest[next.len_utf8()..];
        } else {
            key.push('#');
            before = '#';
            numbers.push(&rest[..length]);
            rest = &rest[length..];
        }
    }
    (key, numbers)
}

/// Length of the number at the beginning of the text; 0 without one, or where a letter follows it.
fn number_length(text: &str) -> usize {
    let digits =
        |text: &str| text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let whole = digits(text);
    let fraction = text[whole..].strip_prefix('.').map_or(0, digits);
    let length = match (whole, fraction) {
        (0, _) => 0,
        (_, 0) => whole,
        _ => whole + 1 + fraction,
    };
    let follows = text[length..].chars().next();
    match follows.is_some_and(|c| c.is_ascii_alphanumeric() || c == '_') {
        true => 0,
        false => length,
    }
}

/// The wording with the numbers in its places: `#` is the next one, `#2` the second.
fn with_numbers(wording: &str, numbers: &[&str]) -> String {
    let mut said = String::with_capacity(wording.len());
    let mut parts = wording.split('#');
    said.push_str(parts.next().unwrap_or_default());
    for (next, part) in parts.enumerate() {
        let after = part.trim_start_matches(|c: char| c.is_ascii_digit());
        let named = part[..part.len() - after.len()].parse::<usize>().ok();
        let place = named.map_or(next, |number| number.saturating_sub(1));
        said.push_str(numbers.get(place).copied().unwrap_or("#"));
        said.push_str(after);
    }
    said
}

#[cfg(test)]
mod tests;
