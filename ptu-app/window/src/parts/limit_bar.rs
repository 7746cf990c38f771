//! A measured value between its limits, as a bar.

use btu_rig::procedure::{Measurement, Verdict};
use eframe::egui::{Color32, Rect, Response, Role, Sense, Stroke, Ui, WidgetInfo, vec2};

use crate::Palette;
use ptu_report::limits::{places, short};
use ptu_report::words::Words;

/// Size of the bar, points.
const SIZE: [f32; 2] = [150.0, 14.0];

/// Value, unit and limits in words: `0.42 s (0.19 … 0.34)`.
pub fn value_text(measurement: &Measurement, words: &Words) -> String {
    let unit = words.unit(measurement.unit);
    let value = measurement.value.map_or_else(|| "?".to_owned(), short);
    let limits = match (measurement.low, measurement.high) {
        (None, None) => return format!("{value} {unit}"),
        (low, high) => {
            let limit = |limit: Option<f64>| limit.map_or_else(String::new, short);
            format!("({} … {})", limit(low), limit(high))
        }
    };
    format!("{value} {unit} {limits}")
}

/// The bar: the band between the limits, a mark at the value.
pub fn limit_bar(
    ui: &mut Ui,
    words: &Words,
    (name, measurement): (&str, &Measurement),
) -> Response {
    let palette = Palette::of(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(SIZE[0], SIZE[1]), Sense::hover());
    let label = format!("{name} {}", value_text(measurement, words));
    response.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &label));
    let Some((value, low, high)) = places(measurement.value, measurement.low, measurement.high)
    else {
        return response;
    };
    let x = |place: f64| rect.left() + rect.width() * place as f32;
    let painter = ui.painter();
    let middle = rect.shrink2(vec2(0.0, 4.0));
    painter.rect_filled(middle, 2.0, palette.grid);
    let band = Rect::from_x_y_ranges(x(low)..=x(high), middle.y_range());
    painter.rect_filled(band, 2.0, palette.good.gamma_multiply(0.45));
    let colour = match measurement.verdict {
        Verdict::Passed => ui.visuals().strong_text_color(),
        _ => palette.bad,
    };
    mark(ui, rect, x(value), colour);
    response
}

fn mark(ui: &Ui, rect: Rect, x: f32, colour: Color32) {
    ui.painter()
        .vline(x, rect.y_range(), Stroke::new(3.0, colour));
}
