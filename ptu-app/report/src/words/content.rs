//! What scripts, catalogues and the runner say, in Korean: names of steps, measurements, fault modes, signals, reasons of limits,
//! messages.
//!
//! They are made and stored in English; `scripts/korean.toml` has the Korean beside the scripts it belongs to. A text is
//! looked up with its numbers as `#`, so that `code 25 gives 25 km/h` and the same step of every other code are one entry. A message is a
//! pattern, `{name} = {value}, allowed {limits}`; what a place stands for is looked up in the same way. What is in neither,
//! as a name that a depot gave its own step, is shown as it was written.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::LazyLock;

use protocol::event::Event;
use serde::Deserialize;

use super::names;
use super::say::condition;

/// The texts that are built in, as their file has them.
const KOREAN: &str = include_str!("../../../../scripts/korean.toml");
/// Between texts that were found together.
const JOINED: &str = "; ";
/// Texts within texts go no deeper.
const DEEPEST: usize = 5;

static CONTENT: LazyLock<Content> =
    LazyLock::new(|| Content::read(KOREAN).expect("a test reads the file that is built in"));

/// The Korean of a text of scripts, catalogues or the runner; the text itself where there is none.
pub(super) fn korean(text: &str) -> Cow<'_, str> {
    CONTENT
        .say(text, DEEPEST)
        .map_or(Cow::Borrowed(text), Cow::Owned)
}

/// What a measurement is called in Korean, by the name that its script gives it; `None` where there is none.
pub(super) fn measurement(name: &str) -> Option<String> {
    CONTENT.measurement(name)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    steps: BTreeMap<String, String>,
    /// Apart from the others: `released` is a state, too.
    measurements: BTreeMap<String, String>,
    modes: BTreeMap<String, String>,
    signals: BTreeMap<String, String>,
    reasons: BTreeMap<String, String>,
    phrases: BTreeMap<String, String>,
    /// In the order in which they are tried.
    messages: Vec<[String; 2]>,
}

struct Content {
    texts: BTreeMap<String, String>,
    measurements: BTreeMap<String, String>,
    patterns: Vec<Pattern>,
}

/// A message with places for what differs.
pub(super) struct Pattern {
    /// What stands before, between and after the places; one more than there are places.
    between: Vec<String>,
    pub(super) places: Vec<String>,
    pub(super) korean: String,
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
            patterns: (file.messages.into_iter())
                .map(|[english, korean]| Pattern::new(&english, korean))
                .collect(),
        })
    }

    fn say(&self, text: &str, deepest: usize) -> Option<String> {
        let (key, numbers) = without_numbers(text);
        if let Some(korean) = self.texts.get(&key) {
            return Some(with_numbers(korean, &numbers));
        }
        if let Some(event) = Event::from_name(text) {
            return Some(event.definition().text_ko.to_owned());
        }
        let deeper = deepest.checked_sub(1)?;
        let or_same = |part: &str| self.say(part, deeper).unwrap_or_else(|| part.to_owned());
        if text.contains(JOINED) {
            let parts: Vec<_> = text.split(JOINED).map(or_same).collect();
            return Some(parts.join(JOINED));
        }
        let known = |part: &str| self.texts.contains_key(&without_numbers(part).0);
        // Names of steps have commas and colons of their own: a pattern that finds one whole is the right one.
        let mut fits = None;
        for pattern in &self.patterns {
            let Some(found) = pattern.places_in(text, known) else {
                continue;
            };
            let mut in_places = pattern.places.iter().zip(&found);
            if in_places
                .any(|(place, part)| known(part) || self.measurement_in(place, part).is_some())
            {
                fits = Some((pattern, found));
                break;
            }
            fits.get_or_insert((pattern, found));
        }
        let (pattern, found) = fits?;
        let mut said = pattern.korean.clone();
        for (place, part) in pattern.places.iter().zip(found) {
            let named = self.measurement_in(place, part);
            let named = named.or_else(|| in_place(place, part, &or_same));
            let part = named.unwrap_or_else(|| or_same(part));
            said = said.replace(&format!("{{{place}}}"), &part);
        }
        Some(said)
    }

    /// A number at the end of a name is that of a pair, an input or a speed.
    fn measurement(&self, name: &str) -> Option<String> {
        if let Some(korean) = self.measurements.get(name) {
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
        let korean = self.measurements.get(&key)?;
        Some(with_numbers(korean, &numbers))
    }

    fn measurement_in(&self, place: &str, part: &str) -> Option<String> {
        (place == "measurement").then(|| self.measurement(part))?
    }
}

/// What stands in a place that says what kind of thing it is; `or_same` says what is no name.
fn in_place(place: &str, part: &str, or_same: &dyn Fn(&str) -> String) -> Option<String> {
    match place {
        "signal" => condition::signal(part),
        "mode" => condition::state("mode", part),
        "event" => {
            let (name, rest) = part.split_at(part.find(' ').unwrap_or(part.len()));
            let event = Event::from_name(name)?.definition();
            let inside = rest.strip_prefix(" (").map(|rest| rest.strip_suffix(')'));
            let rest = match inside {
                None if rest.is_empty() => String::new(),
                None => return None,
                Some(inside) => match inside?.split_once(", ") {
                    Some((code, parameter)) => format!(" ({code}, {})", or_same(parameter)),
                    None => rest.to_owned(),
                },
            };
            Some(format!("{}{rest}", event.text_ko))
        }
        "happened" => {
            let mut all = Event::ALL.iter().map(|event| event.definition());
            let event = all.find(|event| event.text == part)?;
            Some(event.text_ko.to_owned())
        }
        "fault" => {
            let event = Event::from_name(part).map(|event| event.definition().text_ko.to_owned());
            Some(event.unwrap_or_else(|| or_same(&part.replace('_', " "))))
        }
        // Behind it there may be more that name a part each.
        "part" => {
            let part_and_fault = |text: &'_ str| match text.split_once(", with ") {
                Some((part, fault)) => (pointed_at(part), Some(fault.to_owned())),
                None => (pointed_at(text), None),
            };
            let mut all = part.split(", which points at ").map(part_and_fault);
            let (mut said, mut fault) = all.next()?;
            for (part, next) in all {
                said += &match fault {
                    Some(fault) => {
                        let fault = in_place("fault", &fault, or_same)?;
                        format!("), {fault} (지목 부품: {part}")
                    }
                    None => format!(", {part}"),
                };
                fault = next;
            }
            Some(said)
        }
        _ => None,
    }
}

/// A part that a fault is a sign of.
fn pointed_at(part: &str) -> String {
    match part.strip_prefix("the ") {
        Some(part) => names::korean_part(part).to_owned(),
        None => "없음".to_owned(),
    }
}

impl Pattern {
    pub(super) fn new(english: &str, korean: String) -> Self {
        let (mut between, mut places) = (Vec::new(), Vec::new());
        let mut rest = english;
        while let Some((before, after)) = rest.split_once('{') {
            let (place, after) = after.split_once('}').unwrap_or((after, ""));
            between.push(before.to_owned());
            places.push(place.to_owned());
            rest = after;
        }
        between.push(rest.to_owned());
        Self {
            between,
            places,
            korean,
        }
    }

    /// What stands in the places of a text of this pattern; `None` for another text, or one that leaves a place empty. A
    /// place ends where what comes after it begins first, or later where it is then a `known` text: names of steps have
    /// colons of their own.
    pub(super) fn places_in<'a>(
        &self,
        text: &'a str,
        known: impl Fn(&str) -> bool,
    ) -> Option<Vec<&'a str>> {
        let (first, between) = self.between.split_first()?;
        let mut rest = text.strip_prefix(first.as_str())?;
        let mut found = Vec::with_capacity(self.places.len());
        for (place, literal) in (1..).zip(between) {
            let end = match place == between.len() {
                true => rest.strip_suffix(literal.as_str())?.len(),
                false => {
                    let mut ends = rest.match_indices(literal.as_str()).map(|(end, _)| end);
                    let of_known = ends.clone().find(|end| known(&rest[..*end]));
                    of_known.or_else(|| ends.next())?
                }
            };
            found.push(rest.get(..end).filter(|part| !part.is_empty())?);
            rest = &rest[end + literal.len()..];
        }
        rest.is_empty().then_some(found)
    }
}

/// The text with each number that stands alone as `#`, and the numbers.
fn without_numbers(text: &str) -> (String, Vec<&str>) {
    let (mut key, mut numbers) = (String::with_capacity(text.len()), Vec::new());
    let mut rest = text;
    let mut before = ' ';
    while let Some(next) = rest.chars().next() {
        let alone = !(before.is_alphanumeric() || before == '_' || before == '.');
        let length = if alone { number_length(rest) } else { 0 };
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

/// How long the number is that the text begins with; 0 without one, or where a letter follows it.
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
