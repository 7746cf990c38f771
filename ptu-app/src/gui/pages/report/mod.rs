//! The page `report`.

use eframe::egui::Ui;
use fault_db::Id;

use crate::gui::Desk;

/// The page.
#[derive(Default)]
pub struct ReportPage {
    chosen: Option<Id>,
}

impl ReportPage {
    /// Shows it.
    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        ui.heading(desk.words.report.title);
    }

    /// Shows this one.
    pub fn open(&mut self, run: Id, _desk: &mut Desk<'_>) {
        self.chosen = Some(run);
    }
}
