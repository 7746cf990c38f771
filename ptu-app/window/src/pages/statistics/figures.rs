//! The figures of all causes together, each with the counts from which it is computed.

use eframe::egui::{RichText, Ui};
use fault_db::FaultStat;

use super::counted::BACK_WITHIN_DAYS;
use crate::parts::{caption, ground};
use crate::{Palette, Sizes};
use ptu_report::words::{Words, fill};

/// Shortest time for which a mean time between faults is given, days.
const LEAST_DAYS: f64 = 7.0;
/// Least width of a card in an engineer's window, points.
const LEAST_WIDE: f32 = 175.0;

/// Draws a card for each figure, as many in a row as there is room for.
pub fn figures(ui: &mut Ui, words: &Words, all: &FaultStat) {
    let said = &words.statistics;
    let n = |number: u32, text: &str| fill(text, &[("n", &number)]);
    let mtbf = all.mtbf_days.filter(|mean| observed(all, *mean));
    let mttr = all.mttr_hours.map(|hours| hours / 24.0);
    let cards = [
        (
            said.cases,
            all.faults.to_string(),
            n(all.not_closed, said.cases_are),
        ),
        (said.mtbf, length(words, mtbf), said.mtbf_is.to_owned()),
        (said.mttr, length(words, mttr), n(all.repairs, said.mttr_is)),
        (
            said.back,
            share(words, all.repairs_back, all.repairs_judged),
            fill(said.back_is, &[("days", &BACK_WITHIN_DAYS)]),
        ),
        (
            said.not_found,
            share(words, all.no_fault_found, all.closed),
            said.not_found_is.to_owned(),
        ),
    ];
    let least = LEAST_WIDE * Sizes::of(ui).body / 14.0;
    let fits = |columns: &usize| *columns as f32 * least <= ui.available_width();
    let columns = [5, 3].into_iter().find(fits).unwrap_or(2);
    for row in cards.chunks(columns) {
        ui.columns(columns, |columns| {
            for (ui, (name, value, of)) in columns.iter_mut().zip(row) {
                figure(ui, name, value, of);
            }
        });
    }
}

fn figure(ui: &mut Ui, name: &str, value: &str, of: &str) {
    let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
    ground(&palette).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.spacing_mut().item_spacing.y = 2.0;
        ui.spacing_mut().interact_size.y = 0.0;
        ui.label(RichText::new(name).color(palette.second));
        let value = RichText::new(value).size(sizes.headline);
        ui.label(value.color(palette.ink));
        caption(ui, of);
    });
}

/// The units were observed for at least [`LEAST_DAYS`], so that a mean time between faults says something.
fn observed(all: &FaultStat, mtbf_days: f64) -> bool {
    mtbf_days * f64::from(all.faults) >= LEAST_DAYS
}

/// A time as text, in minutes, hours or days, whichever fits.
fn length(words: &Words, days: Option<f64>) -> String {
    let said = &words.statistics;
    match days {
        None => said.unknown.to_owned(),
        Some(short) if short < 2.0 / 24.0 => {
            let minutes = (24.0 * 60.0 * short).ceil();
            fill(said.minutes, &[("n", &format!("{minutes:.0}"))])
        }
        Some(short) if short < 2.0 => fill(said.hours, &[("n", &format!("{:.1}", 24.0 * short))]),
        Some(days) if days < 100.0 => fill(said.days, &[("n", &format!("{days:.1}"))]),
        Some(days) => fill(said.days, &[("n", &format!("{days:.0}"))]),
    }
}

fn share(words: &Words, part: u32, all: u32) -> String {
    match all {
        0 => words.statistics.unknown.to_owned(),
        _ => fill(words.statistics.of_these, &[("n", &part), ("of", &all)]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ptu_report::words::Language;

    #[test]
    fn no_time_is_told_that_was_too_short_to_be_one() {
        let words = Language::English.words();
        let of = |days: f64| length(words, Some(days));
        assert_eq!(of(30.0 / 86_400.0), "1 min");
        assert_eq!(of(0.5), "12.0 h");
        let all = FaultStat {
            faults: 300,
            ..FaultStat::default()
        };
        assert!(!observed(&all, 1.0 / 300.0), "a day, and 300 faults");
        assert!(observed(&all, 0.1));
    }
}
