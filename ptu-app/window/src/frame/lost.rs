//! The row below the bar after a link was lost in a run: where it broke off, and how it goes on.

use eframe::egui::{Button, RichText, Ui};

use crate::parts::ActionPlace;
use crate::{Destination, PageContext, Palette};

/// The row, if the chosen unit's run broke off so; `goes_on` = its scripts are still those of the run.
pub fn row(ui: &mut Ui, goes_on: bool, context: &mut PageContext<'_>) {
    let words = context.words;
    let frame = &words.frame;
    let unit = context.units.chosen_mut();
    let Some((_, loss)) = unit.waiting_run() else {
        return;
    };
    let said = format!("⚠ {}", words.finding(loss));
    let place = ActionPlace::new(ui, "lost run", unit.id);
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(said).color(Palette::of(ui).warn).strong());
        let reconnect = ui.add_enabled(goes_on, Button::new(frame.go_on));
        if place.clicked(&reconnect.on_hover_text(frame.go_on_hint)) {
            unit.connect(context.queries);
            context.go_to.push(Destination::GoOn);
        }
        if place.clicked(&ui.button(frame.end_run)) {
            unit.end_run();
        }
        if !goes_on {
            ui.label(frame.go_on_not);
        }
    });
}
