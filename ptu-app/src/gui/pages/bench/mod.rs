//! The page `bench`.

use eframe::egui::Ui;

use crate::gui::Desk;

/// The page.
#[derive(Default)]
pub struct BenchPage {}

impl BenchPage {
    /// Shows it.
    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        ui.heading(desk.words.bench.title);
    }
}
