//! One lane of a plot: a quantity, a choice or a bit along an axis that lanes share. Paints columns and
//! stretches of pixels ([`ptu_report::trace_view`]); it reads no samples.

use eframe::egui::epaint::Vertex;
use eframe::egui::text::{LayoutJob, TextWrapping};
use eframe::egui::{
    Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, pos2, vec2,
};

use crate::Palette;
use ptu_report::ticks::Ticks;
use ptu_report::trace_view::{Column, Span, SpanKind, Window};

/// Size of the text beside an axis and in boxes.
pub const TEXT: f32 = 11.5;
/// Height of an axis shared by lanes, with its text.
pub const AXIS_HEIGHT: f32 = 20.0;
/// Distance of two values along the horizontal and the vertical axis, points.
const TICK_ROOM: (f32, f32) = (90.0, 24.0);
/// Left free above and below what a lane shows.
const FREE: f32 = 3.0;
/// Half the width of a curve, and of the blur at its edge.
const HALF_WIDTH: f32 = 0.7;
const BLUR: f32 = 0.6;
/// Width of a bit's line, and of the hatch where it changes too fast.
const BIT_LINE: f32 = 1.5;
const HATCH: f32 = 3.0;
/// Width below which a box has no text, points; a box lower than its text has none either.
const NARROWEST: f32 = 18.0;

/// Vertical lines at round values, behind lanes, over the whole height of `rect`.
pub fn grid(painter: &Painter, rect: Rect, window: Window, palette: &Palette) {
    for x in x_ticks(rect, window).values() {
        painter.vline(
            x_at(rect, window, x),
            rect.y_range(),
            Stroke::new(1.0, palette.grid),
        );
    }
}

/// Values along the axis that lanes share, with its unit at the right end.
pub fn x_axis(painter: &Painter, rect: Rect, window: Window, unit: &str, palette: &Palette) {
    let ticks = x_ticks(rect, window);
    let font = FontId::proportional(TEXT);
    let y = rect.top() + 3.0;
    let end = painter.text(
        pos2(rect.right(), y),
        Align2::RIGHT_TOP,
        unit,
        font.clone(),
        palette.quiet,
    );
    for value in ticks.values() {
        let x = x_at(rect, window, value);
        painter.vline(
            x,
            rect.top()..=rect.top() + 3.0,
            Stroke::new(1.0, palette.quiet),
        );
        if x + TICK_ROOM.1 < end.left() {
            let at = pos2(x, y);
            painter.text(
                at,
                Align2::CENTER_TOP,
                ticks.written(value),
                font.clone(),
                palette.quiet,
            );
        }
    }
}

/// Values beside a quantity's lane, right-aligned in `gutter`, with a line through `rect` at each.
pub fn y_axis(painter: &Painter, gutter: Rect, rect: Rect, range: (f64, f64), palette: &Palette) {
    let room = rect.height() / TICK_ROOM.1;
    let ticks = Ticks::of(range, f64::from(room.clamp(1.0, 6.0)));
    let font = FontId::proportional(TEXT);
    for value in ticks.values() {
        let y = y_at(rect, range, value);
        painter.hline(rect.x_range(), y, Stroke::new(1.0, palette.grid));
        // The text is moved inward at the edges, where half a line would be cut off.
        let half = TEXT / 2.0;
        let beside = y.clamp(
            rect.top() + half,
            (rect.bottom() - half).max(rect.top() + half),
        );
        painter.text(
            pos2(gutter.right() - 4.0, beside),
            Align2::RIGHT_CENTER,
            ticks.written(value),
            font.clone(),
            palette.quiet,
        );
    }
}

/// Draws a quantity as one mesh, which smooths its edges itself.
pub fn quantity(
    painter: &Painter,
    rect: Rect,
    columns: &[Column],
    range: (f64, f64),
    colour: Color32,
) {
    let width = rect.width() / columns.len().max(1) as f32;
    let y = |value: f32| y_at(rect, range, f64::from(value));
    let mut mesh = Mesh::default();
    mesh.reserve_vertices(4 * columns.len() + 8);
    mesh.reserve_triangles(6 * columns.len());
    let mut before: Option<Column> = None;
    for (i, column) in columns.iter().enumerate() {
        if !column.is_known() {
            before = None;
            continue;
        }
        let left = rect.left() + i as f32 * width;
        let (top, bottom) = (y(column.high), y(column.low));
        let after = columns.get(i + 1).filter(|after| after.is_known());
        if before.is_none() {
            rib(&mut mesh, left, top, bottom, colour);
        }
        // A column between two equal ones needs no points of its own.
        if before != Some(*column) || after != Some(column) {
            rib(&mut mesh, left + width / 2.0, top, bottom, colour);
            join(&mut mesh);
        }
        if after.is_none() {
            rib(&mut mesh, left + width, top, bottom, colour);
            join(&mut mesh);
        }
        before = Some(*column);
    }
    if !mesh.is_empty() {
        painter
            .with_clip_rect(painter.clip_rect().intersect(rect))
            .add(Shape::mesh(mesh));
    }
}

/// A choice: a box per stretch with its label.
pub fn choice(
    painter: &Painter,
    rect: Rect,
    spans: &[Span],
    colour: Color32,
    palette: &Palette,
    label: impl Fn(f64) -> String,
) {
    let painter = painter.with_clip_rect(painter.clip_rect().intersect(rect));
    let text = palette.ink;
    let ground = colour.gamma_multiply(0.18);
    let mut narrow = RectangleMesh::new(&painter);
    for span in spans {
        let area = span_rect(rect, span);
        let SpanKind::Value(value) = span.shown else {
            narrow.busy(area, colour);
            continue;
        };
        if area.width() < NARROWEST || area.height() + 1.0 < TEXT {
            narrow.boxed(area, ground, colour);
            continue;
        }
        let line = Stroke::new(1.0, colour);
        painter.rect(area, 2.0, ground, line, StrokeKind::Inside);
        let inner = area.shrink2(vec2(3.0, 0.0));
        cut_text(
            &painter,
            inner,
            label(value),
            FontId::proportional(TEXT),
            text,
        );
    }
    narrow.paint(&painter);
}

/// One line of text from the left of `area` on, with "…" where it has no room; its width.
pub fn cut_text(painter: &Painter, area: Rect, text: String, font: FontId, colour: Color32) -> f32 {
    let mut job = LayoutJob::simple_singleline(text, font, colour);
    job.wrap = TextWrapping::truncate_at_width(area.width());
    let laid = painter.layout_job(job);
    let at = pos2(area.left(), area.center().y - laid.size().y / 2.0);
    let wide = laid.size().x;
    painter.galley(at, laid, colour);
    wide
}

/// Draws a bit: a line that is up while the bit is set, with the area below filled.
pub fn bit(painter: &Painter, rect: Rect, spans: &[Span], colour: Color32) {
    let painter = painter.with_clip_rect(painter.clip_rect().intersect(rect));
    let inner = rect.shrink2(vec2(0.0, FREE));
    let mut slabs = RectangleMesh::new(&painter);
    let mut before: Option<(f32, f32)> = None;
    for span in spans {
        let area = span_rect(inner, span);
        let SpanKind::Value(value) = span.shown else {
            slabs.busy(area, colour);
            before = None;
            continue;
        };
        let y = if value == 0.0 {
            area.bottom()
        } else {
            slabs.add(area, colour.gamma_multiply(0.25));
            area.top()
        };
        let line = Rect::from_x_y_ranges(area.x_range(), y - BIT_LINE / 2.0..=y + BIT_LINE / 2.0);
        slabs.add(line, colour);
        if let Some((x, at)) = before
            && (x - area.left()).abs() < 1.0
            && at != y
        {
            let x = area.left();
            let edge = Rect::from_x_y_ranges(x..=x + BIT_LINE, inner.y_range());
            slabs.add(edge, colour);
        }
        before = Some((area.right(), y));
    }
    slabs.paint(&painter);
}

/// Many rectangles as one mesh, at whole pixels: an hour of a lane may have hundreds of rectangles.
struct RectangleMesh {
    mesh: Mesh,
    pixels_per_point: f32,
}

impl RectangleMesh {
    fn new(painter: &Painter) -> Self {
        Self {
            mesh: Mesh::default(),
            pixels_per_point: painter.pixels_per_point(),
        }
    }

    fn add(&mut self, area: Rect, colour: Color32) {
        let whole = |n: f32| (n * self.pixels_per_point).round() / self.pixels_per_point;
        let area = Rect::from_min_max(
            pos2(whole(area.left()), whole(area.top())),
            pos2(whole(area.right()), whole(area.bottom())),
        );
        self.mesh.add_colored_rect(area, colour);
    }

    fn boxed(&mut self, area: Rect, ground: Color32, line: Color32) {
        let (x, y) = (area.x_range(), area.y_range());
        self.add(area, ground);
        for edge in [
            Rect::from_x_y_ranges(x.min..=x.min + 1.0, y),
            Rect::from_x_y_ranges(x.max - 1.0..=x.max, y),
            Rect::from_x_y_ranges(x, y.min..=y.min + 1.0),
            Rect::from_x_y_ranges(x, y.max - 1.0..=y.max),
        ] {
            self.add(edge, line);
        }
    }

    /// Changes too fast to be told apart: a solid bar, hatched where there is room.
    fn busy(&mut self, area: Rect, colour: Color32) {
        self.add(area, colour.gamma_multiply(0.6));
        let mut x = area.left() + HATCH;
        while x < area.right() {
            self.add(Rect::from_x_y_ranges(x..=x + 1.0, area.y_range()), colour);
            x += HATCH;
        }
    }

    fn paint(self, painter: &Painter) {
        if !self.mesh.is_empty() {
            painter.add(Shape::mesh(self.mesh));
        }
    }
}

/// Horizontal position of a value of the shared axis.
pub fn x_at(rect: Rect, window: Window, value: f64) -> f32 {
    rect.left() + (window.share(value) * f64::from(rect.width())) as f32
}

/// Vertical position of a value of a lane.
pub fn y_at(rect: Rect, (low, high): (f64, f64), value: f64) -> f32 {
    let inner = rect.shrink2(vec2(0.0, FREE));
    inner.bottom() - ((value - low) / (high - low) * f64::from(inner.height())) as f32
}

fn x_ticks(rect: Rect, window: Window) -> Ticks {
    let about = rect.width() / TICK_ROOM.0;
    Ticks::of((window.from, window.to), f64::from(about))
}

fn span_rect(rect: Rect, span: &Span) -> Rect {
    Rect::from_min_max(
        pos2(rect.left() + span.from, rect.top() + 1.0),
        pos2(rect.left() + span.to, rect.bottom() - 1.0),
    )
}

/// Four points across a curve: blurred edge, edge, edge, blurred edge.
fn rib(mesh: &mut Mesh, x: f32, top: f32, bottom: f32, colour: Color32) {
    let clear = Color32::TRANSPARENT;
    let (top, bottom) = (top - HALF_WIDTH, bottom + HALF_WIDTH);
    for (y, colour) in [
        (top - BLUR, clear),
        (top, colour),
        (bottom, colour),
        (bottom + BLUR, clear),
    ] {
        let pos: Pos2 = pos2(x, y);
        mesh.vertices.push(Vertex::untextured(pos, colour));
    }
}

/// Joins the last two ribs.
fn join(mesh: &mut Mesh) {
    let after = mesh.vertices.len() as u32 - 4;
    let before = after - 4;
    for i in 0..3 {
        mesh.add_triangle(before + i, before + i + 1, after + i);
        mesh.add_triangle(before + i + 1, after + i, after + i + 1);
    }
}
