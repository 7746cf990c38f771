//! Deviations of a trace, and the chain of events that followed, as text and as JSON.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::signal_text::said;
use ptu_runs::replay::{Comparison, Deviation, Difference, Explanation, Link};
use ptu_runs::table::Table;

/// Deviations shown; the rest follows from them.
const SHOWN: usize = 15;

/// First deviation, chain and further deviations, as a person reads them.
pub fn explanation_text(explanation: &Explanation) -> String {
    let mut text = String::new();
    match explanation.first() {
        None => {
            text.push_str("as expected: no signal deviates from the good twin's\n");
            for link in &explanation.chain {
                let _ = writeln!(text, "  {}", link_text(link));
            }
        }
        Some(first) => {
            let _ = writeln!(text, "first deviation from the good twin: {}", told(first));
            text.push_str("chain\n");
            for link in &explanation.chain {
                let _ = writeln!(text, "  {}", link_text(link));
            }
            text.push_str(&deviations_text(
                &explanation.comparison,
                "CAME",
                "EXPECTED",
            ));
        }
    }
    for note in &explanation.notes {
        let _ = writeln!(text, "{note}");
    }
    text.trim_end().to_owned()
}

/// `speed1 is 0 km/h, expected 12.3 km/h, 4.20 s before the trigger`
fn told(deviation: &Deviation) -> String {
    let Deviation {
        signal,
        channel,
        first,
        ..
    } = deviation;
    format!(
        "{signal} is {}, expected {}, {}",
        said(channel, first.value),
        said(channel, first.expected),
        when(first.at_s)
    )
}

fn when(at_s: f64) -> String {
    match at_s {
        0.0 => "at the trigger".into(),
        at_s if at_s < 0.0 => format!("{:.2} s before the trigger", -at_s),
        at_s => format!("{at_s:.2} s after the trigger"),
    }
}

fn link_text(link: &Link) -> String {
    match link {
        Link::Signal(deviation) => format!(
            "{:>8.2} s  {} {} instead of {}",
            deviation.first.at_s,
            deviation.signal,
            said(&deviation.channel, deviation.first.value),
            said(&deviation.channel, deviation.first.expected)
        ),
        Link::Fault {
            at_s,
            code,
            name,
            lru,
        } => format!("{at_s:>8.2} s  fault {code} {name}, points at {lru}"),
    }
}

/// A table of deviations, in their order.
pub fn deviations_text(comparison: &Comparison, came: &str, expected: &str) -> String {
    let mut table = Table::new(&["SIGNAL", "FROM", came, expected, "LARGEST", "AT", "ROWS"]);
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
            deviation.signal.clone(),
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
        let _ = writeln!(text, "and {more} more signals, which deviate later");
    }
    text
}

/// `first_deviation`, `deviations`, `chain` and `notes`.
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
    json!({
        "signal": signal, "unit": channel.unit, "at_s": first.at_s,
        "value": first.value, "expected": first.expected,
        "value_text": said(channel, first.value), "expected_text": said(channel, first.expected),
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
