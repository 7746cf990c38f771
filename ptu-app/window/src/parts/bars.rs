//! Charts of bars: beside each other in time, or below each other by name.

use eframe::egui::{
    Align2, FontId, Rect, Role, Sense, StrokeKind, TextStyle, Ui, WidgetInfo, pos2, vec2,
};

use super::lane::cut_text;
use crate::Palette;
use ptu_report::limits::short;

const HEIGHT: f32 = 86.0;
/// Rows of a low chart by name.
const ROWS: f32 = 7.0;
/// Height of a row that leads somewhere, points.
const TARGET: f32 = 30.0;
/// Room a name takes in a low chart by name.
const NAME: f32 = 120.0;
/// Between a bar and what is said behind it.
const BESIDE: f32 = 3.0;
/// Room for what is said behind the count of a bar.
const MORE: f32 = 210.0;

/// A bar.
pub struct Bar {
    pub name: String,
    /// What it counts, or a rate.
    pub value: f64,
    /// Said behind the count.
    pub more: String,
}

/// A chart.
pub struct Chart<'a> {
    pub title: &'a str,
    pub width: f32,
    /// Each bar can be clicked.
    pub leads: bool,
    /// Its bars are counts, whose sum says something.
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
        let more = if self.more.is_empty() { "" } else { " · " };
        format!("{}{more}{}", short(self.value), self.more)
    }
}

impl Chart<'_> {
    /// Bars beside each other, the first and the last with their names; the place of the one that was clicked.
    pub fn in_time(&self, ui: &mut Ui, bars: &[Bar]) -> Option<usize> {
        let rect = self.frame(ui, HEIGHT, bars)?;
        let palette = Palette::of(ui);
        let small = TextStyle::Small.resolve(ui.style());
        let most = most(bars);
        let plot = Rect::from_min_max(rect.min, rect.max - vec2(0.0, 14.0));
        let step = plot.width() / bars.len() as f32;
        let mut clicked = None;
        for (place, bar) in bars.iter().enumerate() {
            let left = plot.left() + step * place as f32;
            let right = left + (step - 1.0).clamp(1.0, 40.0);
            let column = Rect::from_x_y_ranges(left..=right, plot.y_range());
            let top = plot.bottom() - plot.height() * bar.value as f32 / most;
            let filled = Rect::from_x_y_ranges(left..=right, top..=plot.bottom());
            ui.painter().rect_filled(filled, 0.0, palette.accent);
            if self.is_clicked(ui, column, (place, bar)) {
                clicked = Some(place);
            }
        }
        let text = |at, align, text: &str| {
            ui.painter()
                .text(at, align, text, small.clone(), palette.quiet);
        };
        let name = |bar: Option<&Bar>| bar.map_or_else(String::new, |bar| bar.name.clone());
        text(rect.left_bottom(), Align2::LEFT_BOTTOM, &name(bars.first()));
        if bars.len() > 1 {
            text(
                rect.right_bottom(),
                Align2::RIGHT_BOTTOM,
                &name(bars.last()),
            );
        }
        text(plot.right_top(), Align2::RIGHT_TOP, &short(most.into()));
        clicked
    }

    /// Bars below each other, each with its name and count; the place of the one that was clicked.
    pub fn by_name(&self, ui: &mut Ui, bars: &[Bar]) -> Option<usize> {
        let (high, row) = match self.leads {
            true => (TARGET * bars.len() as f32, TARGET),
            false => (HEIGHT, HEIGHT / ROWS),
        };
        let rect = self.frame(ui, high, bars)?;
        let palette = Palette::of(ui);
        let ink = ui.visuals().text_color();
        let font = self.font(ui);
        let most = most(bars);
        let name = if self.leads { rect.width() / 3.0 } else { NAME };
        let left = rect.left() + name.min(rect.width() / 2.0);
        let says_more = bars.iter().any(|bar| !bar.more.is_empty());
        let said = |bar: &Bar| {
            let painter = ui.painter();
            let laid = painter.layout_no_wrap(bar.said(), font.clone(), palette.quiet);
            laid.size().x
        };
        let widest = bars.iter().map(said).fold(0.0, f32::max) + 2.0 * BESIDE;
        let room = rect.right() - left - if says_more { MORE.max(widest) } else { widest };
        let mut clicked = None;
        for (place, bar) in bars.iter().enumerate() {
            let top = rect.top() + row * place as f32;
            let line = Rect::from_x_y_ranges(rect.x_range(), top..=top + row);
            let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
            let of_name = Rect::from_x_y_ranges(rect.left()..=left - 4.0, line.y_range());
            cut_text(&painter, of_name, bar.name.clone(), font.clone(), ink);
            let length = room.max(1.0) * (bar.value as f32 / most).min(1.0);
            let size = vec2(length, row - 3.0);
            let filled = Rect::from_min_size(pos2(left, line.center().y - size.y / 2.0), size);
            painter.rect_filled(filled, 0.0, palette.accent);
            let end = pos2(filled.right() + BESIDE, line.center().y);
            painter.text(
                end,
                Align2::LEFT_CENTER,
                bar.said(),
                font.clone(),
                palette.quiet,
            );
            if self.is_clicked(ui, line.shrink2(vec2(0.0, 1.0)), (place, bar)) {
                clicked = Some(place);
            }
        }
        clicked
    }

    fn font(&self, ui: &Ui) -> FontId {
        match self.leads {
            true => TextStyle::Body.resolve(ui.style()),
            false => TextStyle::Small.resolve(ui.style()),
        }
    }

    /// Title and room of a chart.
    fn frame(&self, ui: &mut Ui, height: f32, bars: &[Bar]) -> Option<Rect> {
        let size = vec2(self.width, height + 18.0);
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let sum: f64 = bars.iter().map(|bar| bar.value).sum();
        let name = match self.sums {
            true => format!("{}: {sum}", self.title),
            false => self.title.to_owned(),
        };
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
        if !ui.is_rect_visible(rect) || bars.is_empty() {
            return None;
        }
        let small = TextStyle::Small.resolve(ui.style());
        let quiet = Palette::of(ui).quiet;
        ui.painter()
            .text(rect.min, Align2::LEFT_TOP, self.title, small, quiet);
        Some(Rect::from_min_max(rect.min + vec2(0.0, 18.0), rect.max))
    }

    fn is_clicked(&self, ui: &Ui, rect: Rect, (place, bar): (usize, &Bar)) -> bool {
        if !self.leads {
            return false;
        }
        let id = ui.scope_id().with((self.title, place));
        let name = format!("{}: {}", bar.name, bar.said());
        let response = ui.interact(rect, id, Sense::click()).on_hover_text(&name);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        if response.hovered() || response.has_focus() {
            let stroke = ui.visuals().widgets.hovered.bg_stroke;
            ui.painter()
                .rect_stroke(rect, 2.0, stroke, StrokeKind::Inside);
        }
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
            width: 300.0,
            leads: false,
            sums: true,
        };
        let bars = [Bar::new("EB relay", 4347), Bar::new("other", 1)];
        let harness = Harness::new_ui(|ui| {
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
