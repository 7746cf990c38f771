//! A run as CSV (RFC 4180): a line each measurement, and one for a step that measured nothing.

use std::borrow::Cow;
use std::fmt::Write;

use fault_db::{MeasurementRecord, RunDetail, StepRecord};
use protocol::display_text;

use crate::departure::Departure;
use crate::words::Language;
use ptu_runs::clock::rfc3339;
use ptu_runs::stored::kind_of;

const COLUMNS: [&str; 21] = [
    "run",
    "unit_serial",
    "started_at",
    "procedure",
    "step_index",
    "step",
    "kind",
    "step_verdict",
    "bench_time_s",
    "message",
    "measurement",
    "value",
    "unit",
    "low",
    "high",
    "measurement_verdict",
    "limit_source",
    "turn",
    "turns",
    "departure_valid_until",
    "departure_not_valid",
];

/// Byte-order mark at the beginning of a table's file: without it, spreadsheets read its UTF-8 in the code
/// page of the system.
pub const MARK: &str = "\u{feff}";

/// A cell of a table: a text must not act as a formula, a number must stay a number.
pub enum Cell {
    /// Text that people and scripts wrote.
    Text(String),
    Number(String),
}

pub fn csv(run: &RunDetail) -> String {
    let mut text = format!("{MARK}{}\n", COLUMNS.join(","));
    let departure = Departure::of(run);
    for step in &run.steps {
        let none = step.measurements.is_empty().then_some(None);
        for measured in step.measurements.iter().map(Some).chain(none) {
            let cells = cells(run, departure.as_ref(), step, measured);
            // Writing to a text cannot fail.
            let _ = writeln!(text, "{}", cells.map(Cell::written).join(","));
        }
    }
    text
}

fn cells(
    run: &RunDetail,
    departure: Option<&Departure>,
    step: &StepRecord,
    measured: Option<&MeasurementRecord>,
) -> [Cell; 21] {
    let text = |text: &str| Cell::Text(text.to_owned());
    let number = |value: Option<f64>| {
        Cell::Number(value.map_or_else(String::new, |value| value.to_string()))
    };
    let until = departure.filter(|departure| departure.why_not.is_empty());
    let why_not = departure.map(|departure| departure.why_not(Language::English.words()));
    let why_not = why_not.unwrap_or_default();
    let word = |word: fn(&MeasurementRecord) -> &str| text(measured.map(word).unwrap_or_default());
    [
        Cell::Text(run.run.id.to_string()),
        text(&run.run.unit_serial),
        Cell::Text(rfc3339(run.run.started_at_us)),
        text(&step.procedure),
        Cell::Number(step.index.to_string()),
        text(&step.name),
        text(kind_of(step)),
        text(step.verdict.as_str()),
        number(Some(step.bench_time_us as f64 / 1e6)),
        text(&step.message),
        word(|m| &m.name),
        number(measured.and_then(|m| m.value)),
        word(|m| &m.unit),
        number(measured.and_then(|m| m.low)),
        number(measured.and_then(|m| m.high)),
        word(|m| m.verdict.as_str()),
        text(
            measured
                .map_or(&step.limit_source, |m| &m.limit_source)
                .as_deref()
                .unwrap_or_default(),
        ),
        Cell::Number(step.turn.to_string()),
        Cell::Number(step.turns.to_string()),
        Cell::Text(until.map_or_else(String::new, |good| rfc3339(good.until_us))),
        Cell::Text(why_not.join("; ")),
    ]
}

impl Cell {
    /// Text of the cell in the file, where a text acts on nothing: no formula, no control characters but
    /// line feeds and tabs.
    pub fn written(self) -> String {
        match self {
            Self::Number(number) => number,
            Self::Text(text) => quoted(&display_text::lines(&no_formula(&text))).into_owned(),
        }
    }
}

/// The text, with an apostrophe before it if it begins like a formula: a spreadsheet then takes the text for no
/// formula.
pub fn no_formula(text: &str) -> Cow<'_, str> {
    // Some spreadsheets pass over letters without width.
    let begins = text.trim_start_matches(|letter| letter == ' ' || display_text::is_unseen(letter));
    match text.starts_with(['\t', '\r', '\n'])
        || begins.starts_with(['=', '+', '-', '@', '＝', '＋', '－', '＠'])
    {
        true => Cow::Owned(format!("'{text}")),
        false => Cow::Borrowed(text),
    }
}

/// A cell, quoted if its content needs quotes: where a comma marks decimals, spreadsheets separate cells at semicolons.
pub(crate) fn quoted(cell: &str) -> Cow<'_, str> {
    match cell.contains([',', ';', '\t', '"', '\n', '\r']) {
        true => Cow::Owned(format!("\"{}\"", cell.replace('"', "\"\""))),
        false => Cow::Borrowed(cell),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_with_separators_or_line_breaks_is_quoted() {
        assert_eq!(quoted("plain"), "plain");
        assert_eq!(quoted("a; b"), "\"a; b\"");
        assert_eq!(quoted("a, \"b\"\nc"), "\"a, \"\"b\"\"\nc\"");
    }

    #[test]
    fn text_in_a_csv_file_has_no_control_characters() {
        let written = Cell::Text("\x1b[2J\u{9b}31m\u{202e}\tone\ntwo".into()).written();
        assert_eq!(written, "\"\\x1b[2J\\x9b31m\\u{202e}\tone\ntwo\"");
    }

    #[test]
    fn text_that_begins_like_a_formula_is_escaped_and_numbers_are_not() {
        let text = |text: &str| Cell::Text(text.into()).written();
        assert_eq!(text("=1+1"), "'=1+1");
        assert_eq!(text("@SUM(A1,A2)"), "\"'@SUM(A1,A2)\"");
        assert_eq!(text("-"), "'-");
        assert_eq!(text("eb=1"), "eb=1");
        assert_eq!(text(" =1+1"), "' =1+1");
        assert_eq!(
            text("\u{feff}=cmd|'/C calc'!A0"),
            "'\\u{feff}=cmd|'/C calc'!A0"
        );
        assert_eq!(text("＝1+1"), "'＝1+1");
        assert_eq!(text("\r=1"), "'\\r=1");
        assert_eq!(Cell::Number("-0.5".into()).written(), "-0.5");
    }
}
