//! A measured value between its limits, as a bar.

use btu_rig::procedure::{Measurement, Verdict};
use eframe::egui::{Color32, Rect, Response, Role, Sense, Stroke, Ui, WidgetInfo, vec2};

use crate::gui::Palette;

/// Size of the bar, points.
const SIZE: [f32; 2] = [150.0, 14.0];
/// Share of the bar beyond each limit.
const BEYOND: f64 = 0.25;

/// Value, unit and limits in words: `0.42 s (0.19 … 0.34)`.
pub fn value_text(measurement: &Measurement) -> String {
    let value = measurement.value.map_or_else(|| "?".to_owned(), short);
    let limits = match (measurement.low, measurement.high) {
        (None, None) => return format!("{value} {}", measurement.unit),
        (low, high) => {
            let limit = |limit: Option<f64>| limit.map_or_else(String::new, short);
            format!("({} … {})", limit(low), limit(high))
        }
    };
    format!("{value} {} {limits}", measurement.unit)
}

/// A number in at most four significant digits.
pub fn short(value: f64) -> String {
    let text = match value.abs() {
        big if big >= 1000.0 => format!("{value:.0}"),
        middle if middle >= 100.0 => format!("{value:.1}"),
        middle if middle >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    };
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Where value and limits lie on the bar, 0 to 1; none without a value or without any limit.
pub fn places(value: Option<f64>, low: Option<f64>, high: Option<f64>) -> Option<(f64, f64, f64)> {
    let value = value.filter(|value| value.is_finite())?;
    let (from, to) = match (low, high) {
        (Some(low), Some(high)) => (low, high),
        // One-sided: the bar begins or ends as far from the limit as zero or the value is.
        (Some(low), None) => (
            low,
            low + (value - low).abs().max(low.abs()).max(f64::MIN_POSITIVE),
        ),
        (None, Some(high)) => (
            high - (high - value).abs().max(high.abs()).max(f64::MIN_POSITIVE),
            high,
        ),
        (None, None) => return None,
    };
    let span = (to - from).max(f64::MIN_POSITIVE);
    let start = from - span * BEYOND;
    let place = |x: f64| ((x - start) / (span * (1.0 + 2.0 * BEYOND))).clamp(0.0, 1.0);
    Some((place(value), place(from), place(to)))
}

/// The bar: the band between the limits, a mark at the value.
pub fn limit_bar(ui: &mut Ui, measurement: &Measurement) -> Response {
    let palette = Palette::of(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(SIZE[0], SIZE[1]), Sense::hover());
    let label = format!("{} {}", measurement.name, value_text(measurement));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_inside_lies_in_the_band_and_one_outside_beyond_it() {
        let (value, low, high) = places(Some(0.3), Some(0.2), Some(0.4)).expect("places");
        assert!(low < value && value < high);
        let (value, _, high) = places(Some(0.62), Some(0.2), Some(0.4)).expect("places");
        assert!(value > high);
        let (value, low, _) = places(Some(-9e9), Some(0.2), Some(0.4)).expect("places");
        assert!(value < low && value >= 0.0, "stays on the bar");
    }

    #[test]
    fn one_limit_is_enough_and_none_gives_no_bar() {
        let (value, _, high) = places(Some(3.0), None, Some(2.0)).expect("places");
        assert!(value > high);
        let (value, low, _) = places(Some(3.0), Some(2.0), None).expect("places");
        assert!(value > low);
        assert_eq!(places(Some(1.0), None, None), None);
        assert_eq!(places(Some(f64::NAN), Some(0.0), Some(1.0)), None);
        assert!(
            places(Some(0.0), None, Some(0.0)).is_some(),
            "a limit of zero"
        );
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(short(0.42), "0.42");
        assert_eq!(short(3400.0), "3400");
        assert_eq!(short(31.612), "31.61");
        assert_eq!(short(-0.0504), "-0.05");
        assert_eq!(short(10.0), "10");
    }
}
