//! Deviations of a trace, and the chain of events that followed, as text and as JSON.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::signal_text::said;
use ptu_report::trace_view::value;
use ptu_report::words::{Language, Words, fill};
use ptu_runs::replay::{Comparison, Deviation, Difference, Explanation, Link};
use ptu_runs::table::Table;

/// Most deviations that are shown; later ones follow from these.
const SHOWN: usize = 15;

/// First deviation, chain and further deviations, as a person reads them.
pub fn explanation_text(explanation: &Explanation) -> String {
    let terminal = &Words::shown().terminal;
    let mut text = String::new();
    match explanation.first() {
        None => {
            let _ = writeln!(text, "{}", terminal.as_expected);
            for link in &explanation.chain {
                let _ = writeln!(text, "  {}", link_text(link));
            }
        }
        Some(first) => {
            let _ = writeln!(text, "{}: {}", terminal.deviates, told(first));
            let _ = writeln!(text, "{}", terminal.chain);
            for link in &explanation.chain {
                let _ = writeln!(text, "  {}", link_text(link));
            }
            text.push_str(&deviations_text(
                &explanation.comparison,
                terminal.came,
                terminal.expected,
            ));
        }
    }
    for note in &explanation.notes {
        let _ = writeln!(text, "{note}");
    }
    text.trim_end().to_owned()
}

/// A deviation as text, as `speed1 is 0 km/h, expected 12.3 km/h, 4.20 s before the trigger`.
fn told(deviation: &Deviation) -> String {
    let (channel, first) = (&deviation.channel, &deviation.first);
    let words = Words::shown();
    let of = [
        ("signal", &words.signal(&deviation.signal) as _),
        ("value", &said(channel, first.value) as _),
        ("expected", &said(channel, first.expected) as _),
        ("when", &when(first.at_s, words) as _),
    ];
    fill(words.terminal.is_expected, &of)
}

fn when(at_s: f64, words: &Words) -> String {
    let terminal = &words.terminal;
    let said = match at_s {
        0.0 => terminal.at_trigger,
        at_s if at_s < 0.0 => terminal.before_trigger,
        _ => terminal.after_trigger,
    };
    fill(said, &[("n", &format!("{:.2}", at_s.abs()))])
}

fn link_text(link: &Link) -> String {
    let words = Words::shown();
    let (at_s, said) = match link {
        Link::Signal(Deviation {
            signal,
            channel,
            first,
            ..
        }) => {
            let of = [
                ("signal", &words.signal(signal) as _),
                ("value", &said(channel, first.value) as _),
                ("expected", &said(channel, first.expected) as _),
            ];
            (first.at_s, fill(words.terminal.instead_of, &of))
        }
        Link::Fault {
            at_s,
            code,
            name,
            lru,
        } => {
            let of = [("code", code as _), ("name", name as _), ("part", lru as _)];
            (*at_s, fill(words.terminal.points_at, &of))
        }
    };
    format!("{at_s:>8.2} s  {said}")
}

/// Table of the first deviations, in their order.
pub fn deviations_text(comparison: &Comparison, came: &str, expected: &str) -> String {
    let words = Words::shown();
    let terminal = &words.terminal;
    let signal = words.traces.signal;
    let (from, largest, at) = (words.life.from, terminal.largest, terminal.at);
    let mut table = Table::headed(&[signal, from, came, expected, largest, at, terminal.rows]);
    for deviation in comparison.deviations.iter().take(SHOWN) {
        let Deviation {
            channel,
            first,
            largest,
            ..
        } = deviation;
        let said = |difference: &Difference| {
            format!(
                "{} / {}",
                said(channel, difference.value),
                said(channel, difference.expected)
            )
        };
        table.row([
            words.signal(&deviation.signal).into_owned(),
            format!("{:.2} s", first.at_s),
            super::signal_text::said(channel, first.value),
            super::signal_text::said(channel, first.expected),
            said(largest),
            format!("{:.2} s", largest.at_s),
            deviation.rows.to_string(),
        ]);
    }
    let mut text = table.render();
    text.push('\n');
    let more = comparison.deviations.len().saturating_sub(SHOWN);
    if more > 0 {
        let _ = writeln!(text, "{}", fill(terminal.deviate_later, &[("n", &more)]));
    }
    text
}

/// Text with the span in which two traces were compared, s from the trigger.
pub fn compared((from_s, to_s): (f64, f64), words: &Words) -> String {
    let [from, to] = [from_s, to_s].map(|at_s| format!("{at_s:.2}"));
    fill(words.traces.compared, &[("from", &from), ("to", &to)])
}

/// JSON object with `procedure`, `first_deviation`, `deviations`, `chain` and `notes`.
pub fn explanation_json(explanation: &Explanation) -> Value {
    json!({
        "procedure": explanation.procedure,
        "first_deviation": explanation.first().map(deviation_json),
        "deviations": deviations_json(&explanation.comparison),
        "chain": explanation.chain.iter().map(link_json).collect::<Vec<_>>(),
        "notes": explanation.notes,
    })
}

/// All deviations, in their order.
pub fn deviations_json(comparison: &Comparison) -> Vec<Value> {
    comparison.deviations.iter().map(deviation_json).collect()
}

fn deviation_json(deviation: &Deviation) -> Value {
    let Deviation {
        signal,
        channel,
        first,
        largest,
        rows,
        ..
    } = deviation;
    let english = |value: Option<f64>| {
        value::named(
            channel,
            value.unwrap_or(f64::NAN),
            Language::English.words(),
        )
    };
    json!({
        "signal": signal, "unit": channel.unit, "at_s": first.at_s,
        "value": first.value, "expected": first.expected,
        "value_text": english(first.value), "expected_text": english(first.expected),
        "largest": {"at_s": largest.at_s, "value": largest.value, "expected": largest.expected},
        "rows": rows,
    })
}

fn link_json(link: &Link) -> Value {
    match link {
        Link::Signal(deviation) => {
            let mut signal = deviation_json(deviation);
            if let Value::Object(signal) = &mut signal {
                signal.insert("kind".into(), "signal".into());
            }
            signal
        }
        Link::Fault {
            at_s,
            code,
            name,
            lru,
        } => json!({"kind": "fault", "at_s": at_s, "code": code, "name": name, "part": lru}),
    }
}
