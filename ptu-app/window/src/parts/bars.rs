//! Bar charts: over time with bars beside each other, by name with bars below each other.

use eframe::egui::{
    Align2, FontId, Rect, Role, Sense, StrokeKind, TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use super::focus_ring;
use super::lane::{cut_text, y_at, y_axis};
use crate::Palette;
use ptu_report::limits::short;
use ptu_report::naming::DOT;

/// Height of a chart over time, and of a row of a chart by name, points.
const HEIGHT: f32 = 180.0;
const ROW: f32 = 30.0;
/// Greatest share of the width for names; gap between a bar and its text, points.
const NAMES: f32 = 0.35;
const BESIDE: f32 = 8.0;
/// Width for the values at the axis, and height for the names below the axis, points.
const GUTTER: f32 = 40.0;
const BELOW: f32 = 20.0;
/// Height of the chart divided by the height of the highest bar; the bar's value stands above the bar.
const ABOVE: f64 = 1.15;
/// Least upper end of an axis of counts; a shorter axis would show halves.
const LEAST: f64 = 5.0;

pub struct Bar {
    pub name: String,
    /// Count, or rate.
    pub value: f64,
    /// Text after the value.
    pub more: String,
}

/// A chart, each bar of which can be clicked.
pub struct Chart<'a> {
    pub title: &'a str,
    /// The bars are counts, whose sum a screen reader reads.
    pub sums: bool,
}

impl Bar {
    pub fn new(name: impl Into<String>, count: u64) -> Self {
        Self {
            name: name.into(),
            value: count as f64,
            more: String::new(),
        }
    }

    fn said(&self) -> String {
        let more = if self.more.is_empty() { "" } else { DOT };
        format!("{}{more}{}", short(self.value), self.more)
    }
}

impl Chart<'_> {
    /// Draws bars beside each other, with their names where there is room; index of the bar that was clicked.
    pub fn in_time(&self, ui: &mut Ui, bars: &[Bar]) -> Option<usize> {
        let rect = self.frame(ui, HEIGHT, bars)?;
        let palette = Palette::of(ui);
        let small = TextStyle::Small.resolve(ui.style());
        let plot = Rect::from_min_max(rect.min + vec2(GUTTER, 0.0), rect.max - vec2(0.0, BELOW));
        let gutter = Rect::from_min_max(rect.min, plot.left_bottom());
        let least = if self.sums { LEAST } else { 0.0 };
        let range = (0.0, (ABOVE * f64::from(most(bars))).max(least));
        y_axis(ui.painter(), gutter, plot, range, &palette);
        let step = plot.width() / bars.len() as f32;
        let named = |name: &str| {
            let font = small.clone();
            let laid = ui
                .painter()
                .layout_no_wrap(name.to_owned(), font, palette.quiet);
            laid.size().x
        };
        let widest = bars.iter().map(|bar| named(&bar.name)).fold(1.0, f32::max);
        let each = ((widest + BESIDE) / step).ceil().max(1.0) as usize;
        let mut clicked = None;
        for (place, bar) in bars.iter().enumerate() {
            let left = plot.left() + step * place as f32;
            let column = Rect::from_x_y_ranges(left..=left + step, plot.y_range());
            let inner = column.shrink2(vec2((step * 0.15).max((step - 50.0) / 2.0), 0.0));
            let top = y_at(plot, range, bar.value);
            ui.painter()
                .rect_filled(inner.with_min_y(top), 2.0, palette.accent);
            let text = |y, align, text: &str, ink| {
                let at = pos2(column.center().x, y);
                ui.painter().text(at, align, text, small.clone(), ink);
            };
            if step > named("0000") {
                let value = short(bar.value);
                text(top, Align2::CENTER_BOTTOM, &value, palette.ink);
            }
            if place % each == 0 {
                let name = (rect.bottom(), Align2::CENTER_BOTTOM);
                text(name.0, name.1, &bar.name, palette.quiet);
            }
            if self.is_clicked(ui, column, (place, bar)) {
                clicked = Some(place);
            }
        }
        clicked
    }

    /// Draws bars below each other, each with its name and value; index of the bar that was clicked.
    pub fn by_name(&self, ui: &mut Ui, bars: &[Bar]) -> Option<usize> {
        let rect = self.frame(ui, ROW * bars.len() as f32, bars)?;
        let (palette, most) = (Palette::of(ui), most(bars));
        let [body, small] =
            [TextStyle::Body, TextStyle::Small].map(|style| style.resolve(ui.style()));
        let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
        let wide = |text: String, font: &FontId| {
            let laid = painter.layout_no_wrap(text, font.clone(), palette.ink);
            laid.size().x + BESIDE
        };
        let widest = |of: &dyn Fn(&Bar) -> f32| bars.iter().map(of).fold(0.0, f32::max);
        let names = widest(&|bar| wide(bar.name.clone(), &body)).min(NAMES * rect.width());
        let counts = widest(&|bar| wide(short(bar.value), &body));
        let more = widest(&|bar| wide(bar.more.clone(), &small));
        let left = rect.left() + names;
        let room = (rect.right() - more - counts - left).max(1.0);
        let mut clicked = None;
        for (place, bar) in bars.iter().enumerate() {
            let top = rect.top() + ROW * place as f32;
            let line = Rect::from_x_y_ranges(rect.x_range(), top..=top + ROW);
            let of_name = line.with_max_x(left - BESIDE);
            cut_text(
                &painter,
                of_name,
                bar.name.clone(),
                body.clone(),
                palette.ink,
            );
            let end = left + room * (bar.value as f32 / most).min(1.0);
            let filled = Rect::from_x_y_ranges(left..=end, line.shrink(5.0).y_range());
            painter.rect_filled(filled, 2.0, palette.accent);
            let text = |x, align, text: String, font: &FontId, ink| {
                painter.text(pos2(x, line.center().y), align, text, font.clone(), ink);
            };
            let count = (end + BESIDE, Align2::LEFT_CENTER);
            text(count.0, count.1, short(bar.value), &body, palette.ink);
            let right = (line.right(), Align2::RIGHT_CENTER);
            text(right.0, right.1, bar.more.clone(), &small, palette.quiet);
            if self.is_clicked(ui, line.shrink2(vec2(0.0, 1.0)), (place, bar)) {
                clicked = Some(place);
            }
        }
        clicked
    }

    /// Area of a chart, named for screen readers; none if it is out of view or has no bars.
    fn frame(&self, ui: &mut Ui, height: f32, bars: &[Bar]) -> Option<Rect> {
        let size = vec2(ui.available_width(), height);
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let sum: f64 = bars.iter().map(|bar| bar.value).sum();
        let name = match self.sums {
            true => format!("{}: {sum}", self.title),
            false => self.title.to_owned(),
        };
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
        (ui.is_rect_visible(rect) && !bars.is_empty()).then_some(rect)
    }

    fn is_clicked(&self, ui: &Ui, rect: Rect, (place, bar): (usize, &Bar)) -> bool {
        let id = ui.scope_id().with((self.title, place));
        let name = format!("{}: {}", bar.name, bar.said());
        let response = ui.interact(rect, id, Sense::click()).on_hover_text(&name);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        if response.hovered() {
            let stroke = ui.visuals().widgets.hovered.bg_stroke;
            ui.painter()
                .rect_stroke(rect, 2.0, stroke, StrokeKind::Inside);
        }
        focus_ring(ui, rect.shrink(3.0), &response);
        response.clicked()
    }
}

fn most(bars: &[Bar]) -> f32 {
    let most = bars.iter().map(|bar| bar.value).fold(0.0, f64::max);
    if most > 0.0 { most as f32 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Shape;
    use eframe::egui::epaint::ClippedShape;
    use egui_kittest::Harness;

    #[test]
    fn no_digit_of_a_count_is_cut() {
        let chart = Chart {
            title: "faults",
            sums: true,
        };
        let bars = [Bar::new("EB relay", 4347), Bar::new("other", 1)];
        let harness = Harness::new_ui(|ui| {
            ui.set_width(300.0);
            chart.by_name(ui, &bars);
        });
        let counted = |seen: &&ClippedShape| matches!(&seen.shape, Shape::Text(text) if text.galley.text() == "4347");
        let seen = harness.output().shapes.iter().find(counted);
        let ClippedShape {
            clip_rect, shape, ..
        } = seen.expect("the count");
        assert!(clip_rect.contains_rect(shape.visual_bounding_rect()));
    }
}
