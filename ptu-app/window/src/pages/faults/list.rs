//! The filters, and the list of faults that match.

use eframe::egui::{ComboBox, RichText, ScrollArea, TextEdit, TextWrapMode, Ui};
use egui_material_icons::icons::{
    ICON_BUILD, ICON_CHECK, ICON_ERROR, ICON_VERIFIED, ICON_VISIBILITY,
};
use fault_db::{FaultState, FaultSummary, Id};

use super::History;
use super::filter::{Filter, names};
use crate::Palette;
use crate::page_context::FaultsOf;
use crate::parts::{UnitFilter, chip, look_back, named_combo};
use ptu_report::naming::{DOT, PartNames};
use ptu_report::words::{Words, fill};
use ptu_runs::clock;

pub fn filters(ui: &mut Ui, words: &Words, filter: &mut Filter, history: &History) {
    let faults_of = || history.faults.iter();
    let as_it_is = |name: &str| name.to_owned();
    let part = |part: &str| history.parts.name(part, words.language).to_owned();
    ui.horizontal_wrapped(|ui| {
        let units = names(faults_of().map(|fault| fault.unit_serial.as_str()));
        let what = words.common.unit;
        choose(ui, words, (what, &units), as_it_is, &mut filter.unit);
        let parts = names(faults_of().map(|fault| fault.lru.as_str()));
        let what = words.common.part;
        choose(ui, words, (what, &parts), part, &mut filter.lru);
        state(ui, words, &mut filter.state);
        look_back::look_back(ui, words, &mut filter.days);
        let label = ui.label(words.faults.find);
        ui.add(TextEdit::singleline(&mut filter.text).desired_width(100.0))
            .labelled_by(label.id);
    });
}

/// `called` says what people call one of the names.
fn choose(
    ui: &mut Ui,
    words: &Words,
    (what, names): (&str, &[&str]),
    called: impl Fn(&str) -> String,
    chosen: &mut Option<String>,
) {
    let any = || words.faults.any.to_owned();
    let shown = chosen.as_deref().map_or_else(any, &called);
    ui.label(what);
    let combo = ComboBox::from_id_salt(what)
        .selected_text(&shown)
        .width(70.0);
    let response = combo.show_ui(ui, |ui| {
        ui.selectable_value(chosen, None, words.faults.any);
        for name in names {
            ui.selectable_value(chosen, Some((*name).to_owned()), called(name));
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

/// What a bar of the statistics stands for, with a button that clears it.
pub fn of_bar(ui: &mut Ui, words: &Words, filter: &mut Filter, parts: &PartNames) {
    let of = &filter.of_bar;
    let cause = of.cause.as_deref().map(|cause| {
        let cause = parts.name(cause, words.language);
        format!("{} {cause}", words.faults.cause)
    });
    let month = of.first_seen_us.as_ref();
    let month = month.map(|_| fill(words.faults.first_seen_in, &[("month", &of.month)]));
    if let Some(said) = cause.or(month) {
        let button = ui.button(format!("{said}  ×"));
        if button.on_hover_text(words.faults.show_all).clicked() {
            filter.of_bar = FaultsOf::default();
        }
    }
}

/// The faults; the one that was clicked.
pub fn list(
    ui: &mut Ui,
    words: &Words,
    (filter, units): (&Filter, &UnitFilter),
    (faults, parts): (&[FaultSummary], &PartNames),
    chosen: Option<Id>,
) -> Option<Id> {
    let palette = Palette::of(ui);
    let shown: Vec<_> = (faults.iter())
        .filter(|fault| filter.takes(fault) && units.takes(&fault.unit_serial))
        .collect();
    let count = fill(
        words.faults.shown,
        &[("n", &shown.len()), ("of", &faults.len())],
    );
    ui.label(RichText::new(count).color(palette.quiet));
    let height = ui.spacing().interact_size.y;
    let mut clicked = None;
    ScrollArea::vertical()
        .id_salt("faults")
        .auto_shrink(false)
        .show_rows(ui, height, shown.len(), |ui, range| {
            for fault in shown.get(range).into_iter().flatten() {
                if row(ui, words, (fault, parts), chosen == Some(fault.id)) {
                    clicked = Some(fault.id);
                }
            }
        });
    clicked
}

fn row(
    ui: &mut Ui,
    words: &Words,
    (fault, parts): (&FaultSummary, &PartNames),
    chosen: bool,
) -> bool {
    let said = ui.horizontal(|ui| {
        state_chip(ui, words, fault.state);
        ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
        let row = ui.selectable_label(chosen, title(fault, parts, words));
        row.on_hover_ui(|ui| {
            ui.label(fault.id.to_string());
            ui.label(&*words.found(&fault.findings, &fault.message));
        })
    });
    said.inner.clicked()
}

/// The part, what was seen of it last, the unit and when.
pub fn title(fault: &FaultSummary, parts: &PartNames, words: &Words) -> String {
    let mut said = parts.fault(&fault.lru, (&fault.findings, &fault.message), words);
    if fault.cause() != fault.lru {
        let cause = parts.name(fault.cause(), words.language);
        said = format!("{said} ({}: {cause})", words.faults.cause);
    }
    let when = clock::local_minute(fault.last_at_us);
    let today = clock::local_minute(clock::now_us());
    // Of today the time says enough.
    let when = match (when.split_once(' '), today.split_once(' ')) {
        (Some((day, time)), Some((now, _))) if day == now => time,
        _ => &when,
    };
    [&*said, &*fault.unit_serial, when].join(DOT)
}

/// A fault's state.
pub fn state_chip(ui: &mut Ui, words: &Words, state: FaultState) {
    let palette = Palette::of(ui);
    let (icon, colour) = match state {
        FaultState::Open => (ICON_ERROR, palette.warn),
        FaultState::Acknowledged => (ICON_VISIBILITY, palette.ink),
        FaultState::Repaired => (ICON_BUILD, palette.ink),
        FaultState::Verified => (ICON_VERIFIED, palette.second),
        FaultState::Closed => (ICON_CHECK, palette.quiet),
    };
    chip(ui, (icon, words.common.fault_state(state)), colour);
}
