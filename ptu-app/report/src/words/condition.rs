//! Conditions in messages in Korean: `eb = applied` with the names of the signal and of its state.

use btu_rig::procedure::describe::bit_names;
use protocol::signal::{Kind, Signal};

use super::{KOREAN, content};

/// Bits of a signal at most.
const BITS: u16 = 16;

/// A condition as a plan writes it; `None` for what is none.
pub(super) fn korean(text: &str) -> Option<String> {
    let group = text
        .strip_prefix('(')
        .and_then(|text| text.strip_suffix(')'));
    group.map_or_else(|| comparison(text), of_group)
}

/// What a step waits for.
pub(super) fn expectation(text: &str) -> Option<String> {
    if let Some((condition, time)) = text.rsplit_once(" within ") {
        return Some(format!("{time} 이내 {}", korean(condition)?));
    }
    let (condition, time) = text.rsplit_once(" held for ")?;
    Some(format!("{time} 동안 {}", korean(condition)?))
}

/// What a signal is called in few words.
pub(super) fn signal(name: &str) -> Option<String> {
    let said = content::korean(Signal::from_name(name)?.definition().doc);
    let ends = [": ", ", ", " ("].iter().filter_map(|end| said.find(end));
    let end = ends.min().unwrap_or(said.len());
    Some(said[..end].to_owned())
}

/// A state of a signal, or its bits.
pub(super) fn state(name: &str, label: &str) -> Option<String> {
    Some(value(Signal::from_name(name)?, label))
}

fn of_group(inside: &str) -> Option<String> {
    [(" and ", " 그리고 "), (" or ", " 또는 ")]
        .iter()
        .find_map(|(word, said)| {
            let parts = at_top(inside, word);
            let is_joined = parts.len() > 1;
            let parts = parts.into_iter().map(korean).collect::<Option<Vec<_>>>();
            let parts = parts.filter(|_| is_joined)?;
            Some(format!("({})", parts.join(said)))
        })
}

/// The parts between `word`, but where it stands within brackets.
fn at_top<'a>(text: &'a str, word: &str) -> Vec<&'a str> {
    let mut parts = Vec::new();
    let mut from = 0;
    for (at, _) in text.match_indices(word) {
        let before = &text[from..at];
        if before.matches('(').count() == before.matches(')').count() {
            parts.push(before);
            from = at + word.len();
        }
    }
    parts.push(&text[from..]);
    parts
}

fn comparison(text: &str) -> Option<String> {
    let (name, rest) = text.split_once(' ')?;
    let (sign, operand) = rest.split_once(' ')?;
    let said = signal(name)?;
    let operand = value(Signal::from_name(name)?, operand);
    match sign {
        "=" | "≠" | "<" | "≤" | ">" | "≥" | "≈" => Some(format!("{said} {sign} {operand}")),
        "with" => Some(format!("{said}: {operand} 있음")),
        "without" => Some(format!("{said}: {operand} 없음")),
        _ => None,
    }
}

/// A state, bits by their names, or a number as it is.
fn value(signal: Signal, operand: &str) -> String {
    let bench = &KOREAN.bench;
    let said = match signal.definition().kind {
        Kind::Enum(labels) => {
            let state = labels.iter().position(|label| *label == operand);
            state.and_then(|state| bench.states(signal).get(state).copied())
        }
        Kind::Bit => match operand {
            "on" => Some(bench.on),
            "off" => Some(bench.off),
            _ => None,
        },
        Kind::Number { .. } => None,
    };
    if let Some(said) = said {
        return said.to_owned();
    }
    let names = bench.bits(signal);
    let bit = |name: &str| {
        let mut bits = 0..BITS;
        let place = bits.find(|bit| bit_names(signal, 1 << bit).as_deref() == Some(name));
        let korean = place.and_then(|bit| names.get(usize::from(bit)));
        korean.map_or_else(|| content::korean(name).into_owned(), |said| (*said).into())
    };
    let bits: Vec<_> = operand.split(" + ").map(bit).collect();
    bits.join(" + ")
}
