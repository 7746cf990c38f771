//! The tool bar: axis, zoom, cursors and the trace shown behind.

use eframe::egui::{RichText, Ui};
use egui_material_icons::icons::{
    ICON_BACKSPACE, ICON_FIT_SCREEN, ICON_FUNCTIONS, ICON_HEIGHT, ICON_TUNE, ICON_UNDO,
    ICON_ZOOM_IN, ICON_ZOOM_OUT,
};

use crate::parts::{Face, Look, segments};
use crate::{PageContext, Palette, Sizes};
use ptu_report::trace_view::{Axis, Cursor, Kind, TracePlot};
use ptu_report::words::{Traces, fill};

/// Least width of the toolbar in which its buttons have words, multiples of the font size.
const WORDS: f32 = 62.0;
/// Factor of one zoom step.
pub const ZOOM: f64 = 0.7;

/// Draws axis, zoom and cursors; true if there is room for words on the buttons.
pub fn view(
    ui: &mut Ui,
    scene: &mut TracePlot,
    (choosing, told): (&mut bool, &mut bool),
    context: &mut PageContext<'_>,
) -> bool {
    let words = &context.words.traces;
    let mut kind = scene.axis.kind();
    let kinds = [
        (Kind::Time, words.over_time),
        (Kind::Distance, words.over_distance),
    ];
    segments(ui, &mut kind, kinds);
    if kind != scene.axis.kind() && !scene.set_axis(kind) {
        context.messages.note(words.no_distance);
    }
    let icon = |icon, name| Face::new(Look::Quiet, "").icon(icon).named(name).hint(name);
    for (sign, name, times) in [
        (ICON_ZOOM_OUT, words.zoom_out, 1.0 / ZOOM),
        (ICON_ZOOM_IN, words.zoom_in, ZOOM),
    ] {
        if icon(sign, name).show(ui).clicked() {
            scene.remember();
            scene.camera.zoom(0.5, times);
        }
    }
    if icon(ICON_FIT_SCREEN, words.fit).show(ui).clicked() {
        scene.remember();
        scene.camera.fit();
    }
    let back = icon(ICON_UNDO, words.zoom_back).hint(words.zoom_back_hint);
    let back = back.off((!scene.can_zoom_back()).then_some(""));
    if back.show(ui).clicked() {
        scene.zoom_back();
    }
    // Words beside the icons where there is room for them.
    let roomy = ui.max_rect().width() > WORDS * Sizes::of(ui).body;
    for (cursor, letter, name) in [
        (Cursor::A, "A", words.cursor_a),
        (Cursor::B, "B", words.cursor_b),
    ] {
        let face = Face::new(Look::Quiet, letter).named(name).hint(words.keys);
        if face.show(ui).clicked() {
            let middle = scene.window().at(0.5);
            scene.put(cursor, middle);
        }
    }
    if icon(ICON_BACKSPACE, words.clear_cursors).show(ui).clicked() {
        scene.clear_cursors();
    }
    let toggled = |ui: &mut Ui, on: &mut bool, sign, (said, name, hint)| {
        let look = if *on { Look::Chosen } else { Look::Quiet };
        let face = Face::new(look, said).icon(sign);
        *on ^= face.named(name).hint(hint).show(ui).clicked();
    };
    let close = ("", words.close_axes, words.close_axes_hint);
    toggled(ui, &mut scene.close, ICON_HEIGHT, close);
    for (on, sign, name) in [
        (choosing, ICON_TUNE, words.signals),
        (told, ICON_FUNCTIONS, words.statistics),
    ] {
        let said = if roomy { name } else { "" };
        toggled(ui, on, sign, (said, name, name));
    }
    roomy
}

/// Shows, on an axis of distance, how far the train moved backward; its rows then lie at the farthest point.
pub fn moved_back(ui: &mut Ui, scene: &TracePlot, words: &Traces) {
    if let Axis::Distance {
        rows_back, back_m, ..
    } = &scene.axis
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
}

/// A row's value on the axis as text, like `−9.55 s`.
pub fn place(scene: &TracePlot, row: usize) -> String {
    length(scene, scene.axis.at(row))
}

/// A length on the axis as text, s or m.
pub fn length(scene: &TracePlot, length: f64) -> String {
    let text = match scene.axis.kind() {
        Kind::Time => format!("{length:.2} s"),
        Kind::Distance => format!("{length:.2} m"),
    };
    text.replace('-', "−")
}
