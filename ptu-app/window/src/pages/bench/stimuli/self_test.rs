//! The unit's self-test on request: each item by its name, with what was measured and the unit's own limits.

use btu_rig::stimulus::Stimulus;
use eframe::egui::{Grid, RichText, Role, Ui, WidgetInfo};
use protocol::message::SelfTestItem;
use protocol::signal::Signal;

use super::buttons::{StimulusPanel, row};
use crate::Palette;
use ptu_report::words::Words;

pub fn show(ui: &mut Ui, hand: &mut StimulusPanel<'_>) {
    let words = hand.words;
    row(ui, words.bench.self_test, |ui, _| {
        hand.button(ui, words.bench.run_self_test, Stimulus::PtuSelfTest);
    });
    let items = &hand.seen.self_test;
    if items.is_empty() {
        return;
    }
    let palette = Palette::of(ui);
    let grid = Grid::new("self-test").num_columns(4).striped(true);
    grid.show(ui, |ui| {
        for item in items {
            let (name, [value, limits, verdict]) = (name(item, words), told(item, words));
            let colour = match item.passed {
                1 => palette.good,
                _ => palette.bad,
            };
            let label = ui.label(&name);
            let all = format!("{name}: {value} ({limits}), {verdict}");
            label.widget_info(|| WidgetInfo::labeled(Role::Label, true, all.clone()));
            ui.label(RichText::new(value).strong());
            ui.label(RichText::new(limits).color(palette.quiet));
            ui.colored_label(colour, verdict);
            ui.end_row();
        }
    });
}

/// The item in the language of the window; one of a newer unit by its number.
fn name(item: &SelfTestItem, words: &Words) -> String {
    let bit = item.item.bits().trailing_zeros() as usize;
    let names = words.bench.bits(Signal::SelfTest);
    names.get(bit).map_or_else(
        || format!("{} {bit}", words.bench.self_test),
        |name| (*name).to_owned(),
    )
}

/// Value, limits and verdict.
fn told(item: &SelfTestItem, words: &Words) -> [String; 3] {
    let unit = words.unit(item.unit.label());
    let limits = match item.low == item.high {
        true => item.low.to_string(),
        false => format!("{} … {}", item.low, item.high),
    };
    let verdict = match item.passed {
        1 => words.common.passed,
        _ => words.common.failed,
    };
    [format!("{} {unit}", item.value), limits, verdict.to_owned()]
}
