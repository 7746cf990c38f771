//! The window's menu: language, theme, density, size, operator, depot, the lock, and the dialog About.

use eframe::egui::{Grid, Ui};

use egui_material_icons::icons::ICON_DATABASE;

use crate::parts::{ActionPlace, Face, Look, field, name_edit, segments};
use crate::{Density, Destination, PageContext};
use ptu_report::words::Language;

const STEP: f32 = 0.1;
/// Width of a field, points.
const FIELD: f32 = 200.0;

/// Draws the menu; `with_history` = with the history, for which the rail has no room.
pub fn menu(with_history: bool, ui: &mut Ui, context: &mut PageContext<'_>) {
    let words = &context.words.frame;
    let settings = &mut *context.settings;
    Grid::new("menu").num_columns(2).show(ui, |ui| {
        ui.label(words.language);
        let names = Language::ALL.map(|language| (language, language.name()));
        segments(ui, &mut settings.language, names);
        ui.end_row();
        ui.label(words.theme);
        let themes = [
            (Some(true), words.dark),
            (Some(false), words.light),
            (None, words.as_desktop),
        ];
        segments(ui, &mut settings.dark, themes);
        ui.end_row();
        ui.label(words.view);
        let views = [
            (Density::Operator, words.operator),
            (Density::Engineer, words.engineer),
        ];
        segments(ui, &mut settings.density, views);
        ui.end_row();
        ui.label(words.scale);
        ui.horizontal(|ui| {
            // A change of size moves the buttons, so a double click must not act twice.
            let zoom = f32::from(settings.zoom);
            let place = ActionPlace::new(ui, "size", zoom.to_bits());
            let smaller = Face::new(Look::Secondary, "−").show(ui);
            let shown = format!("{:.0} %", 100.0 * zoom);
            Face::new(Look::State, shown).show(ui);
            let larger = Face::new(Look::Secondary, "+").show(ui);
            let by = match (place.clicked(&smaller), place.clicked(&larger)) {
                (true, _) => -STEP,
                (_, true) => STEP,
                _ => 0.0,
            };
            settings.zoom = (zoom + by).into();
        });
        ui.end_row();
        let name = name_edit(&mut settings.operator, FIELD);
        field(ui, context.words.common.operator, name);
        // The depot belongs to the window, not to the chosen unit.
        let depot = name_edit(&mut settings.depot, FIELD);
        field(ui, context.words.report.depot, depot);
    });
    ui.horizontal(|ui| {
        if with_history {
            let history = Face::new(Look::Quiet, context.words.care.title).icon(ICON_DATABASE);
            if history.show(ui).clicked() {
                context.go_to.push(Destination::History);
                ui.close();
            }
        }
        if Face::new(Look::Quiet, words.about).show(ui).clicked() {
            context.go_to.push(Destination::About);
            ui.close();
        }
        let lock = Face::new(Look::Quiet, words.lock).hint(words.lock_hint);
        if lock.show(ui).clicked() {
            settings.lock();
            ui.close();
        }
    });
}
