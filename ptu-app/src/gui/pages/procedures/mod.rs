//! The page `procedures`.

use eframe::egui::Ui;

use crate::gui::Desk;

/// The page.
#[derive(Default)]
pub struct ProceduresPage {}

impl ProceduresPage {
    /// Shows it.
    pub fn show(&mut self, ui: &mut Ui, desk: &mut Desk<'_>) {
        ui.heading(desk.words.procedures.title);
    }

    /// Runs this step, or all of a procedure.
    pub fn run_step(&mut self, _procedure: &str, _step: Option<&str>, _desk: &mut Desk<'_>) {}
}
