//! The unit's log and TCMS's log together, the latest entry first.

use btu_rig::procedure::{EventSource, UnitEvent};
use eframe::egui::{Color32, RichText, ScrollArea, Ui, pos2, vec2};
use protocol::event::{Event, Severity};

use super::View;
use super::card::{card, named, write};
use crate::Palette;
use crate::pages::bench::text::since_start;
use ptu_report::words::Words;

const LINE: f32 = 18.0;
/// Width of the time, points.
const TIME: f32 = 64.0;

/// Draws the log; `height` = height of its lines without the heading.
pub fn log(ui: &mut Ui, height: f32, view: &View<'_>) {
    let palette = Palette::of(ui);
    let words = &view.words.bench;
    card(ui, words.log, |ui| {
        ui.allocate_ui(vec2(ui.available_width(), height), |ui| {
            ui.set_min_height(height);
            if view.events.is_empty() {
                ui.label(RichText::new(words.log_empty).color(palette.quiet));
            } else {
                lines(ui, view, &palette);
            }
        });
    });
}

fn lines(ui: &mut Ui, view: &View<'_>, palette: &Palette) {
    let scroll = ScrollArea::vertical()
        .id_salt("log")
        .auto_shrink([false, false]);
    scroll.show_rows(ui, LINE, view.events.len(), |ui, rows| {
        let latest = view.events.iter().rev();
        for (place, entry) in latest.enumerate().skip(rows.start).take(rows.len()) {
            line(ui, place, entry, view, palette);
        }
    });
}

fn line(ui: &mut Ui, place: usize, entry: &UnitEvent, view: &View<'_>, palette: &Palette) {
    let (area, _) = ui.allocate_exact_size(
        [ui.available_width(), LINE].into(),
        eframe::egui::Sense::hover(),
    );
    let time = since_start(&view.words.bench, entry.at_ms);
    let (said, colour) = told(entry, view.words, palette);
    let middle = area.center().y;
    let quiet = RichText::new(&time).size(12.0).color(palette.quiet);
    write(ui, pos2(area.left(), middle), TIME - 4.0, quiet);
    let ink = colour.unwrap_or(ui.visuals().text_color());
    let text = RichText::new(&said).size(13.0).color(ink);
    write(
        ui,
        pos2(area.left() + TIME, middle),
        area.width() - TIME,
        text,
    );
    named(ui, area, ("event", place), || format!("{time} {said}"));
}

/// Text of an entry, with its number, and its colour if it is a fault.
fn told(entry: &UnitEvent, words: &Words, palette: &Palette) -> (String, Option<Color32>) {
    let source = match entry.source {
        EventSource::Unit => "",
        EventSource::Tcms => "TCMS ",
    };
    let Some(event) = Event::from_code(entry.code) else {
        return (
            format!("{source}{} ({})", entry.code, entry.parameter),
            None,
        );
    };
    let definition = event.definition();
    let text = words.language.choose([definition.text, definition.text_ko]);
    let colour = match definition.severity {
        Severity::Info => None,
        Severity::Minor => Some(palette.warn),
        Severity::Major | Severity::Critical => Some(palette.bad),
    };
    let detail = match words.parameter(event, entry.parameter) {
        said if said.is_empty() => said,
        said => format!(" ({said})"),
    };
    (format!("{source}{} {text}{detail}", entry.code), colour)
}
