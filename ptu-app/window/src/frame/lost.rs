//! The row below the bar after the link was lost during a run: where the run broke off, and the button to continue it.

use eframe::egui::Ui;
use egui_material_icons::icons::{ICON_LINK, ICON_LINK_OFF};

use crate::parts::{ActionPlace, Face, Look};
use crate::{Destination, PageContext, Wanted};

/// Draws the row, if the chosen unit's run broke off; `goes_on` = the scripts are still those of the run.
pub fn row(ui: &mut Ui, goes_on: bool, context: &mut PageContext<'_>) {
    let words = context.words;
    let frame = &words.frame;
    let unit = context.units.chosen_mut();
    let Some((_, loss)) = unit.waiting_run() else {
        return;
    };
    let said = words.finding(loss);
    let place = ActionPlace::new(ui, "lost run", unit.id);
    let why_not = match (unit.is_other(), goes_on) {
        (true, _) => Some(frame.go_on_other),
        (false, false) => Some(frame.go_on_not),
        (false, true) => None,
    };
    ui.horizontal_wrapped(|ui| {
        Face::new(Look::Warned, said).icon(ICON_LINK_OFF).show(ui);
        match why_not {
            // The run cannot be continued; only the reason is shown.
            Some(why) => drop(ui.label(why)),
            None => {
                // Secondary, because the primary button belongs to the page below.
                let go_on = Face::new(Look::Secondary, frame.go_on).hint(frame.go_on_hint);
                if place.clicked(&go_on.icon(ICON_LINK).show(ui)) {
                    unit.connect(context.queries);
                    context.go_to.push(Destination::Run(Wanted::Rest));
                }
            }
        }
        if place.clicked(&Face::new(Look::Quiet, frame.end_run).show(ui)) {
            unit.end_run();
        }
    });
}
