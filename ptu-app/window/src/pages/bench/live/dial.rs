//! Speeds on one scale: measured and true as needles, limit and target as marks.

use std::f32::consts::{PI, TAU};

use eframe::egui::{
    Color32, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2, pos2, vec2,
};
use protocol::signal::Signal;

use super::View;
use super::card::{named, put_centred, put_left};
use crate::Palette;
use crate::pages::bench::scale::Dial;
use crate::pages::bench::text::UNKNOWN;
use ptu_report::words::Bench;

/// Angle at which the dial begins, clockwise from the right, and angle that it spans, rad.
const BEGIN: f32 = 0.81 * PI;
const ROUND: f32 = 0.69 * TAU;
/// Half the width of a mark's foot, points.
const MARK: f32 = 7.0;
/// Number of points of an arc.
const FINE: usize = 48;
/// Width of the legend beside the dial, points.
const LEGEND: f32 = 158.0;

/// The dial's face.
struct DialFace {
    middle: Pos2,
    radius: f32,
    scale: Dial,
}

impl DialFace {
    fn at(&self, kmh: f64, radius: f32) -> Pos2 {
        let angle = BEGIN + ROUND * self.scale.share(kmh);
        self.middle + radius * Vec2::angled(angle)
    }

    fn arc(&self, painter: &Painter, from_kmh: f64, to_kmh: f64, radius: f32, stroke: Stroke) {
        let step = (to_kmh - from_kmh) / FINE as f64;
        let points = (0..=FINE).map(|i| self.at(from_kmh + step * i as f64, radius));
        painter.add(Shape::line(points.collect(), stroke));
    }

    /// Paints a triangle that points at a speed; `tip` and `foot` are distances from the centre.
    fn mark(&self, painter: &Painter, kmh: f64, tip: f32, foot: f32, colour: Color32) {
        let tip = self.at(kmh, tip);
        let foot = self.at(kmh, foot);
        let across = (foot - tip).rot90().normalized() * MARK;
        painter.add(Shape::convex_polygon(
            vec![tip, foot + across, foot - across],
            colour,
            Stroke::NONE,
        ));
    }
}

pub fn dial(ui: &mut Ui, size: Vec2, scale: Dial, view: &View<'_>, palette: &Palette) {
    let (area, _) = ui.allocate_exact_size(size, Sense::hover());
    let words = &view.words.bench;
    let painter = ui.painter_at(area);
    painter.rect_stroke(area, 6.0, (1.0, palette.grid), StrokeKind::Inside);
    let speeds = [
        Signal::Speed,
        Signal::TrainSpeed,
        Signal::Limit,
        Signal::Target,
    ]
    .map(|signal| view.seen.value(signal));
    let [measured, _, limit, _] = speeds;
    let strong = ui.visuals().strong_text_color();
    let colours = [strong, palette.accent, palette.bad, palette.good];

    let room = area.with_max_x(area.right() - LEGEND);
    let radius = (room.width() / 2.0 - 12.0).min(room.height() * 0.53);
    let face = DialFace {
        middle: pos2(room.center().x, room.top() + radius + 11.0),
        radius,
        scale,
    };
    paint_face(&painter, &face, limit, palette);
    paint_speeds(&painter, &face, speeds, colours);
    let digits = measured.map_or(UNKNOWN.to_owned(), |kmh| format!("{kmh:.1}"));
    let over = measured
        .zip(limit)
        .is_some_and(|(speed, limit)| speed > limit);
    let colour = if over { palette.bad } else { strong };
    let centred = |below, size, colour, text: &str| {
        let at = face.middle + vec2(0.0, below);
        put_centred(&painter, at, size, colour, text);
    };
    centred(2.0, 30.0, colour, &digits);
    centred(25.0, 12.0, palette.quiet, "km/h");
    legend(ui, area, speeds, colours, words, palette);
}

/// Paints marks at limit and target, and needles at the true and the measured speed.
fn paint_speeds(
    painter: &Painter,
    face: &DialFace,
    [measured, truth, limit, target]: [Option<f64>; 4],
    colours: [Color32; 4],
) {
    let radius = face.radius;
    let mark = |kmh: Option<f64>, tip, foot, colour| {
        if let Some(kmh) = kmh {
            face.mark(painter, kmh, tip, foot, colour);
        }
    };
    mark(limit, radius - 3.0, radius + 10.0, colours[2]);
    mark(target, radius - 9.0, radius - 22.0, colours[3]);
    if let Some(truth) = truth {
        let needle = [radius * 0.38, radius - 2.0].map(|radius| face.at(truth, radius));
        painter.line_segment(needle, Stroke::new(2.0, colours[1]));
    }
    mark(measured, radius - 4.0, radius * 0.36, colours[0]);
}

fn paint_face(painter: &Painter, face: &DialFace, limit: Option<f64>, palette: &Palette) {
    let full = face.scale.full_kmh;
    let ring = Stroke::new(3.0, palette.quiet);
    face.arc(painter, 0.0, full, face.radius, ring);
    if let Some(limit) = limit {
        let beyond = Stroke::new(5.0, palette.bad);
        face.arc(painter, limit, full, face.radius, beyond);
    }
    for kmh in face.scale.strokes() {
        let points = [face.at(kmh, face.radius), face.at(kmh, face.radius - 6.0)];
        painter.line_segment(points, Stroke::new(1.0, palette.quiet));
    }
    for kmh in face.scale.numbers() {
        let points = [face.at(kmh, face.radius), face.at(kmh, face.radius - 9.0)];
        painter.line_segment(points, Stroke::new(2.0, palette.quiet));
        let (at, number) = (face.at(kmh, face.radius - 19.0), format!("{kmh:.0}"));
        put_centred(painter, at, 12.0, palette.quiet, &number);
    }
}

fn legend(
    ui: &Ui,
    area: Rect,
    speeds: [Option<f64>; 4],
    colours: [Color32; 4],
    words: &Bench,
    palette: &Palette,
) {
    let names = [words.measured, words.true_speed, words.limit, words.target];
    let height = (area.height() - 8.0) / 4.0;
    for (place, ((speed, colour), name)) in speeds.into_iter().zip(colours).zip(names).enumerate() {
        let corner = pos2(
            area.right() - LEGEND,
            area.top() + 4.0 + place as f32 * height,
        );
        let rect = Rect::from_min_size(corner, vec2(LEGEND - 8.0, height));
        let painter = ui.painter();
        swatch(
            painter,
            pos2(rect.left() + 8.0, rect.center().y),
            place,
            colour,
        );
        let name_at = pos2(rect.left() + 22.0, rect.top() + height * 0.28);
        put_left(painter, name_at, 12.0, palette.quiet, name);
        let value = match speed {
            Some(kmh) => format!("{kmh:.1} km/h"),
            None => words.not_known.to_owned(),
        };
        let (size, ink) = match speed {
            Some(_) => (19.0, colour),
            None => (13.0, palette.quiet),
        };
        let value_at = pos2(rect.left() + 22.0, rect.top() + height * 0.67);
        put_left(painter, value_at, size, ink, &value);
        named(ui, rect, ("speed", place), || format!("{name}: {value}"));
    }
}

/// Small picture of a speed's mark on the dial.
fn swatch(painter: &Painter, at: Pos2, place: usize, colour: Color32) {
    let triangle = |tip: Vec2, left: Vec2, right: Vec2| {
        let points = vec![at + tip, at + left, at + right];
        painter.add(Shape::convex_polygon(points, colour, Stroke::NONE));
    };
    match place {
        0 => triangle(vec2(6.0, -6.0), vec2(-6.0, 0.0), vec2(0.0, 6.0)),
        1 => {
            painter.line_segment(
                [at + vec2(-6.0, 6.0), at + vec2(6.0, -6.0)],
                Stroke::new(2.0, colour),
            );
        }
        2 => triangle(vec2(0.0, 6.0), vec2(-6.0, -5.0), vec2(6.0, -5.0)),
        _ => triangle(vec2(0.0, -6.0), vec2(-6.0, 5.0), vec2(6.0, 5.0)),
    }
}
