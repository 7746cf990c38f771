//! The filters, and the table of the faults that match.

use eframe::egui::{Color32, Ui};
use egui_material_icons::MaterialIcon;
use egui_material_icons::icons::{
    ICON_BUILD, ICON_CHECK, ICON_ERROR, ICON_VERIFIED, ICON_VISIBILITY,
};
use fault_db::{FaultState, FaultSummary, Id};

use super::History;
use super::filter::Filter;
use crate::Palette;
use crate::page_context::FaultsOf;
use crate::parts::{Cell, Column, Table, chip, find_edit, look_back, names, pick};
use ptu_report::naming::{DOT, PartNames, seen_in_short};
use ptu_report::words::{Words, fill};
use ptu_runs::clock;

/// Width of a field of a filter, points.
const FIELD: f32 = 90.0;

pub fn filters(ui: &mut Ui, words: &Words, filter: &mut Filter, history: &History) {
    let part = |part: &String| history.parts.name(part, words.language).to_owned();
    let name = |state: &FaultState| words.fault_state(*state).to_owned();
    find_edit(ui, &mut filter.text, words.faults.find, 1.5 * FIELD);
    choose(
        ui,
        words,
        (words.common.state, FaultState::ALL.to_vec()),
        name,
        &mut filter.state,
    );
    let parts = names(history.faults.iter().map(|fault| fault.lru.as_str()));
    choose(ui, words, (words.common.part, parts), part, &mut filter.lru);
    look_back::look_back_list(ui, words, &mut filter.days);
}

/// A list from which one value or none is chosen; `called` gives the shown name of a value.
fn choose<T: Clone + PartialEq>(
    ui: &mut Ui,
    words: &Words,
    (what, all): (&str, Vec<T>),
    called: impl Fn(&T) -> String,
    chosen: &mut Option<T>,
) {
    let any = (None, format!("{what}: {}", words.faults.any));
    let all = all.into_iter().map(|one| (Some(one.clone()), called(&one)));
    pick(ui, (what, FIELD), chosen, std::iter::once(any).chain(all));
}

/// Shows the filter set by a bar of the statistics, with a button that clears it.
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

/// Draws the faults; returns the fault that was clicked.
pub fn table(
    ui: &mut Ui,
    words: &Words,
    shown: &[&FaultSummary],
    parts: &PartNames,
    chosen: Option<Id>,
) -> Option<Id> {
    let palette = Palette::of(ui);
    let (common, faults) = (&words.common, &words.faults);
    let table = Table {
        columns: &[
            Column::new(common.state, 130.0),
            Column::new(common.part, 130.0),
            Column::new(common.step, 0.0),
            Column::new(common.unit, 96.0).from(560.0),
            Column::new(faults.seen, 44.0).right().from(620.0),
            Column::new(faults.last_seen, 120.0).right().from(480.0),
        ],
        end: 0.0,
    };
    let today = clock::local_minute(clock::now_us());
    let mut clicked = None;
    table.scrolled(ui, shown.len(), |ui, range| {
        for fault in shown.get(range).into_iter().flatten() {
            let (icon, colour) = state_look(fault.state, &palette);
            let part = parts.name(&fault.lru, words.language);
            let seen = seen_in_short((&fault.findings, &fault.message), words);
            let when = of_today(&clock::local_minute(fault.last_at_us), &today).to_owned();
            let cells = [
                Cell::State(icon, words.fault_state(fault.state), colour),
                Cell::Text(part.into(), palette.ink),
                Cell::Text(seen.into(), palette.second),
                Cell::Text((&*fault.unit_serial).into(), palette.second),
                Cell::Text(fault.occurrences.to_string().into(), palette.second),
                Cell::Text(when.into(), palette.quiet),
            ];
            let name = title(fault, parts, words);
            let row = table.row(ui, (&name, chosen == Some(fault.id)), &cells);
            let row = row.on_hover_ui(|ui| {
                ui.label(&*words.found(&fault.findings, &fault.message));
            });
            if row.clicked() {
                clicked = Some(fault.id);
            }
        }
    });
    clicked
}

/// Time of an event: without the day if it is today.
fn of_today<'a>(when: &'a str, today: &str) -> &'a str {
    match (when.split_once(' '), today.split_once(' ')) {
        (Some((day, time)), Some((now, _))) if day == now => time,
        _ => when,
    }
}

/// Text: the part, its latest finding, its cause, the unit and the time.
fn title(fault: &FaultSummary, parts: &PartNames, words: &Words) -> String {
    let mut said = parts.fault(&fault.lru, (&fault.findings, &fault.message), words);
    if fault.cause() != fault.lru {
        let cause = parts.name(fault.cause(), words.language);
        said = format!("{said} ({}: {cause})", words.faults.cause);
    }
    let when = clock::local_minute(fault.last_at_us);
    [&*said, &*fault.unit_serial, &*when].join(DOT)
}

/// The icon of a fault's state, and its colour.
fn state_look(state: FaultState, palette: &Palette) -> (MaterialIcon, Color32) {
    match state {
        FaultState::Open => (ICON_ERROR, palette.warn),
        FaultState::Acknowledged => (ICON_VISIBILITY, palette.ink),
        FaultState::Repaired => (ICON_BUILD, palette.ink),
        FaultState::Verified => (ICON_VERIFIED, palette.second),
        FaultState::Closed => (ICON_CHECK, palette.quiet),
    }
}

/// Draws a fault's state.
pub fn state_chip(ui: &mut Ui, words: &Words, state: FaultState) {
    let (icon, colour) = state_look(state, &Palette::of(ui));
    chip(ui, (icon, words.fault_state(state)), colour);
}
