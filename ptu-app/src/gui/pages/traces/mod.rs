//! The page `traces`.

use eframe::egui::Ui;
use fault_db::Id;

use crate::gui::Desk;

/// The page.
#[derive(Default)]
pub struct TracesPage {
    chosen: Option<Id>,
}

impl TracesPage {
    /// Shows it.
    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        ui.heading(desk.words.traces.title);
    }

    /// Shows this one.
    pub fn open(&mut self, id: Id, _desk: &mut Desk<'_>) {
        self.chosen = Some(id);
    }
}
