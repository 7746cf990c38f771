//! The latest message, and all of them on demand.

use eframe::egui::{RichText, ScrollArea, Ui};

use crate::gui::{Desk, Palette};

/// The bar.
pub fn bar(ui: &mut Ui, desk: &mut Desk<'_>) {
    let palette = Palette::of(ui);
    let Some(last) = desk.messages.all().last() else {
        ui.label(RichText::new(desk.words.frame.title).color(palette.quiet));
        return;
    };
    let said = |ui: &mut Ui, message: &crate::gui::desk::Message| {
        let colour = if message.bad {
            palette.bad
        } else {
            ui.visuals().text_color()
        };
        let mark = if message.bad { "⚠ " } else { "" };
        ui.label(
            RichText::new(format!("{mark}{}", message.text))
                .color(colour)
                .strong(),
        );
        if !message.detail.is_empty() {
            ui.label(&message.detail);
        }
    };
    let mut clear = false;
    ui.horizontal(|ui| {
        ui.menu_button(
            format!(
                "{} ({})",
                desk.words.frame.messages,
                desk.messages.all().len()
            ),
            |ui| {
                ui.set_min_width(560.0);
                ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                    for message in desk.messages.all().iter().rev() {
                        ui.horizontal_wrapped(|ui| said(ui, message));
                    }
                });
                clear = ui.button(desk.words.frame.clear).clicked();
            },
        );
        said(ui, last);
    });
    if clear {
        desk.messages.clear();
    }
}
