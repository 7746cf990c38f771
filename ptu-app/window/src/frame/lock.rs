//! The lock between two shifts: until a person gives a name, the window only shows what is under way and can stop
//! everything. The name is no password.

use eframe::egui::{Button, Color32, Key, RichText, Ui};

use crate::parts::{ActionPlace, name_edit};
use crate::{PageContext, Palette, Sizes};

/// Width of the field for a name, points.
const NAME: f32 = 220.0;
/// Opacity of disabled parts, 0 to 1: they must remain readable.
const STRENGTH: f32 = 0.75;

/// Makes the rest of `ui` readable and not clickable.
pub fn only_look(ui: &mut Ui) {
    let quiet = Palette::of(ui).quiet;
    let visuals = ui.visuals_mut();
    visuals.disabled_alpha = STRENGTH;
    // A button without background does not look as if it could be clicked.
    let widgets = &mut visuals.widgets;
    for widget in [
        &mut widgets.inactive,
        &mut widgets.hovered,
        &mut widgets.active,
    ] {
        widget.weak_bg_fill = Color32::TRANSPARENT;
        widget.fg_stroke.color = quiet;
    }
    ui.disable();
}

/// Says that the window is locked, and takes the name that unlocks it.
pub fn bar(ui: &mut Ui, context: &mut PageContext<'_>) {
    let words = &context.words.frame;
    let sizes = Sizes::of(ui);
    let settings = &mut *context.settings;
    ui.label(
        RichText::new(words.locked)
            .size(sizes.lead)
            .color(Palette::of(ui).warn)
            .strong(),
    );
    ui.horizontal_wrapped(|ui| {
        let label = ui.label(context.words.case.your_name);
        let edit = name_edit(&mut settings.operator, NAME);
        let name = ui.add(edit).labelled_by(label.id);
        let entered = name.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let named = !settings.operator.trim().is_empty();
        let place = ActionPlace::new(ui, "lock", named);
        let opened = ui.add_enabled(named, Button::new(words.unlock));
        if named && (entered || place.clicked(&opened)) {
            settings.unlock();
        }
        ui.label(RichText::new(words.lock_is_no_password).color(Palette::of(ui).quiet));
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Shape;
    use egui_kittest::Harness;

    #[test]
    fn a_locked_button_has_no_ground_as_one_that_works_has() {
        let grounds = |locked: bool| {
            let harness = Harness::new_ui(move |ui| {
                if locked {
                    only_look(ui);
                }
                ui.add(Button::new("Arm"));
            });
            let shapes = harness.output().shapes.iter().map(|seen| &seen.shape);
            let filled = |shape: &&Shape| matches!(shape, Shape::Rect(rect) if rect.fill != Color32::TRANSPARENT);
            shapes.filter(filled).count()
        };
        assert!(grounds(true) < grounds(false));
    }
}
