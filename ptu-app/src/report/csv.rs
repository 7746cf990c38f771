//! A run as CSV (RFC 4180): a line each measurement, and one for a step that measured nothing.

use std::fmt::Write;

use fault_db::{MeasurementRecord, RunDetail, StepDetail};

use crate::clock::rfc3339;

/// Names of the columns.
const COLUMNS: [&str; 15] = [
    "run",
    "unit_serial",
    "started_at",
    "procedure",
    "step_index",
    "step",
    "step_verdict",
    "bench_time_s",
    "message",
    "measurement",
    "value",
    "unit",
    "low",
    "high",
    "measurement_verdict",
];

/// The table.
pub fn csv(run: &RunDetail) -> String {
    let mut text = COLUMNS.join(",") + "\n";
    for step in &run.steps {
        let none = step.measurements.is_empty().then_some(None);
        for measured in step.measurements.iter().map(Some).chain(none) {
            let cells = cells(run, step, measured);
            // Writing to a text cannot fail.
            let _ = writeln!(text, "{}", cells.map(|cell| quoted(&cell)).join(","));
        }
    }
    text
}

fn cells(run: &RunDetail, step: &StepDetail, measured: Option<&MeasurementRecord>) -> [String; 15] {
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let word = |word: fn(&MeasurementRecord) -> String| measured.map(word).unwrap_or_default();
    [
        run.run.id.to_string(),
        run.run.unit_serial.clone(),
        rfc3339(run.run.started_at_us),
        step.procedure.clone(),
        step.index.to_string(),
        step.name.clone(),
        step.verdict.as_str().to_owned(),
        format!("{}", step.bench_time_us as f64 / 1e6),
        step.message.clone(),
        word(|m| m.name.clone()),
        number(measured.and_then(|m| m.value)),
        word(|m| m.unit.clone()),
        number(measured.and_then(|m| m.low)),
        number(measured.and_then(|m| m.high)),
        word(|m| m.verdict.as_str().to_owned()),
    ]
}

/// A cell in quotes where its content asks for them.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_break_a_line_is_quoted() {
        assert_eq!(quoted("plain"), "plain");
        assert_eq!(quoted("a, \"b\"\nc"), "\"a, \"\"b\"\"\nc\"");
    }
}
