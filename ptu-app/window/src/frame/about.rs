//! The dialog About: this program, its keys, the places of its data, and the licences of what it ships.

use eframe::egui::{CollapsingHeader, Grid, RichText, ScrollArea, Ui};

use super::keys::{CONNECT, STOP_ALL};
use crate::parts::dialog;
use crate::{Page, PageContext, Palette};
use ptu_report::fonts::PRETENDARD_LICENCE;

#[derive(Default)]
pub struct About {
    open: bool,
}

impl About {
    pub fn open(&mut self) {
        self.open = true;
    }

    /// Shows the dialog while it is open.
    pub fn show(&mut self, ui: &Ui, context: &PageContext<'_>) {
        if self.open {
            let title = context.words.frame.about;
            self.open = dialog(ui, "about", title, |ui| contents(ui, context));
        }
    }
}

fn contents(ui: &mut Ui, context: &PageContext<'_>) {
    let words = context.words;
    let quiet = Palette::of(ui).quiet;
    let name = format!("{} {}", words.frame.title, env!("CARGO_PKG_VERSION"));
    ui.label(RichText::new(name).strong());
    let paths = &context.queries.paths;
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
