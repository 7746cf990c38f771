//! How far back a page looks.

use eframe::egui::Ui;

use super::{pick, segments};
use ptu_report::words::{Words, fill};

/// A row less wide than this has a list of them, which takes so much of it, points.
const LEAST: f32 = 1000.0;
const NARROW: f32 = 90.0;
/// Microseconds of a day.
pub const DAY_US: i64 = 86_400_000_000;
/// Spans to look back, days; none = all there is.
const SPANS: [Option<i64>; 4] = [Some(30), Some(90), Some(365), None];

/// Chooses the days to look back.
pub fn look_back(ui: &mut Ui, words: &Words, days: &mut Option<i64>) {
    let name = |days: Option<i64>| match days {
        Some(days) => fill(words.faults.days, &[("n", &days)]),
        None => words.faults.always.to_owned(),
    };
    let names = SPANS.map(|span| (span, name(span)));
    match ui.max_rect().width() < LEAST {
        true => {
            pick(ui, (words.faults.since, NARROW), days, names);
        }
        false => segments(ui, days, names.iter().map(|(span, name)| (*span, &**name))),
    }
}

/// The first time of interest, µs since 1970; none = all there is.
pub fn since_us(days: Option<i64>, now_us: i64) -> Option<i64> {
    days.map(|days| now_us - days * DAY_US)
}
