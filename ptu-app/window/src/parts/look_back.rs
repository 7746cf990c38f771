//! Choice of how far back a page looks.

use eframe::egui::Ui;

use super::{pick, segments};
use ptu_report::words::{Words, fill};

/// Width of the list of spans, points.
const LIST: f32 = 90.0;
/// Microseconds of a day.
pub const DAY_US: i64 = 86_400_000_000;
/// Spans to look back, days; none = all there is.
const SPANS: [Option<i64>; 4] = [Some(30), Some(90), Some(365), None];

/// Draws the choice of days to look back as segments.
pub fn look_back(ui: &mut Ui, words: &Words, days: &mut Option<i64>) {
    let names = named(words, words.faults.always);
    segments(ui, days, names.iter().map(|(span, name)| (*span, &**name)));
}

/// Draws the choice of days to look back as a list.
pub fn look_back_list(ui: &mut Ui, words: &Words, days: &mut Option<i64>) {
    let (since, always) = (words.faults.since, words.faults.always);
    let names = named(words, &format!("{since}: {always}"));
    pick(ui, (since, LIST), days, names);
}

fn named(words: &Words, always: &str) -> [(Option<i64>, String); SPANS.len()] {
    SPANS.map(|span| match span {
        Some(days) => (span, fill(words.faults.days, &[("n", &days)])),
        None => (span, always.to_owned()),
    })
}

/// Beginning of the span, µs since 1970; none = no beginning.
pub fn since_us(days: Option<i64>, now_us: i64) -> Option<i64> {
    days.map(|days| now_us - days * DAY_US)
}
