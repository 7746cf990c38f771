//! A row of buttons, of which one is chosen.

use eframe::egui::{Frame, Stroke, Ui};

use super::{Face, Look};
use crate::Palette;

/// Draws the buttons; a click on one makes its value the chosen one.
pub fn segments<'a, T: PartialEq>(
    ui: &mut Ui,
    chosen: &mut T,
    all: impl IntoIterator<Item = (T, &'a str)>,
) {
    let palette = Palette::of(ui);
    let all: Vec<(T, Face<'_>)> = all
        .into_iter()
        .map(|(value, name)| {
            let look = match *chosen == value {
                true => Look::Chosen,
                false => Look::Quiet,
            };
            (value, Face::new(look, name))
        })
        .collect();
    // All segments stand in one line; if there is no room, in the next.
    let wide: f32 = all.iter().map(|(_, face)| face.wide(ui)).sum();
    if ui.layout().main_wrap() && wide > ui.available_size_before_wrap().x {
        ui.end_row();
    }
    let line = Stroke::new(1.0, palette.grid);
    let frame = Frame::new().fill(palette.well).stroke(line);
    frame.corner_radius(6).show(ui, |ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        ui.horizontal(|ui| {
            for (value, face) in all {
                if face.show(ui).clicked() {
                    *chosen = value;
                }
            }
        });
    });
}
