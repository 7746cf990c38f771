//! The track strip: start, PSM1 to PSM4, stop point, train.

use eframe::egui::{
    Color32, Painter, Rect, RichText, Sense, Shape, Stroke, StrokeKind, Ui, pos2, vec2,
};
use protocol::signal::Signal;

use super::View;
use super::card::{named, put_centred, put_left, write};
use crate::Palette;
use crate::pages::bench::text;
use crate::pages::bench::track::Strip;
use ptu_report::words::{Bench, fill};

const HEIGHT: f32 = 70.0;
/// Distance of two markers below which their names stand one above the other, points.
const NEAR: f32 = 34.0;

pub fn strip(ui: &mut Ui, strip: Option<&Strip>, view: &View<'_>, palette: &Palette) {
    let words = &view.words.bench;
    let size = vec2(ui.available_width(), HEIGHT);
    let (area, _) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter_at(area);
    painter.rect_stroke(area, 6.0, (1.0, palette.grid), StrokeKind::Inside);
    let said = said(strip, view, words);
    let head = pos2(area.left() + 8.0, area.top() + 11.0);
    let text = RichText::new(&said).size(13.0).color(palette.quiet);
    write(ui, head, area.width() - 16.0, text);
    named(ui, area, "track", || format!("{}: {said}", words.track));
    if let Some(strip) = strip {
        paint(ui, area.shrink2(vec2(8.0, 0.0)), strip, words, palette);
    }
}

/// Text of the strip, for screen readers.
fn said(strip: Option<&Strip>, view: &View<'_>, words: &Bench) -> String {
    let Some(strip) = strip else {
        return words.no_section.to_owned();
    };
    let (from, to) = strip.stations;
    let section = fill(
        words.section_is,
        &[("section", &strip.section), ("from", &from), ("to", &to)],
    );
    let way = match strip.to_stop_m {
        None => words.no_section.to_owned(),
        Some(left) if left < 0.0 => {
            fill(words.beyond_stop_is, &[("way", &format!("{:.2}", -left))])
        }
        Some(left) => fill(words.to_stop_is, &[("way", &format!("{left:.2}"))]),
    };
    let marker = text::value(words, Signal::Marker, view.seen);
    let count = text::value(words, Signal::MarkerCount, view.seen);
    let detected = fill(words.detected_is, &[("marker", &marker), ("count", &count)]);
    format!("{section}   {way}   {detected}")
}

fn paint(ui: &Ui, area: Rect, strip: &Strip, words: &Bench, palette: &Palette) {
    let painter = ui.painter();
    let rail = area.top() + 50.0;
    let x = |share: f32| area.left() + share * area.width();
    painter.hline(area.x_range(), rail, Stroke::new(3.0, palette.quiet));
    painter.vline(
        x(strip.start),
        rail - 6.0..=rail + 6.0,
        Stroke::new(2.0, palette.quiet),
    );
    paint_markers(painter, strip, palette, rail, x);
    let stop = x(strip.stop);
    painter.vline(
        stop,
        rail - 14.0..=rail + 10.0,
        Stroke::new(3.0, palette.bad),
    );
    let beside = pos2(stop + 5.0, rail - 12.0);
    put_left(painter, beside, 12.0, palette.bad, words.stop_point);
    if let Some(unit) = strip.unit {
        let at = x(unit);
        let tick = vec![
            pos2(at, rail + 3.0),
            pos2(at - 5.0, rail + 12.0),
            pos2(at + 5.0, rail + 12.0),
        ];
        painter.add(Shape::convex_polygon(
            tick,
            Color32::TRANSPARENT,
            Stroke::new(1.5, palette.good),
        ));
    }
    if let Some(train) = strip.train {
        let nose = x(train);
        let body = vec![
            pos2(nose, rail - 8.0),
            pos2(nose - 8.0, rail - 15.0),
            pos2((nose - 40.0).max(area.left()), rail - 15.0),
            pos2((nose - 40.0).max(area.left()), rail - 4.0),
            pos2(nose, rail - 4.0),
        ];
        painter.add(Shape::convex_polygon(body, palette.accent, Stroke::NONE));
    }
}

/// Paints the markers from the stop point backwards: the last markers lie close to it and to each other.
fn paint_markers(
    painter: &Painter,
    strip: &Strip,
    palette: &Palette,
    rail: f32,
    x: impl Fn(f32) -> f32,
) {
    let mut taken = x(strip.stop) + 2.0;
    let mut low = false;
    for (psm, share) in [1_u8, 2, 3, 4].into_iter().zip(strip.markers).rev() {
        let at = x(share);
        let hit = strip.detected == Some(psm);
        let colour = if hit { palette.accent } else { palette.quiet };
        let height = if hit { 9.0 } else { 7.0 };
        let diamond = vec![
            pos2(at, rail - height),
            pos2(at + 5.0, rail),
            pos2(at, rail + height),
            pos2(at - 5.0, rail),
        ];
        let fill = if hit { colour } else { palette.panel };
        painter.add(Shape::convex_polygon(
            diamond,
            fill,
            Stroke::new(1.5, colour),
        ));
        low = taken - at < NEAR && !low;
        let y = if low { rail - 28.0 } else { rail + 17.0 };
        let name = format!("PSM{psm}");
        put_centred(painter, pos2(at, y), 12.0, colour, &name);
        if low {
            painter.vline(at, y + 7.0..=rail - 9.0, Stroke::new(1.0, palette.grid));
        }
        taken = at;
    }
}
