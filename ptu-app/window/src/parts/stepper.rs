//! A list of steps: done, present and to come; a step that cannot be chosen shows the reason.

use eframe::egui::{
    Align2, Color32, FontId, Rect, Response, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2,
};
use egui_material_icons::icons::ICON_CHECK;

use super::{focus_ring, lane::cut_text};
use crate::{Palette, Sizes};

/// Radius of the circle around a number, and distance of its centre from the left edge, points.
const RADIUS: f32 = 14.0;
const MIDDLE: f32 = 24.0;
/// Left edge of a name, and the width of a step below which there is only its number, points.
const NAME: f32 = 50.0;
const NARROW: f32 = 100.0;

pub struct Step<'a> {
    pub number: usize,
    pub name: &'a str,
    /// Text below the name: the step's outcome, or why it cannot be chosen.
    pub below: &'a str,
    pub is_here: bool,
    pub is_done: bool,
    pub can_go: bool,
}

impl Step<'_> {
    pub fn show(&self, ui: &mut Ui, high: f32) -> Response {
        let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
        let sense = match self.can_go && !self.is_here {
            true => Sense::click(),
            false => Sense::hover(),
        };
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), high), sense);
        let on = ui.is_enabled() && (self.can_go || self.is_here);
        let name = format!("{} {}", self.number, self.name);
        response.widget_info(|| WidgetInfo::selected(Role::Button, on, self.is_here, &name));
        let painter = ui.painter();
        if self.is_here || (response.hovered() && on) {
            let ground = if self.is_here {
                palette.chosen
            } else {
                palette.hover
            };
            painter.rect_filled(rect, 6.0, ground);
        }
        let wide = rect.width() > NARROW;
        let x = if wide {
            rect.left() + MIDDLE
        } else {
            rect.center().x
        };
        self.number(ui, pos2(x, rect.center().y), &palette);
        let ink = if on { palette.ink } else { palette.quiet };
        if wide {
            let area = |y: f32| {
                let left = rect.left() + NAME;
                Rect::from_x_y_ranges(left..=rect.right() - 8.0, y - 12.0..=y + 12.0)
            };
            let two = !self.below.is_empty();
            let y = rect.center().y - if two { sizes.body * 0.55 } else { 0.0 };
            let font = FontId::proportional(sizes.body);
            cut_text(painter, area(y), self.name.to_owned(), font, ink);
            let y = rect.center().y + sizes.body * 0.65;
            let font = FontId::proportional(sizes.caption);
            cut_text(painter, area(y), self.below.to_owned(), font, palette.quiet);
        }
        focus_ring(ui, rect.shrink(3.0), &response);
        let said = if wide {
            self.below.to_owned()
        } else {
            format!("{name}: {}", self.below)
        };
        match said.is_empty() {
            true => response,
            false => response.on_hover_text(said),
        }
    }

    fn number(&self, ui: &Ui, middle: eframe::egui::Pos2, palette: &Palette) {
        let sizes = Sizes::of(ui);
        let painter = ui.painter();
        let (ground, ink) = match (self.is_here, self.is_done) {
            (true, _) => (palette.fill, Color32::WHITE),
            (false, true) => (palette.control, palette.second),
            (false, false) => (Color32::TRANSPARENT, palette.second),
        };
        painter.circle_filled(middle, RADIUS, ground);
        let line = Stroke::new(1.0, palette.edge);
        match (self.is_here || self.is_done, self.can_go) {
            (true, _) => {}
            (false, true) => {
                painter.circle_stroke(middle, RADIUS, line);
            }
            (false, false) => {
                let on_circle = |part: u8| {
                    let angle = f32::from(part) * std::f32::consts::TAU / 32.0;
                    middle + RADIUS * vec2(angle.cos(), angle.sin())
                };
                let circle: Vec<_> = (0..=32).map(on_circle).collect();
                painter.extend(Shape::dashed_line(&circle, line, 3.0, 3.0));
            }
        }
        let (text, font) = match self.is_done && !self.is_here {
            true => (
                ICON_CHECK.codepoint.to_owned(),
                FontId::new(sizes.icon * 0.8, ICON_CHECK.font_family()),
            ),
            false => (self.number.to_string(), FontId::proportional(sizes.caption)),
        };
        painter.text(middle, Align2::CENTER_CENTER, text, font, ink);
    }
}
