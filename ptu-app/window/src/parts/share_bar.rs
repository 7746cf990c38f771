//! A share as a bar with its percentage.

use eframe::egui::{Align2, Color32, Rect, Response, Role, Sense, TextStyle, Ui, WidgetInfo, vec2};

use crate::Palette;

const WIDTH: f32 = 110.0;

/// Draws a share, 0 to 1, as a bar.
pub fn share_bar(ui: &mut Ui, share: f64, colour: Color32) -> Response {
    let height = ui.text_style_height(&TextStyle::Body) + 4.0;
    let (rect, response) = ui.allocate_exact_size(vec2(WIDTH, height), Sense::hover());
    let text = format!("{:.1} %", 100.0 * share);
    response.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &text));
    let painter = ui.painter();
    painter.rect_filled(rect, 3.0, Palette::of(ui).grid);
    let filled = vec2(rect.width() * share.clamp(0.0, 1.0) as f32, rect.height());
    painter.rect_filled(
        Rect::from_min_size(rect.min, filled),
        3.0,
        colour.gamma_multiply(0.6),
    );
    let font = TextStyle::Body.resolve(ui.style());
    let ink = ui.visuals().strong_text_color();
    painter.text(rect.center(), Align2::CENTER_CENTER, text, font, ink);
    response
}
