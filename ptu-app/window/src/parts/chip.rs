//! A word on a coloured background.

use btu_rig::procedure::Verdict;
use eframe::egui::{
    Button, Color32, Response, RichText, Role, Sense, TextWrapMode, Ui, WidgetInfo,
};

use crate::Palette;
use ptu_report::words::Words;

/// A word on a coloured ground.
pub fn chip(ui: &mut Ui, text: &str, colour: Color32) -> Response {
    let ground = colour.gamma_multiply(if ui.visuals().dark_mode { 0.22 } else { 0.15 });
    let words = RichText::new(text).color(colour).strong();
    // Its size is known before it is placed, so that it begins a new line rather than break its word.
    let chip = Button::new(words)
        .fill(ground)
        .corner_radius(4)
        .sense(Sense::hover())
        .wrap_mode(TextWrapMode::Extend);
    let response = ui.add(chip);
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, text));
    response
}

pub fn verdict_chip(ui: &mut Ui, verdict: Verdict, words: &Words) -> Response {
    let colour = Palette::of(ui).verdict(verdict);
    chip(ui, words.common.verdict(verdict), colour)
}
