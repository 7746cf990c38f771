//! A measured value between its limits, as a bar.

use btu_rig::procedure::{Measurement, Verdict};
use eframe::egui::{
    Align2, FontId, Rect, Response, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2,
};

use crate::{Palette, Sizes};
use ptu_report::limits::{limits_text, places, short};
use ptu_report::ticks::Ticks;
use ptu_report::words::Words;

/// Size of the bar, points.
const SIZE: [f32; 2] = [100.0, 14.0];

/// Value, unit and limits in words: `0.42 s (0.19 to 0.34)`.
pub fn value_text(measurement: &Measurement, words: &Words) -> String {
    let unit = words.unit(measurement.unit);
    let value = measurement.value.map_or_else(|| "?".to_owned(), short);
    match limits_text(words, measurement.low, measurement.high) {
        nothing if nothing.is_empty() => format!("{value} {unit}"),
        limits => format!("{value} {unit} ({limits})"),
    }
}

/// Draws a small bar: the band between the limits, and a mark at the value.
pub fn limit_bar(
    ui: &mut Ui,
    words: &Words,
    (name, measurement): (&str, &Measurement),
) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(SIZE[0], SIZE[1]), Sense::hover());
    let label = format!("{name} {}", value_text(measurement, words));
    response.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &label));
    limits_within(ui, rect, measurement);
    response
}

/// Paints the bar in this area.
pub fn limits_within(ui: &Ui, rect: Rect, measurement: &Measurement) {
    let palette = Palette::of(ui);
    let Some((value, low, high)) = places(measurement.value, measurement.low, measurement.high)
    else {
        return;
    };
    let x = |place: f64| rect.left() + rect.width() * place as f32;
    let painter = ui.painter();
    let middle = rect.shrink2(vec2(0.0, 4.0));
    painter.rect_filled(middle, 2.0, palette.grid);
    let band = Rect::from_x_y_ranges(x(low)..=x(high), middle.y_range());
    painter.rect_filled(band, 2.0, palette.edge);
    let colour = match measurement.verdict {
        Verdict::Passed => ui.visuals().strong_text_color(),
        _ => palette.bad,
    };
    painter.vline(x(value), rect.y_range(), Stroke::new(3.0, colour));
}

/// Draws a bar over the whole width, with ticks, and above it the limits as text and the value.
pub fn limit_scale(ui: &mut Ui, words: &Words, (name, measurement): (&str, &Measurement)) {
    let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
    let high = 2.0 * sizes.lead + sizes.caption + 14.0;
    let size = vec2(ui.available_width(), high);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let label = format!("{name} {}", value_text(measurement, words));
    response.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &label));
    let Some(value) = measurement.value.filter(|value| value.is_finite()) else {
        return;
    };
    let limits = (measurement.low, measurement.high);
    let (from, to) = span(value, limits);
    let x = |at: f64| rect.left() + rect.width() * ((at - from) / (to - from)) as f32;
    let painter = ui.painter();
    let bar = Rect::from_x_y_ranges(
        rect.x_range(),
        rect.top() + 1.4 * sizes.lead..=rect.top() + 1.4 * sizes.lead + 14.0,
    );
    painter.rect_filled(bar, 3.0, palette.grid);
    let ends = (limits.0.unwrap_or(from), limits.1.unwrap_or(to));
    let part = |low: f64, high: f64, colour| {
        let part = Rect::from_x_y_ranges(x(low)..=x(high), bar.y_range());
        painter.rect_filled(part, 3.0, colour);
    };
    part(ends.0, ends.1, palette.edge);
    let excess = palette.bad.gamma_multiply(0.35);
    if value > ends.1 {
        part(ends.1, value, excess);
    } else if value < ends.0 {
        part(value, ends.0, excess);
    }
    let caption = FontId::proportional(sizes.caption);
    let beyond = value < ends.0 || value > ends.1;
    let ink = if beyond { palette.bad } else { palette.ink };
    let said = format!("{} {}", short(value), words.unit(measurement.unit));
    let text = |at, align, text, font, ink| painter.text(at, align, text, font, ink);
    let lead = FontId::proportional(sizes.lead);
    let half = painter
        .layout_no_wrap(said.clone(), lead.clone(), ink)
        .size()
        .x
        / 2.0;
    let middle = x(value).clamp(rect.left() + half, rect.right() - half);
    let of_value = text(
        pos2(middle, bar.top() - 4.0),
        Align2::CENTER_BOTTOM,
        said,
        lead,
        ink,
    );
    for limit in [limits.0, limits.1].into_iter().flatten() {
        let line = bar.expand2(vec2(0.0, 6.0)).y_range();
        painter.vline(x(limit), line, Stroke::new(2.0, palette.ink));
    }
    let allowed = limits_text(words, limits.0, limits.1);
    let at = pos2(of_value.left() - 12.0, bar.top() - 8.0);
    let (at, align) = match at.x - rect.left() > 120.0 {
        true => (at, Align2::RIGHT_BOTTOM),
        false => (pos2(of_value.right() + 12.0, at.y), Align2::LEFT_BOTTOM),
    };
    text(at, align, allowed, caption.clone(), palette.second);
    let ticks = Ticks::of((from, to), 5.0);
    for tick in ticks.values() {
        let near = |end: f64| (tick - end).abs() < 1e-6 * (to - from);
        let align = match (near(from), near(to)) {
            (true, _) => Align2::LEFT_TOP,
            (_, true) => Align2::RIGHT_TOP,
            _ => Align2::CENTER_TOP,
        };
        let at = pos2(x(tick), bar.bottom() + 4.0);
        let unit = if align == Align2::RIGHT_TOP {
            words.unit(measurement.unit)
        } else {
            ""
        };
        let said = format!("{} {unit}", ticks.written(tick));
        text(
            at,
            align,
            said.trim_end().to_owned(),
            caption.clone(),
            palette.quiet,
        );
    }
    painter.vline(
        x(value),
        bar.expand2(vec2(0.0, 4.0)).y_range(),
        Stroke::new(6.0, ink),
    );
}

/// Round ends of the scale, beyond the least and the greatest of value and limits; it begins at 0 if none is negative.
fn span(value: f64, (low, high): (Option<f64>, Option<f64>)) -> (f64, f64) {
    let ends = [Some(value), low, high];
    let least = ends.into_iter().flatten().fold(0.0, f64::min);
    let most = ends.into_iter().flatten().fold(f64::MIN, f64::max);
    let from = if least < 0.0 { 1.25 * least } else { 0.0 };
    let to = if most > 0.0 { 1.25 * most } else { 0.75 * most };
    let to = to.max(from + f64::MIN_POSITIVE);
    let step = 10_f64.powf((to - from).log10().floor()) / 2.0;
    ((from / step).floor() * step, (to / step).ceil() * step)
}
