//! The rolling plot of chosen signals.

use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{
    Align2, Checkbox, Color32, FontId, Painter, PopupCloseBehavior, Rect, Role, ScrollArea, Sense,
    Ui, WidgetInfo, pos2, vec2,
};
use protocol::signal::Signal;

use super::live::{framed, heading, put_centred};
use super::live_copy::BenchSnapshot;
use super::rolling::{Lane, MOST, Rows, SPANS_S, chosen, lanes};
use super::text;
use crate::Palette;
use crate::parts::{find_edit, lane};
use ptu_report::trace_view::{Column, Span, Window, samples};
use ptu_report::words::{Words, fill};
use ptu_report::{naming, ticks};
use ptu_runs::bench_worker::BenchWorker;

/// Widths at the left of the curves: names with values, and the scale's numbers, points.
const NAMES: f32 = 168.0;
const SCALE: f32 = 36.0;
/// Height of a lane of quantities, as a multiple of the height of a lane of states.
const TALL: f32 = 3.5;
/// Height of a name, points.
const NAME: f32 = 14.0;
/// Greatest height of a lane of states, points.
const STATES: f32 = 20.0;

/// The rolling plot: its settings, and buffers that are used again in each frame.
#[derive(Debug)]
pub struct Plot {
    span_s: u32,
    find: String,
    rows: Rows,
    columns: Vec<Vec<Column>>,
    spans: Vec<Span>,
}

impl Default for Plot {
    fn default() -> Self {
        Self {
            span_s: SPANS_S[1],
            find: String::new(),
            rows: Rows::default(),
            columns: Vec::new(),
            spans: Vec::new(),
        }
    }
}

impl Plot {
    /// Copies the latest rows of the chosen signals from the bench.
    pub fn take(&mut self, worker: &BenchWorker, signals: &[Signal]) {
        let span_s = f64::from(self.span_s);
        self.rows.take(&worker.live(), signals, span_s);
    }

    /// Draws the plot; `height` does not include its heading.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        height: f32,
        signals: &[Signal],
        plotted: &mut Vec<String>,
        (words, seen): (&Words, &BenchSnapshot),
    ) {
        let palette = Palette::of(ui);
        framed(ui, |ui| {
            ui.horizontal(|ui| {
                heading(ui, words.bench.plot);
                self.choose(ui, plotted, words);
            });
            let size = vec2(ui.available_width(), height);
            let (area, response) = ui.allocate_exact_size(size, Sense::hover());
            response.widget_info(|| {
                let value = |signal: &Signal| text::value(&words.bench, *signal, seen);
                let name = |signal: &Signal| naming::signal(signal.name(), words);
                let now = signals.iter().map(|s| format!("{} {}", name(s), value(s)));
                let now: Vec<_> = now.collect();
                let name = format!("{}: {}", words.bench.plot, now.join(", "));
                WidgetInfo::labeled(Role::Image, true, name)
            });
            if signals.is_empty() {
                let (painter, middle) = (ui.painter(), area.center());
                put_centred(
                    painter,
                    middle,
                    14.0,
                    palette.quiet,
                    words.bench.plot_nothing,
                );
                return;
            }
            self.paint(&Sheet {
                painter: ui.painter_at(area),
                area,
                signals,
                words,
                seen,
                palette: &palette,
            });
        });
    }

    /// Controls for the span that is shown, and for the signals, by name.
    fn choose(&mut self, ui: &mut Ui, plotted: &mut Vec<String>, words: &Words) {
        for span_s in SPANS_S {
            let text = fill(words.bench.plot_last, &[("time", &span_s)]);
            if ui.selectable_label(self.span_s == span_s, text).clicked() {
                self.span_s = span_s;
            }
        }
        let stay = MenuConfig::default().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        MenuButton::new(words.bench.plot_signals)
            .config(stay)
            .ui(ui, |ui| self.signals(ui, plotted, words));
    }

    fn signals(&mut self, ui: &mut Ui, plotted: &mut Vec<String>, words: &Words) {
        find_edit(ui, &mut self.find, words.bench.plot_find, 180.0);
        let find = self.find.trim().to_lowercase();
        let full = chosen(plotted).len() >= MOST;
        let scroll = ScrollArea::vertical().max_height(360.0);
        scroll.show(ui, |ui| {
            for signal in Signal::ALL {
                let (name, said) = (signal.name(), naming::signal(signal.name(), words));
                if !name.contains(&find) && !said.to_lowercase().contains(&find) {
                    continue;
                }
                let place = plotted.iter().position(|one| one == name);
                let mut on = place.is_some();
                let check = ui.add_enabled(on || !full, Checkbox::new(&mut on, said));
                let check = check.on_hover_text(&*words.content(signal.definition().doc));
                if !check.changed() {
                    continue;
                }
                match place {
                    Some(place) => {
                        plotted.remove(place);
                    }
                    None => plotted.push(name.to_owned()),
                }
            }
        });
    }

    fn paint(&mut self, sheet: &Sheet<'_>) {
        let (from, to) = (-f64::from(self.span_s), 0.0);
        let window = Window { from, to };
        let lanes = lanes(sheet.signals);
        let (painter, palette) = (&sheet.painter, sheet.palette);
        let curves = sheet
            .area
            .with_min_x(sheet.area.left() + NAMES + SCALE)
            .with_max_y(sheet.area.bottom() - lane::AXIS_HEIGHT);
        lane::grid(painter, curves, window, palette);
        let axis = Rect::from_min_max(curves.left_bottom(), sheet.area.right_bottom());
        lane::x_axis(painter, axis, window, "s", palette);
        let pixels = curves.width().max(1.0) as usize;
        for (lane, rect) in lanes.iter().zip(rects(curves, &lanes)) {
            match lane {
                Lane::Quantities(places) => self.quantities(sheet, rect, places, window, pixels),
                Lane::Choice(place) | Lane::Bit(place) => {
                    let of_lane = self.rows.samples(*place);
                    samples::spans(of_lane, window, pixels, &mut self.spans);
                    let (spans, colour) = (&self.spans, sheet.colour(*place));
                    if matches!(lane, Lane::Bit(_)) {
                        lane::bit(painter, rect, spans, colour);
                    } else {
                        let signal = sheet.signals[*place];
                        let label = |value| text::known(&sheet.words.bench, signal, value);
                        lane::choice(painter, rect, spans, colour, palette, label);
                    }
                    sheet.names(rect, &[*place]);
                }
            }
        }
    }

    /// Draws a lane of quantities, all on one scale.
    fn quantities(
        &mut self,
        sheet: &Sheet<'_>,
        rect: Rect,
        places: &[usize],
        window: Window,
        pixels: usize,
    ) {
        let mut all = Column::EMPTY;
        self.columns.resize_with(places.len(), Vec::new);
        for (place, columns) in places.iter().zip(&mut self.columns) {
            samples::columns(self.rows.samples(*place), window, pixels, columns);
            columns.iter().for_each(|column| all.merge(*column));
        }
        let range = ticks::range(all.extent().unwrap_or((0.0, 1.0)));
        let scale = rect.with_max_x(rect.left()).with_min_x(rect.left() - SCALE);
        lane::y_axis(&sheet.painter, scale, rect, range, sheet.palette);
        for (place, columns) in places.iter().zip(&self.columns) {
            lane::quantity(&sheet.painter, rect, columns, range, sheet.colour(*place));
        }
        sheet.names(rect, places);
    }
}

/// Areas of the lanes: lanes of quantities share the height that lanes of states leave.
fn rects(curves: Rect, lanes: &[Lane]) -> impl Iterator<Item = Rect> {
    let tall = |lane: &Lane| matches!(lane, Lane::Quantities(_));
    let count = lanes.iter().filter(|lane| tall(lane)).count() as f32;
    let low = lanes.len() as f32 - count;
    let states = (curves.height() / (low + count * TALL)).min(STATES);
    let quantities = (curves.height() - low * states) / count.max(1.0);
    let heights = lanes
        .iter()
        .map(move |lane| if tall(lane) { quantities } else { states });
    heights.scan(curves.top(), move |top, height| {
        let corner = pos2(curves.left(), *top);
        *top += height;
        let rect = Rect::from_min_size(corner, vec2(curves.width(), height));
        Some(rect.shrink2(vec2(0.0, 1.0)))
    })
}

/// Surface of the plot, with what is painted on it.
struct Sheet<'a> {
    painter: Painter,
    area: Rect,
    signals: &'a [Signal],
    words: &'a Words,
    seen: &'a BenchSnapshot,
    palette: &'a Palette,
}

impl Sheet<'_> {
    fn colour(&self, place: usize) -> Color32 {
        self.palette.curves[place % self.palette.curves.len()]
    }

    /// Writes names and present values of a lane's signals, left of the lane.
    fn names(&self, rect: Rect, places: &[usize]) {
        let height = (rect.height() / places.len() as f32).min(NAME);
        let size = (height - 1.0).clamp(7.0, 12.0);
        let first = rect.center().y - height * (places.len() as f32 - 1.0) / 2.0;
        for (row, place) in places.iter().enumerate() {
            let y = first + row as f32 * height;
            let signal = self.signals[*place];
            let colour = self.colour(*place);
            let value = text::value(&self.words.bench, signal, self.seen);
            let (left, right) = (self.area.left(), self.area.left() + NAMES);
            let of_value = (pos2(right, y), Align2::RIGHT_CENTER);
            let font = FontId::proportional(size);
            let painter = &self.painter;
            let value = painter.text(of_value.0, of_value.1, value, font.clone(), colour);
            let of_name = left..=(value.left() - NAME).max(left);
            let of_name = Rect::from_x_y_ranges(of_name, y - height / 2.0..=y + height / 2.0);
            let name = naming::signal(signal.name(), self.words);
            lane::cut_text(painter, of_name, name, font, colour);
        }
    }
}
