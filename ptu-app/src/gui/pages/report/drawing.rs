//! Draws a plot in the window from the same marks as on the HTML page and in the PDF.

use eframe::egui::epaint::TextShape;
use eframe::egui::{
    Color32, FontId, Id, Pos2, Rect, Role as WidgetRole, Sense, Shape, Stroke, StrokeKind, Ui,
    WidgetInfo, pos2, vec2,
};

use crate::gui::Palette;
use ptu_report::plot::{Anchor, Mark, Role};

/// Size of words, and radius of a dot, points.
const SIZE: f32 = 12.0;
const DOT: f32 = 2.0;
/// Length of a dash and of the gap after it, points.
const DASH: f32 = 5.0;
const GAP: f32 = 4.0;

/// Draws all marks from the upper left corner of `rect`.
pub fn plot(ui: &Ui, id: Id, rect: Rect, title: &str, marks: &[Mark]) {
    let response = ui.interact(rect, id, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(WidgetRole::Image, true, title));
    let look = Look {
        palette: Palette::of(ui),
        ink: ui.visuals().text_color(),
        strong: ui.visuals().strong_text_color(),
        corner: rect.min,
    };
    let painter = ui.painter();
    for mark in marks {
        match mark {
            Mark::Text { .. } => look.text(ui, mark),
            Mark::Line { role, pieces } => {
                for piece in pieces.iter().filter(|piece| piece.len() > 1) {
                    let points: Vec<_> = piece.iter().map(|point| look.at(*point)).collect();
                    let stroke = Stroke::new(thickness(*role), look.colour(*role));
                    match role {
                        Role::Dashed(_) | Role::Place => {
                            painter.extend(Shape::dashed_line(&points, stroke, DASH, GAP));
                        }
                        _ => {
                            painter.add(Shape::line(points, stroke));
                        }
                    }
                }
            }
            Mark::Area { role, at, size } => {
                let area = Rect::from_min_size(look.at(*at), vec2(size.0 as f32, size.1 as f32));
                let colour = look.colour(*role);
                if *role == Role::Frame {
                    let stroke = Stroke::new(1.0, colour);
                    painter.rect_stroke(area, 0.0, stroke, StrokeKind::Middle);
                } else {
                    painter.rect_filled(area, 0.0, colour);
                }
            }
            Mark::Dot { role, at } => {
                painter.circle_filled(look.at(*at), DOT, look.colour(*role));
            }
        }
    }
}

struct Look {
    palette: Palette,
    ink: Color32,
    strong: Color32,
    corner: Pos2,
}

impl Look {
    fn at(&self, (x, y): (f64, f64)) -> Pos2 {
        self.corner + vec2(x as f32, y as f32)
    }

    fn text(&self, ui: &Ui, mark: &Mark) {
        let Mark::Text {
            role,
            at,
            anchor,
            turned,
            text,
        } = mark
        else {
            return;
        };
        let colour = self.colour(*role);
        let font = FontId::proportional(SIZE);
        let laid = ui.painter().layout_no_wrap(text.clone(), font, colour);
        let (long, high) = (laid.size().x, laid.size().y);
        let back = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * long,
            Anchor::End => long,
        };
        // Its place is on the base line, about a quarter of the line's height from below.
        let (base, up) = (self.at(*at), 0.76 * high);
        let shape = if *turned {
            let corner = pos2(base.x - up, base.y + back);
            TextShape::new(corner, laid, colour).with_angle(-std::f32::consts::FRAC_PI_2)
        } else {
            TextShape::new(pos2(base.x - back, base.y - up), laid, colour)
        };
        ui.painter().add(shape);
    }

    fn colour(&self, role: Role) -> Color32 {
        let palette = &self.palette;
        match role {
            Role::Title => self.strong,
            Role::Legend | Role::Note => self.ink,
            Role::Label | Role::Tick | Role::Frame | Role::Zero => palette.quiet,
            Role::Place => palette.bad,
            Role::Grid => palette.grid,
            Role::Shaded => palette.warn.gamma_multiply(0.25),
            Role::Curve(n) | Role::Dashed(n) | Role::Dots(n) | Role::Bars(n) => {
                let curves = &palette.curves;
                curves.get(n % curves.len()).copied().unwrap_or(self.ink)
            }
        }
    }
}

fn thickness(role: Role) -> f32 {
    match role {
        Role::Curve(_) | Role::Dashed(_) | Role::Bars(_) => 1.6,
        _ => 1.0,
    }
}

/// What is allowed as a band, the value as a mark: a disc inside, a square outside.
pub fn gauge(ui: &Ui, rect: Rect, gauge: &ptu_report::run::Gauge) {
    let palette = Palette::of(ui);
    let painter = ui.painter();
    let room = rect.shrink2(vec2(4.0, 0.0));
    let x = |share: f64| room.left() + room.width() * share as f32;
    let middle = rect.center().y;
    painter.hline(rect.x_range(), middle, Stroke::new(1.0, palette.quiet));
    let band = Rect::from_x_y_ranges(
        x(gauge.band.0)..=x(gauge.band.1),
        middle - 3.0..=middle + 3.0,
    );
    // A band of one value only is still seen.
    let band = band.expand2(vec2((1.0 - band.width()).max(0.0) / 2.0, 0.0));
    painter.rect_filled(band, 1.0, palette.good.gamma_multiply(0.45));
    let at = pos2(x(gauge.value), middle);
    if gauge.good {
        painter.circle_filled(at, 3.5, palette.good);
    } else {
        let square = Rect::from_center_size(at, vec2(6.0, 11.0));
        painter.rect_filled(square, 0.0, palette.bad);
    }
}
