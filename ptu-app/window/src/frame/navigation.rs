//! Selects the page, the language, light or dark, and the zoom.

use eframe::egui::{Color32, ComboBox, FontId, RichText, Ui};

use super::about::About;
use super::care::Care;
use super::connection::both_ends;
use crate::parts::{ActionPlace, named_combo};
use crate::settings::{LARGEST_ZOOM, SMALLEST_ZOOM};
use crate::{Density, Page, PageContext, Sizes};
use ptu_report::words::{Language, Words};

const STEP: f32 = 0.1;
/// Least share of the usual spaces in which the names of pages can be told apart.
const LEAST_SPACES: f32 = 0.4;
/// A bar so wide has the pages and the rest in one line, points.
const BESIDE: f32 = 1180.0;
/// Least width of a choice, and most of that of the page, points.
const LEAST: f32 = 64.0;
const MOST: f32 = 140.0;
/// Room for the names of all pages below each other, points.
const ALL_PAGES: f32 = 400.0;
/// A window narrower than this has no room for the names of all pages in a line or two, points.
const NARROW: f32 = 720.0;

pub fn bar(ui: &mut Ui, context: &mut PageContext<'_>, (about, care): (&mut About, &mut Care)) {
    let ends = |ui: &mut Ui, context: &mut PageContext<'_>| {
        about.button(ui, context);
        care.button(ui, context);
        look(ui, context);
    };
    if ui.ctx().content_rect().width() < NARROW {
        both_ends(ui, context, ends, choose_page);
    } else if ui.available_width() < BESIDE {
        // Beside the rest the pages would take three lines.
        ui.horizontal_wrapped(|ui| pages(ui, context));
        both_ends(ui, context, ends, |_, _| {});
    } else {
        both_ends(ui, context, ends, pages);
    }
}

fn pages(ui: &mut Ui, context: &mut PageContext<'_>) {
    let size = Sizes::of(ui).body.max(16.0);
    narrow_spaces(ui, context.words, size);
    for page in Page::ALL {
        let chosen = context.settings.page == page;
        let text = RichText::new(page.name(context.words)).size(size);
        let button = ui.selectable_label(chosen, text);
        if button.on_hover_text(page.key()).clicked() {
            context.settings.page = page;
        }
    }
}

/// Narrows the spaces in and between the names of pages where that leaves them in one line.
fn narrow_spaces(ui: &mut Ui, words: &Words, size: f32) {
    let font = FontId::proportional(size);
    let width = |page: Page| {
        let name = page.name(words).to_owned();
        let laid_out = ui
            .painter()
            .layout_no_wrap(name, font.clone(), Color32::WHITE);
        // On whole points, as widgets are.
        laid_out.size().x.ceil()
    };
    let left = ui.available_width() - Page::ALL.into_iter().map(width).sum::<f32>();
    let spacing = ui.spacing_mut();
    let usual = 2.0 * spacing.button_padding.x + spacing.item_spacing.x;
    let share = left / (usual * Page::ALL.len() as f32);
    if (LEAST_SPACES..1.0).contains(&share) {
        spacing.button_padding.x *= share;
        spacing.item_spacing.x *= share;
    }
}

fn choose_page(ui: &mut Ui, context: &mut PageContext<'_>) {
    let words = context.words;
    let shown = context.settings.page.name(words);
    let combo = ComboBox::from_id_salt("page")
        .selected_text(shown)
        .width(ui.available_width().clamp(LEAST, MOST))
        .truncate()
        .height(ALL_PAGES);
    let combo = combo.show_ui(ui, |ui| {
        for page in Page::ALL {
            let name = format!("{}  {}", page.key(), page.name(words));
            ui.selectable_value(&mut context.settings.page, page, name);
        }
    });
    named_combo(&combo.response, words.frame.page, shown);
}

fn look(ui: &mut Ui, context: &mut PageContext<'_>) {
    let frame = &context.words.frame;
    let settings = &mut *context.settings;
    // The scale moves all of them under the pointer.
    let state = (settings.zoom.to_bits(), settings.dark, settings.density);
    let place = ActionPlace::new(ui, "look", state);
    let smaller = ui.button("A-").on_hover_text(frame.scale);
    if place.clicked(&smaller) {
        settings.zoom = (settings.zoom - STEP).max(SMALLEST_ZOOM);
    }
    let larger = ui.button("A+").on_hover_text(frame.scale);
    if place.clicked(&larger) {
        settings.zoom = (settings.zoom + STEP).min(LARGEST_ZOOM);
    }
    let light = if settings.dark {
        frame.light
    } else {
        frame.dark
    };
    if place.clicked(&ui.button(light)) {
        settings.dark = !settings.dark;
    }
    let (density, hint) = match settings.density {
        Density::Operator => (frame.engineer, frame.engineer_hint),
        Density::Engineer => (frame.operator, frame.operator_hint),
    };
    if place.clicked(&ui.button(density).on_hover_text(hint)) {
        settings.density = settings.density.other();
    }
    let combo = ComboBox::from_id_salt("language")
        .selected_text(settings.language.name())
        .width(LEAST);
    let shown = combo.show_ui(ui, |ui| {
        for language in Language::ALL {
            ui.selectable_value(&mut settings.language, language, language.name());
        }
    });
    named_combo(&shown.response, frame.language, settings.language.name());
}
