//! Shows the latest trouble until it is acknowledged, the latest message, and all messages on demand.

use eframe::egui::{RichText, ScrollArea, TextWrapMode, Ui};

use crate::gui::messages::Message;
use crate::gui::{PageContext, Palette};
use ptu_bench::clock;

pub fn bar(ui: &mut Ui, context: &mut PageContext<'_>) {
    let all = context.messages.all();
    let Some(last) = all.last() else {
        let quiet = Palette::of(ui).quiet;
        ui.label(RichText::new(context.words.frame.title).color(quiet));
        return;
    };
    let mut clear = false;
    let mut noted = false;
    ui.horizontal(|ui| {
        let button = format!("{} ({})", context.words.frame.messages, all.len());
        ui.menu_button(button, |ui| {
            ui.set_min_width(560.0);
            ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                for message in all.iter().rev() {
                    ui.horizontal_wrapped(|ui| {
                        ui.label(RichText::new(clock::local(message.at_us)).small());
                        said(ui, message);
                    });
                }
            });
            clear = ui.button(context.words.frame.clear).clicked();
        });
        // There is one line; what is cut is told when it is pointed at, and in the menu.
        ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
        if let Some(trouble) = context.messages.unread_trouble() {
            noted = ui.button(context.words.frame.dismiss).clicked();
            said(ui, trouble);
        }
        // Trouble is shown until it was taken note of, and not again as the latest message.
        if !last.bad && !last.over {
            said(ui, last);
        }
    });
    if noted {
        context.messages.acknowledge();
    }
    if clear {
        context.messages.clear();
    }
}

fn said(ui: &mut Ui, message: &Message) {
    let palette = Palette::of(ui);
    let (mark, colour) = match message.bad {
        true => ("⚠ ", palette.bad),
        false => ("", ui.visuals().text_color()),
    };
    let text = format!("{mark}{}", message.text);
    ui.label(RichText::new(text).color(colour).strong());
    if !message.detail.is_empty() {
        ui.label(&message.detail);
    }
}
