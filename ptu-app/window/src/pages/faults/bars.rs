//! The charts: occurrences over time, by unit, by code.

use eframe::egui::Ui;
use fault_db::DailyCount;

use super::charts::{by_name, over_time};
use crate::parts::bars::{Bar, Chart};
use crate::parts::look_back::DAY_US;
use ptu_report::naming;
use ptu_report::words::{Words, fill};
use ptu_runs::clock;

/// The three charts side by side.
pub fn charts(ui: &mut Ui, words: &Words, counts: &[&DailyCount]) {
    let Some(in_time) = over_time(counts) else {
        return;
    };
    let width = (ui.available_width() - 2.0 * ui.spacing().item_spacing.x) / 3.0;
    let title = fill(words.faults.over_time, &[("days", &in_time.days)]);
    let chart = |title| Chart {
        title,
        width,
        leads: false,
        sums: true,
    };
    ui.horizontal(|ui| {
        let bars = (0..).zip(&in_time.bars).map(|(place, count)| {
            // Noon, since a day of summer time begins an hour before one of winter.
            let from_us = in_time.from_us + place * in_time.days * DAY_US + DAY_US / 2;
            Bar::new(clock::local_day(from_us), *count)
        });
        chart(&title).in_time(ui, &bars.collect::<Vec<_>>());
        let units = by_name(counts, |count| count.unit_serial.as_str());
        chart(words.faults.by_unit).by_name(ui, &bars_of(words, units));
        let codes = by_name(counts, |count| {
            naming::event(count.code, &count.code_name, words)
        });
        chart(words.faults.by_code).by_name(ui, &bars_of(words, codes));
    });
}

fn bars_of(words: &Words, (names, others): (Vec<(impl Into<String>, u64)>, u64)) -> Vec<Bar> {
    let named = names.into_iter().map(|(name, count)| Bar::new(name, count));
    let rest = (others > 0).then(|| Bar::new(words.faults.others, others));
    named.chain(rest).collect()
}
