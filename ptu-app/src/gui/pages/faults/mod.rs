//! The page `faults`.

use eframe::egui::Ui;
use fault_db::Id;

use crate::gui::Desk;

/// The page.
#[derive(Default)]
pub struct FaultsPage {
    chosen: Option<Id>,
}

impl FaultsPage {
    /// Shows it.
    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        ui.heading(desk.words.faults.title);
    }

    /// Shows this one.
    pub fn open(&mut self, id: Id, _desk: &mut Desk<'_>) {
        self.chosen = Some(id);
    }
}
