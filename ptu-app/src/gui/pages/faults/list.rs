//! The filters, and the list of faults that match.

use eframe::egui::{
    ComboBox, Label, Response, RichText, ScrollArea, Sense, TextEdit, TextStyle, Ui,
};
use fault_db::{FaultState, FaultSummary, Id};

use super::filter::{Filter, SPANS, names};
use crate::gui::Palette;
use crate::gui::parts::{chip, named_cell, named_combo};
use ptu_bench::clock;
use ptu_report::words::{Words, fill};

/// Widths of the columns, points.
const COLUMNS: [f32; 7] = [148.0, 68.0, 126.0, 108.0, 108.0, 62.0, 30.0];

pub fn filters(ui: &mut Ui, words: &Words, filter: &mut Filter, faults: &[FaultSummary]) {
    let faults_of = || faults.iter();
    ui.horizontal_wrapped(|ui| {
        let units = names(faults_of().map(|fault| fault.unit_serial.as_str()));
        choose(ui, words, words.common.unit, &units, &mut filter.unit);
        let parts = names(faults_of().map(|fault| fault.lru.as_str()));
        choose(ui, words, words.common.part, &parts, &mut filter.lru);
        state(ui, words, &mut filter.state);
        span(ui, words, &mut filter.days);
        let label = ui.label(words.faults.find);
        ui.add(TextEdit::singleline(&mut filter.text).desired_width(100.0))
            .labelled_by(label.id);
    });
}

fn choose(ui: &mut Ui, words: &Words, what: &str, names: &[&str], chosen: &mut Option<String>) {
    let shown = chosen.clone().unwrap_or_else(|| words.faults.any.into());
    ui.label(what);
    let combo = ComboBox::from_id_salt(what)
        .selected_text(&shown)
        .width(70.0);
    let response = combo.show_ui(ui, |ui| {
        ui.selectable_value(chosen, None, words.faults.any);
        for name in names {
            ui.selectable_value(chosen, Some((*name).to_owned()), *name);
        }
    });
    named_combo(&response.response, what, &shown);
}

fn state(ui: &mut Ui, words: &Words, chosen: &mut Option<FaultState>) {
    let name = |state: FaultState| words.common.fault_state(state);
    let shown = chosen.map_or(words.faults.any, name);
    ui.label(words.common.state);
    let combo = ComboBox::from_id_salt("state")
        .selected_text(shown)
        .width(70.0);
    let response = combo.show_ui(ui, |ui| {
        ui.selectable_value(chosen, None, words.faults.any);
        for state in FaultState::ALL {
            ui.selectable_value(chosen, Some(*state), name(*state));
        }
    });
    named_combo(&response.response, words.common.state, shown);
}

fn span(ui: &mut Ui, words: &Words, chosen: &mut Option<i64>) {
    let name = |days: Option<i64>| match days {
        Some(days) => fill(words.faults.days, &[("n", &days)]),
        None => words.faults.always.to_owned(),
    };
    let shown = name(*chosen);
    ui.label(words.faults.since);
    let combo = ComboBox::from_id_salt("span")
        .selected_text(&shown)
        .width(70.0);
    let response = combo.show_ui(ui, |ui| {
        for days in SPANS {
            ui.selectable_value(chosen, days, name(days));
        }
    });
    named_combo(&response.response, words.faults.since, &shown);
}

/// The faults; the one that was clicked.
pub fn list(
    ui: &mut Ui,
    words: &Words,
    filter: &Filter,
    faults: &[FaultSummary],
    chosen: Option<Id>,
) -> Option<Id> {
    let palette = Palette::of(ui);
    let shown: Vec<_> = faults.iter().filter(|fault| filter.takes(fault)).collect();
    let count = fill(
        words.faults.shown,
        &[("n", &shown.len()), ("of", &faults.len())],
    );
    ui.label(RichText::new(count).color(palette.quiet));
    let headings = [
        words.faults.last_seen,
        words.common.unit,
        words.common.code,
        words.common.part,
        words.faults.cause,
        words.common.state,
        words.faults.seen,
    ];
    ui.horizontal(|ui| {
        for (heading, width) in headings.into_iter().zip(COLUMNS) {
            cell(
                ui,
                width,
                RichText::new(heading).small().color(palette.quiet),
            );
        }
    });
    let height = ui.text_style_height(&TextStyle::Body) + 6.0;
    let mut clicked = None;
    ScrollArea::vertical()
        .id_salt("faults")
        .auto_shrink(false)
        .show_rows(ui, height, shown.len(), |ui, range| {
            for fault in shown.get(range).into_iter().flatten() {
                if row(ui, words, fault, chosen == Some(fault.id)) {
                    clicked = Some(fault.id);
                }
            }
        });
    clicked
}

fn row(ui: &mut Ui, words: &Words, fault: &FaultSummary, chosen: bool) -> bool {
    let mut clicked = false;
    ui.horizontal(|ui| {
        let (time, rest) = (COLUMNS[0], &COLUMNS[1..]);
        let at = clock::local(fault.last_at_us);
        ui.allocate_ui([time, ui.spacing().interact_size.y].into(), |ui| {
            ui.set_min_width(time);
            clicked |= ui.selectable_label(chosen, at).clicked();
        });
        clicked |= cell(ui, rest[0], RichText::new(&fault.unit_serial));
        let code = format!("{} {}", fault.code, fault.code_name);
        clicked |= cell(ui, rest[1], RichText::new(code).strong());
        clicked |= cell(ui, rest[2], RichText::new(&fault.lru));
        let cause = cell_of(ui, rest[3], RichText::new(fault.cause()));
        named_cell(&cause, words.faults.cause, fault.cause());
        clicked |= cause.clicked();
        ui.allocate_ui([rest[4], ui.spacing().interact_size.y].into(), |ui| {
            ui.set_min_width(rest[4]);
            state_chip(ui, words, fault.state);
        });
        clicked |= cell(ui, rest[5], RichText::new(fault.occurrences.to_string()));
    });
    clicked
}

/// A fault's state.
pub fn state_chip(ui: &mut Ui, words: &Words, state: FaultState) {
    let palette = Palette::of(ui);
    let colour = match state {
        FaultState::Open => palette.bad,
        FaultState::Acknowledged => palette.warn,
        FaultState::Repaired => palette.accent,
        FaultState::Verified | FaultState::Closed => palette.good,
    };
    chip(ui, words.common.fault_state(state), colour);
}

fn cell(ui: &mut Ui, width: f32, text: RichText) -> bool {
    cell_of(ui, width, text).clicked()
}

fn cell_of(ui: &mut Ui, width: f32, text: RichText) -> Response {
    let size = [width, ui.spacing().interact_size.y];
    let label = Label::new(text).truncate().sense(Sense::click());
    let response = ui.allocate_ui(size.into(), |ui| {
        ui.set_min_width(width);
        ui.add(label)
    });
    response.inner
}
