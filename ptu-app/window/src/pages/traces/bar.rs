//! The tool bar: axis, zoom, cursors and the trace shown behind.

use eframe::egui::{Button, RichText, Role, Ui, WidgetInfo};

use crate::{PageContext, Palette};
use ptu_report::trace_view::{Axis, Cursor, Kind, TracePlot};
use ptu_report::words::fill;

/// How much one press zooms.
pub const ZOOM: f64 = 0.7;

pub fn view(
    ui: &mut Ui,
    scene: &mut TracePlot,
    choosing: &mut bool,
    told: &mut bool,
    context: &mut PageContext<'_>,
) {
    let words = &context.words.traces;
    ui.horizontal_wrapped(|ui| {
        for (kind, name) in [
            (Kind::Time, words.over_time),
            (Kind::Distance, words.over_distance),
        ] {
            let chosen = scene.axis().kind() == kind;
            if ui.selectable_label(chosen, name).clicked() && !scene.set_axis(kind) {
                context.messages.note(words.no_distance);
            }
        }
        ui.separator();
        for (sign, name, times) in [
            ("−", words.zoom_out, 1.0 / ZOOM),
            ("+", words.zoom_in, ZOOM),
        ] {
            let button = ui.button(sign);
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
            if button.on_hover_text(name).clicked() {
                scene.remember();
                scene.camera().zoom(0.5, times);
            }
        }
        if ui.button(words.fit).clicked() {
            scene.remember();
            scene.camera().fit();
        }
        let back = ui.add_enabled(scene.can_zoom_back(), Button::new(words.zoom_back));
        if back.on_hover_text(words.zoom_back_hint).clicked() {
            scene.zoom_back();
        }
        ui.separator();
        for (cursor, name) in [(Cursor::A, words.cursor_a), (Cursor::B, words.cursor_b)] {
            if ui.button(name).on_hover_text(words.keys).clicked() {
                let middle = scene.window().at(0.5);
                scene.put(cursor, middle);
            }
        }
        if ui.button(words.clear_cursors).clicked() {
            scene.clear_cursors();
        }
        ui.separator();
        ui.toggle_value(scene.close(), words.close_axes)
            .on_hover_text(words.close_axes_hint);
        ui.toggle_value(choosing, words.signals);
        ui.toggle_value(told, words.statistics);
        if let Axis::Distance {
            rows_back, back_m, ..
        } = scene.axis()
            && *rows_back > 0
        {
            let seconds = *rows_back as f64 * scene.view().data().period_us as f64 / 1e6;
            let text = fill(
                words.moved_back,
                &[
                    ("metres", &format!("{back_m:.2}")),
                    ("seconds", &format!("{seconds:.1}")),
                ],
            );
            ui.label(RichText::new(text).color(Palette::of(ui).warn));
        }
    });
}

/// A place on the axis, as `−9.55 s`.
pub fn place(scene: &TracePlot, row: usize) -> String {
    length(scene, scene.axis().at(row))
}

/// A length on the axis.
pub fn length(scene: &TracePlot, length: f64) -> String {
    let text = match scene.axis().kind() {
        Kind::Time => format!("{length:.2} s"),
        Kind::Distance => format!("{length:.2} m"),
    };
    text.replace('-', "−")
}
