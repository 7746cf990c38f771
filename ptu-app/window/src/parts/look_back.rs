//! How far back a page looks.

use eframe::egui::{ComboBox, Ui};

use super::named_combo;
use ptu_report::words::{Words, fill};

/// Microseconds of a day.
pub const DAY_US: i64 = 86_400_000_000;
/// Spans to look back, days; none = all there is.
const SPANS: [Option<i64>; 5] = [Some(7), Some(30), Some(90), Some(365), None];

/// Chooses the days to look back.
pub fn look_back(ui: &mut Ui, words: &Words, days: &mut Option<i64>) {
    let name = |days: Option<i64>| match days {
        Some(days) => fill(words.faults.days, &[("n", &days)]),
        None => words.faults.always.to_owned(),
    };
    let shown = name(*days);
    ui.label(words.faults.since);
    let combo = ComboBox::from_id_salt("span")
        .selected_text(&shown)
        .width(70.0);
    let response = combo.show_ui(ui, |ui| {
        for span in SPANS {
            ui.selectable_value(days, span, name(span));
        }
    });
    named_combo(&response.response, words.faults.since, &shown);
}

/// The first time of interest, µs since 1970; none = all there is.
pub fn since_us(days: Option<i64>, now_us: i64) -> Option<i64> {
    days.map(|days| now_us - days * DAY_US)
}
