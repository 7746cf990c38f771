//! One of a few, beside each other.

use eframe::egui::{Frame, Stroke, Ui};

use super::{Face, Look};
use crate::Palette;

/// Chooses one of these.
pub fn segments<'a, T: PartialEq>(
    ui: &mut Ui,
    chosen: &mut T,
    all: impl IntoIterator<Item = (T, &'a str)>,
) {
    let palette = Palette::of(ui);
    let line = Stroke::new(1.0, palette.grid);
    let frame = Frame::new().fill(palette.well).stroke(line);
    frame.corner_radius(6).show(ui, |ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        ui.horizontal(|ui| {
            for (value, name) in all {
                let look = match *chosen == value {
                    true => Look::Chosen,
                    false => Look::Quiet,
                };
                if Face::new(look, name).show(ui).clicked() {
                    *chosen = value;
                }
            }
        });
    });
}
