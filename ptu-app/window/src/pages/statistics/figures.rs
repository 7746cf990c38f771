//! The figures of all causes together, each with what it is computed of.

use eframe::egui::{RichText, Ui};
use fault_db::FaultStat;

use super::counted::BACK_WITHIN_DAYS;
use crate::Palette;
use ptu_report::words::{Words, fill};

/// Of fewer days there is no mean time between faults.
const LEAST_DAYS: f64 = 7.0;

pub fn figures(ui: &mut Ui, words: &Words, all: &FaultStat) {
    let said = &words.statistics;
    let n = |number: u32, text: &str| fill(text, &[("n", &number)]);
    let back_is = fill(
        said.back_is,
        &[("days", &BACK_WITHIN_DAYS), ("n", &all.repairs_judged)],
    );
    for (name, value, of) in [
        (
            said.cases,
            all.faults.to_string(),
            n(all.not_closed, said.cases_are),
        ),
        (
            said.mtbf,
            length(words, all.mtbf_days.filter(|mean| observed(all, *mean))),
            said.mtbf_is.to_owned(),
        ),
        (
            said.mttr,
            length(words, all.mttr_hours.map(|hours| hours / 24.0)),
            n(all.repairs, said.mttr_is),
        ),
        (
            said.back,
            share(words, all.repairs_back, all.repairs_judged),
            back_is,
        ),
        (
            said.not_found,
            share(words, all.no_fault_found, all.closed),
            n(all.closed, said.not_found_is),
        ),
    ] {
        ui.horizontal_wrapped(|ui| {
            ui.label(name);
            ui.label(RichText::new(value).strong().size(16.0));
            ui.label(RichText::new(of).color(Palette::of(ui).quiet));
        });
    }
}

/// The units were there for so many days that their faults tell how often they come.
fn observed(all: &FaultStat, mtbf_days: f64) -> bool {
    mtbf_days * f64::from(all.faults) >= LEAST_DAYS
}

/// A length of time in the unit that fits.
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
    if all == 0 {
        return words.statistics.unknown.to_owned();
    }
    let share = format!("{:.0}", 100.0 * f64::from(part) / f64::from(all));
    fill(words.statistics.percent, &[("n", &share)])
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
