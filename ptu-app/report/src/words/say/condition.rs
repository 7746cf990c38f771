//! Conditions, expectations and states in Korean: `eb = applied` with the names of the signal and of its state.

use btu_rig::procedure::describe::bit_names;
use btu_rig::procedure::plan::{Comparison, Condition, Expectation, Operand};
use btu_rig::procedure::{EventSource, event_text};
use protocol::event::Event;
use protocol::signal::{Kind, Signal};

use super::super::{KOREAN, content};

/// Greatest number of bits of a signal.
const BITS: u16 = 16;

pub fn korean(condition: &Condition) -> String {
    let joined = |parts: &[Condition], word: &str| {
        let parts: Vec<_> = parts.iter().map(korean).collect();
        format!("({})", parts.join(word))
    };
    match condition {
        Condition::All(parts) => joined(parts, " 그리고 "),
        Condition::Any(parts) => joined(parts, " 또는 "),
        Condition::Compare {
            signal: of,
            comparison,
            operand,
        } => {
            let (said, value) = (name(*of), operand_of(*of, operand));
            match comparison {
                Comparison::Has => format!("{said}에 {value} 포함"),
                Comparison::Lacks => format!("{said}에 {value} 미포함"),
                Comparison::Equal => format!("{said} = {value}"),
                Comparison::NotEqual => format!("{said} ≠ {value}"),
                Comparison::Below => format!("{said} < {value}"),
                Comparison::AtMost => format!("{said} ≤ {value}"),
                Comparison::Above => format!("{said} > {value}"),
                Comparison::AtLeast => format!("{said} ≥ {value}"),
                Comparison::Near { tolerance } => format!("{said} ≈ {value} ± {tolerance}"),
            }
        }
    }
}

/// Condition that a step waits for, as text.
pub fn expectation(expected: &Expectation) -> String {
    match expected {
        Expectation::Becomes { condition, within } => {
            format!("{within} 이내 {}", korean(condition))
        }
        Expectation::Holds {
            condition,
            duration,
        } => format!("{duration} 동안 {}", korean(condition)),
        Expectation::Never { condition } => {
            format!("성립해서는 안 되는 조건: {}", korean(condition))
        }
        Expectation::Logs { event, within, .. } => format!(
            "{within} 이내 {} 고장 기록에 {}",
            who(EventSource::of(*event)),
            event.definition().text_ko
        ),
        Expectation::NeverLogs { event } => format!(
            "{} 고장 기록에 없어야 할 항목: {}",
            who(EventSource::of(*event)),
            event.definition().text_ko
        ),
    }
}

pub fn who(source: EventSource) -> &'static str {
    match source {
        EventSource::Unit => "장치",
        EventSource::Tcms => "TCMS",
    }
}

/// An event with the limits of its parameter.
pub fn logged(event: Event, [low, high]: [i32; 2]) -> String {
    let text = event.definition().text_ko;
    match (low, high) {
        (i32::MIN, i32::MAX) => text.to_owned(),
        (low, i32::MAX) => format!("{text} ({low} 이상)"),
        (i32::MIN, high) => format!("{text} ({high} 이하)"),
        (low, high) => format!("{text} ({low} ~ {high})"),
    }
}

/// Parameter of an event as text; empty for an event without one.
pub fn parameter(event: Event, number: i32) -> String {
    if event.definition().parameter.is_empty() {
        return String::new();
    }
    let Some(name) = event_text::named(event, number) else {
        let (what, value) = event_text::measured(event, number);
        return format!("{} {value}", content::korean(what));
    };
    content::korean(&name).into_owned()
}

/// Name of a signal in few words.
pub fn name(signal: Signal) -> String {
    let said = content::korean(signal.definition().doc);
    let ends = [": ", ", ", " ("].iter().filter_map(|end| said.find(end));
    let end = ends.min().unwrap_or(said.len());
    said[..end].to_owned()
}

/// Korean of a state of a signal, or of its bits, by the English label.
pub fn state(of: &str, label: &str) -> Option<String> {
    let signal = Signal::from_name(of)?;
    let operand = match signal.definition().kind {
        Kind::Enum(labels) => labels.iter().position(|known| *known == label)? as f64,
        Kind::Bit => f64::from(label == "on"),
        Kind::Number { .. } if label == "none" => 0.0,
        Kind::Number { .. } => {
            let one = |name: &str| {
                (0..BITS).find(|bit| bit_names(signal, 1 << bit).as_deref() == Some(name))
            };
            let all = label.split(" + ").map(|name| Some(1u16 << one(name)?));
            f64::from(all.sum::<Option<u16>>()?)
        }
    };
    Some(value(signal, operand).unwrap_or_else(|| label.to_owned()))
}

/// A state, bits by their names, or a number with its unit.
fn operand_of(signal: Signal, operand: &Operand) -> String {
    let number = match operand {
        Operand::Literal(literal) => match value(signal, *literal) {
            Some(said) => return said,
            None => operand.to_string(),
        },
        Operand::Measured { name, offset, .. } => {
            let said = content::measurement(name).unwrap_or_else(|| name.clone());
            match *offset {
                0.0 => format!("측정값 \"{said}\""),
                below if below < 0.0 => format!("측정값 \"{said}\" - {}", -below),
                above => format!("측정값 \"{said}\" + {above}"),
            }
        }
    };
    format!("{number} {}", signal.definition().unit)
        .trim_end()
        .to_owned()
}

/// The word for a value of states or bits; `None` for a number.
fn value(signal: Signal, number: f64) -> Option<String> {
    let bench = &KOREAN.bench;
    match signal.definition().kind {
        Kind::Enum(_) => {
            let said = bench.states(signal).get(number as usize).copied();
            said.map(str::to_owned)
        }
        Kind::Bit => Some(if number == 0.0 { bench.off } else { bench.on }.to_owned()),
        Kind::Number { .. } => bits(signal, number as u16),
    }
}

/// The names of the bits that are set; `None` for a signal that is no set of bits.
pub fn bits(signal: Signal, bits: u16) -> Option<String> {
    let english = bit_names(signal, bits)?;
    let names = KOREAN.bench.bits(signal);
    if bits == 0 {
        return Some(KOREAN.bench.none.to_owned());
    }
    let said = (0..BITS).filter(|bit| bits & 1 << bit != 0).map(|bit| {
        let known = names.get(usize::from(bit)).map(|name| (*name).to_owned());
        known.or_else(|| Some(content::korean(&bit_names(signal, 1 << bit)?).into_owned()))
    });
    let said: Option<Vec<_>> = said.collect();
    Some(said.map_or(english, |said| said.join(" + ")))
}
