//! The pages of a sheet in the window, as they will be printed: scaled to the room there is, dark on
//! white. Only what is in view is drawn.

use std::fmt::Debug;
use std::hash::Hash;
use std::ops::RangeInclusive;
use std::sync::Arc;

use eframe::egui::emath::GuiRounding;
use eframe::egui::epaint::TextShape;
use eframe::egui::text::LayoutJob;
use eframe::egui::{
    Color32, FontId, Galley, Key, Label, Pos2, Rangef, Rect, Role, ScrollArea, Sense, Shape,
    Stroke, StrokeKind, TextureId, Theme, Ui, UiBuilder, Vec2, WidgetInfo, pos2, vec2,
};

use crate::Palette;
use ptu_report::plot::Plot;
use ptu_report::run::page::{self, DASH, HEIGHT, Ink, Item, MARGIN, Page, Text, WIDTH};

/// Least and greatest width of a page, points of the window.
const WIDE: RangeInclusive<f32> = 640.0..=1168.0;
/// Step of the sheet's width, points, so that few font sizes are needed.
const STEP: f32 = 16.0;
/// Gap beside and between pages, points.
const BETWEEN: f32 = 12.0;
/// Points of the window in one unit of a plot; least height of a plot, units of a plot.
const UNIT: f32 = 1.13;
const LOWEST: f32 = 150.0;
/// Share of the visible height that the page keys scroll by.
const PAGE: f32 = 0.9;
/// Reach of text above and below its base line, multiples of the font size.
const ABOVE: f32 = 1.0;
const BELOW: f32 = 0.4;

/// Shows the pages of a sheet; each sheet is scrolled by itself.
pub fn show_sheet(ui: &mut Ui, sheet: impl Hash + Debug, pages: &[Page]) {
    let area = ScrollArea::both()
        .id_salt(("sheet", sheet))
        .auto_shrink(false);
    area.show_viewport(ui, |ui, viewport| {
        // Paper is white in a dark window, too: the sheet is shown as it will be printed.
        ui.style_mut().visuals = ui.ctx().style_of(Theme::Light).visuals.clone();
        let room = viewport.width() - 2.0 * BETWEEN;
        let wide = room.clamp(*WIDE.start(), *WIDE.end());
        let scale = (wide / STEP).floor() * STEP / WIDTH;
        let size = vec2(WIDTH, HEIGHT) * scale;
        let beside = ((viewport.width() - size.x) / 2.0).max(BETWEEN);
        let whole = vec2(
            size.x + 2.0 * BETWEEN,
            pages.len() as f32 * (size.y + BETWEEN),
        );
        let corner = ui.min_rect().min;
        ui.set_min_size(whole);
        keys(ui, viewport.height());
        for (number, page) in pages.iter().enumerate() {
            let top = number as f32 * (size.y + BETWEEN);
            let seen = Rangef::new(viewport.top() - top, viewport.bottom() - top);
            if !seen.intersects(Rangef::new(0.0, size.y)) {
                continue;
            }
            let at = corner + vec2(beside, top);
            let edge = Stroke::new(1.0, Palette::of(ui).grid);
            let area = Rect::from_min_size(at, size);
            let ground = ui.visuals().extreme_bg_color;
            let painter = ui.painter();
            painter.rect(area, 0.0, ground, edge, StrokeKind::Outside);
            let page_area = PageArea {
                ui,
                number,
                at,
                scale,
                cells: None,
            };
            page_area.draw(page, Rangef::new(seen.min / scale, seen.max / scale));
        }
    });
}

/// Plots as drawings for the window, each of the width and height of `room`; the drawings, and their total height.
pub fn drawings(mut plots: Vec<Plot>, room: Vec2) -> (Page, f32) {
    let height = (room.y / UNIT).max(LOWEST);
    for plot in &mut plots {
        plot.height = Some(height.into());
    }
    page::drawings(&plots, room.x, UNIT)
}

/// Shows drawings in the colours of the window; `cells` is the picture of the cells among them.
pub fn show_drawings(ui: &mut Ui, (page, height): &(Page, f32), cells: Option<TextureId>) {
    let size = vec2(ui.available_width(), *height);
    let (area, _) = ui.allocate_exact_size(size, Sense::hover());
    let page_area = PageArea {
        ui,
        number: 0,
        at: area.min - vec2(MARGIN, 0.0),
        scale: 1.0,
        cells,
    };
    page_area.draw(page, Rangef::EVERYTHING);
}

/// Scrolls a page up or down by key, unless an input field has the keyboard focus.
fn keys(ui: &Ui, page: f32) {
    if ui.ctx().text_edit_focused() {
        return;
    }
    let pages = ui.input(|input| {
        f32::from(u8::from(input.key_pressed(Key::PageUp)))
            - f32::from(u8::from(input.key_pressed(Key::PageDown)))
    });
    if pages != 0.0 {
        ui.scroll_with_delta(vec2(0.0, pages * page * PAGE));
    }
}

struct PageArea<'a> {
    ui: &'a mut Ui,
    number: usize,
    at: Pos2,
    scale: f32,
    cells: Option<TextureId>,
}

impl PageArea<'_> {
    /// Draws the items between these heights of the page.
    fn draw(mut self, page: &Page, seen: Rangef) {
        for (place, item) in page.iter().enumerate() {
            if !extent(item).intersects(seen) {
                continue;
            }
            match item {
                Item::Text(text) => self.text(place, text),
                Item::Line {
                    points,
                    ink,
                    width,
                    dashed,
                } => {
                    let points: Vec<_> = points.iter().map(|(x, y)| self.point(*x, *y)).collect();
                    let stroke = Stroke::new(width * self.scale, self.colour(*ink));
                    let painter = self.ui.painter();
                    if *dashed {
                        let [dash, gap] = DASH.map(|long| long * self.scale);
                        painter.extend(Shape::dashed_line(&points, stroke, dash, gap));
                    } else {
                        painter.add(Shape::line(points, stroke));
                    }
                }
                Item::Area(x, y, wide, high, ink) => {
                    let area = self.area(*x, *y, *wide, *high);
                    let colour = self.colour(*ink);
                    self.ui.painter().rect_filled(area, 0.0, colour);
                }
                Item::Disc(x, y, radius, ink) => {
                    let (middle, colour) = (self.point(*x, *y), self.colour(*ink));
                    let radius = radius * self.scale;
                    self.ui.painter().circle_filled(middle, radius, colour);
                }
                Item::Cells(x, y, wide, high, ..) => {
                    if let Some(cells) = self.cells {
                        let area = self.area(*x, *y, *wide, *high);
                        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
                        (self.ui.painter()).image(cells, area, whole, Color32::WHITE);
                    }
                }
                Item::Drawing(x, y, wide, high, title) => {
                    let area = self.area(*x, *y, *wide, *high);
                    let id = self.ui.scope_id().with((self.number, place));
                    let response = self.ui.interact(area, id, Sense::hover());
                    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, title));
                }
            }
        }
    }

    fn point(&self, x: f32, y: f32) -> Pos2 {
        self.at + vec2(x, y) * self.scale
    }

    fn area(&self, x: f32, y: f32, wide: f32, high: f32) -> Rect {
        Rect::from_min_size(self.point(x, y), vec2(wide, high) * self.scale)
    }

    fn colour(&self, ink: Ink) -> Color32 {
        let palette = Palette::of(self.ui);
        match ink {
            Ink::Black => self.ui.visuals().text_color(),
            Ink::Soft | Ink::Rule => palette.quiet,
            Ink::Good => palette.good,
            Ink::Bad => palette.bad,
            Ink::Grid => palette.grid,
            Ink::Band => palette.good.gamma_multiply(0.45),
            Ink::Shade => palette.warn.gamma_multiply(0.25),
            Ink::Curve(place) => palette.curves[place % palette.curves.len()],
        }
    }

    /// Draws text as a label that screen readers read and that can be copied; text of a drawing is only painted.
    fn text(&mut self, place: usize, text: &Text) {
        let Some((first, _)) = text.lines.first() else {
            return;
        };
        let laid = self.laid(text);
        if laid.text().is_empty() {
            return;
        }
        let begin = self.point(text.x, *first);
        let back = text.anchor.share() * laid.size().x;
        let above = base(&laid);
        if text.turned {
            let corner = pos2(begin.x - above, begin.y + back);
            let shape = TextShape::new(corner, laid, self.colour(text.ink));
            let upwards = -std::f32::consts::FRAC_PI_2;
            self.ui.painter().add(shape.with_angle(upwards));
            return;
        }
        let corner = begin - vec2(back, above);
        if text.in_drawing {
            let colour = self.colour(text.ink);
            self.ui.painter().galley(corner, laid, colour);
            return;
        }
        let place = UiBuilder::new()
            .id_salt((self.number, place))
            .max_rect(Rect::from_min_size(corner, laid.size()));
        self.ui.new_child(place).add(Label::new(laid));
    }

    /// The lines as one text, with the line breaks of the page.
    fn laid(&self, text: &Text) -> Arc<Galley> {
        let font = FontId::proportional(text.size * self.scale);
        let colour = match text.ink {
            Ink::Black if text.strong => self.ui.visuals().strong_text_color(),
            ink => self.colour(ink),
        };
        let painter = self.ui.painter();
        let line = |(_, line): &(f32, String)| {
            let line = line.trim_end_matches('\n').to_owned();
            painter.layout_no_wrap(line, font.clone(), colour)
        };
        if let [only] = &text.lines[..] {
            return line(only);
        }
        let lines: Vec<_> = text.lines.iter().map(line).collect();
        let whole = text.lines.iter().map(|(_, line)| line.as_str()).collect();
        let job = LayoutJob::simple(whole, font, colour, f32::INFINITY);
        let pixels = self.ui.pixels_per_point();
        let mut laid = Galley::concat(Arc::new(job), &lines, pixels);
        let width = laid.rect.width();
        let (mut rect, mut mesh) = (Rect::NOTHING, Rect::NOTHING);
        for (row, (y, line)) in laid.rows.iter_mut().zip(&text.lines) {
            let spare = width - row.row.size.x;
            let below = (y - text.lines[0].0) * self.scale;
            row.pos = pos2(spare * text.anchor.share(), below).round_to_pixels(pixels);
            row.ends_with_newline = line.ends_with('\n');
            rect |= row.rect();
            mesh |= row.row.visuals.mesh_bounds.translate(row.pos.to_vec2());
        }
        (laid.rect, laid.mesh_bounds) = (rect, mesh);
        Arc::new(laid)
    }
}

/// Height from the top of a row to its base line.
fn base(laid: &Galley) -> f32 {
    let letter = laid.rows.iter().find_map(|row| row.glyphs.first());
    letter.map_or(0.0, |letter| letter.pos.y)
}

/// Range of heights of an item on its page.
fn extent(item: &Item) -> Rangef {
    match item {
        Item::Text(text) if text.turned => Rangef::EVERYTHING,
        Item::Text(text) => {
            let (above, below) = (ABOVE * text.size, BELOW * text.size);
            let lines = text.lines.iter();
            lines.fold(Rangef::NOTHING, |all, (y, _)| {
                Rangef::new(all.min.min(y - above), all.max.max(y + below))
            })
        }
        Item::Line { points, .. } => points.iter().fold(Rangef::NOTHING, |all, (_, y)| {
            Rangef::new(all.min.min(*y), all.max.max(*y))
        }),
        Item::Area(_, y, _, high, _)
        | Item::Drawing(_, y, _, high, _)
        | Item::Cells(_, y, _, high, ..) => Rangef::new(*y, y + high),
        Item::Disc(_, y, radius, _) => Rangef::new(y - radius, y + radius),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_item_is_between_the_heights_where_it_is_seen() {
        let line = Item::Line {
            points: vec![(0.0, 9.0), (5.0, 3.0), (7.0, 4.0)],
            ink: Ink::Grid,
            width: 0.5,
            dashed: false,
        };
        let disc = Item::Disc(10.0, 20.0, 2.0, Ink::Good);
        let area = Item::Area(10.0, 20.0, 5.0, 6.0, Ink::Band);
        for (item, from, to) in [(line, 3.0, 9.0), (disc, 18.0, 22.0), (area, 20.0, 26.0)] {
            assert_eq!(extent(&item), Rangef::new(from, to), "{item:?}");
        }
    }
}
