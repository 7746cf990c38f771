//! A word on a coloured background.

use btu_rig::procedure::Verdict;
use eframe::egui::{Color32, Frame, Margin, Response, RichText, Ui};

use crate::gui::Palette;
use ptu_report::words::Words;

/// A word on a coloured ground.
pub fn chip(ui: &mut Ui, text: &str, colour: Color32) -> Response {
    let ground = colour.gamma_multiply(if ui.visuals().dark_mode { 0.22 } else { 0.15 });
    Frame::new()
        .fill(ground)
        .corner_radius(4)
        .inner_margin(Margin::symmetric(6, 1))
        .show(ui, |ui| {
            ui.label(RichText::new(text).color(colour).strong())
        })
        .inner
}

pub fn verdict_chip(ui: &mut Ui, verdict: Verdict, words: &Words) -> Response {
    let colour = Palette::of(ui).verdict(verdict);
    chip(ui, words.common.verdict(verdict), colour)
}
