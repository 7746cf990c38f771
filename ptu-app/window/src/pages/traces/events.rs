//! Trigger and faults in the trace's window, as links and as flags above the lanes.

use eframe::egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, RichText, Stroke, Ui, pos2, vec2,
};

use super::bar;
use super::row::Sheet;
use crate::Palette;
use crate::parts::{lane, link};
use ptu_report::naming::DOT;
use ptu_report::trace_view::listing::Event;
use ptu_report::trace_view::{Cursor, TracePlot};
use ptu_report::words::Words;

/// Size of a flag, points.
pub const FLAG: f32 = 14.0;
/// Height of the strip above the lanes, points.
pub const STRIP: f32 = 34.0;
/// Rows of names in the strip.
const ROWS: usize = 2;
/// Most links shown; a fault that occurs every second would fill the page.
const LINKS: usize = 40;

/// Events of the trace, each a link to its place.
pub fn links(ui: &mut Ui, scene: &mut TracePlot, words: &Words) {
    let palette = Palette::of(ui);
    let opened = scene.opened.clone();
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(words.traces.events).color(palette.quiet));
        for event in opened.events.iter().take(LINKS) {
            let text = format!("{} {}", bar::place(scene, event.row), name(event, words));
            let link = link(ui, text);
            let link = match &event.fault {
                Some(fault) => link.on_hover_text(&fault.code),
                None => link,
            };
            if link.clicked() {
                let place = scene.axis.at(event.row);
                scene.camera.centre(place);
            }
        }
        if opened.events.len() > LINKS {
            ui.label("…");
        }
    });
}

/// Draws flags of events in the strip, with lines down through the lanes; the cursors' flags lie over the others.
pub fn flags(painter: &Painter, strip: Rect, lanes: Rect, sheet: &Sheet<'_>) {
    let Sheet {
        scene,
        words,
        palette,
        ..
    } = sheet;
    let window = scene.window();
    let mut free = [f32::NEG_INFINITY; ROWS];
    for event in &scene.opened.events {
        let x = lane::x_at(lanes, window, scene.axis.at(event.row));
        if !lanes.x_range().contains(x) {
            continue;
        }
        let colour = match event.fault {
            None => palette.accent,
            Some(_) => palette.bad,
        };
        painter.vline(x, strip.top()..=lanes.bottom(), Stroke::new(1.0, colour));
        // A name that would cover another one is left out; the links show all names.
        if let Some(row) = free.iter().position(|free| x > *free) {
            let y = strip.top() + row as f32 * STRIP / ROWS as f32;
            let at = pos2(x + 3.0, y);
            let font = FontId::proportional(lane::TEXT);
            // Only the name of the part; the link has the whole text.
            let name = name(event, words).split(DOT).next().unwrap_or_default();
            let text = painter.text(at, Align2::LEFT_TOP, name, font, colour);
            free[row] = text.right() + 6.0;
        }
    }
    for (cursor, letter) in [(Cursor::A, "A"), (Cursor::B, "B")] {
        let Some(row) = scene.cursor(cursor) else {
            continue;
        };
        let x = lane::x_at(lanes, window, scene.axis.at(row));
        if !lanes.x_range().contains(x) {
            continue;
        }
        painter.vline(
            x,
            strip.bottom()..=lanes.bottom(),
            Stroke::new(1.5, palette.warn),
        );
        let ink = if palette.dark {
            Color32::BLACK
        } else {
            Color32::WHITE
        };
        let corner = pos2(x - FLAG / 2.0, strip.bottom() - FLAG);
        flag(painter, corner, letter, palette.warn, ink);
    }
}

/// Draws a square with a letter or a number in it; returns its area.
pub fn flag(painter: &Painter, corner: Pos2, text: &str, ground: Color32, ink: Color32) -> Rect {
    let flag = Rect::from_min_size(corner, vec2(FLAG, FLAG));
    painter.rect_filled(flag, 2.0, ground);
    let font = FontId::proportional(lane::TEXT);
    painter.text(flag.center(), Align2::CENTER_CENTER, text, font, ink);
    flag
}

fn name<'a>(event: &'a Event, words: &'a Words) -> &'a str {
    let said = event.fault.as_ref().map(|fault| fault.said(words.language));
    said.unwrap_or(words.traces.trigger)
}
