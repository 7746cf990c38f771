//! What this program is, its keys, where its data are, and the licences of what it ships.

use eframe::egui::{CollapsingHeader, Grid, Id, Key, RichText, ScrollArea, Ui, Window};

use super::keys::{CONNECT, STOP_ALL};
use crate::{Page, PageContext, Palette};
use ptu_report::fonts::PRETENDARD_LICENCE;

#[derive(Default)]
pub struct About {
    open: bool,
}

impl About {
    /// The button that opens it, and the window while it is open.
    pub fn button(&mut self, ui: &mut Ui, context: &PageContext<'_>) {
        let words = &context.words.frame;
        if ui.selectable_label(self.open, words.about).clicked() {
            self.open = !self.open;
        }
        if !self.open {
            return;
        }
        let mut open = !ui.input(|input| input.key_pressed(Key::Escape));
        Window::new(words.about)
            .id(Id::unique("about"))
            .open(&mut open)
            .collapsible(false)
            .default_width(560.0)
            .show(ui.ctx(), |ui| contents(ui, context));
        self.open = open;
    }
}

fn contents(ui: &mut Ui, context: &PageContext<'_>) {
    let words = context.words;
    let quiet = Palette::of(ui).quiet;
    let name = format!("{} {}", words.frame.title, env!("CARGO_PKG_VERSION"));
    ui.label(RichText::new(name).strong());
    let paths = context.queries.paths();
    Grid::new("about").num_columns(2).show(ui, |ui| {
        let row = |ui: &mut Ui, what: &str, value: String| {
            ui.label(RichText::new(what).color(quiet));
            ui.label(value);
            ui.end_row();
        };
        row(
            ui,
            words.frame.database,
            paths.database.display().to_string(),
        );
        row(
            ui,
            words.frame.scripts,
            (paths.scripts.places().iter())
                .map(ToString::to_string)
                .collect::<Vec<_>>()
                .join("\n"),
        );
        for page in Page::ALL {
            row(ui, page.key(), page.name(words).into());
        }
        row(
            ui,
            CONNECT.name(),
            format!("{} / {}", words.frame.connect, words.frame.disconnect),
        );
        row(ui, STOP_ALL.name(), words.frame.stop_all.into());
    });
    CollapsingHeader::new(words.frame.font_licence).show(ui, |ui| {
        ScrollArea::vertical()
            .max_height(260.0)
            .show(ui, |ui| ui.label(RichText::new(PRETENDARD_LICENCE).small()));
    });
}
