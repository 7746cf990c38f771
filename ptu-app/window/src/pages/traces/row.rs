//! Draws one lane with its name, its values at the cursors, and the trace behind.

use std::ops::Range;

use eframe::egui::{
    Align, Color32, Label, Layout, Rect, RichText, Stroke, Ui, UiBuilder, pos2, vec2,
};

use super::lane_columns::{LaneColumns, TICKS};
use super::table;
use crate::Palette;
use crate::parts::lane;
use ptu_report::trace_view::value::named;
use ptu_report::trace_view::{
    Axis, Column, Edges, Lane, OverlayTrace, Span, Summary, TracePlot, TraceView,
};
use ptu_report::words::Words;

/// Usual heights of lanes, points.
const QUANTITY: f32 = 74.0;
const CHOICE: f32 = 26.0;
const BIT: f32 = 24.0;
/// Height of a lane with two signals one above the other, as a multiple of the usual one.
const TWO: f32 = 1.7;
/// Greatest height of a quantity where there is room, as a multiple of the usual one.
const TALLEST: f32 = 2.0;
/// Height of one signal's line in a lane of several signals, points.
const LINE: f32 = 28.0;
/// Gap between lanes, points.
pub const GAP: f32 = 4.0;

/// The trace, layout and colours from which lanes are painted.
pub struct Sheet<'a> {
    /// The trace, with its lanes and the visible span.
    pub scene: &'a TracePlot,
    /// Horizontal positions of names, curves and values.
    pub places: LaneColumns,
    /// Rows whose values are shown: at the cursors, or else at the pointer.
    pub rows: [Option<usize>; 2],
    pub words: &'a Words,
    pub palette: &'a Palette,
}

/// Buffers that each lane uses again, so that no memory is allocated for it.
#[derive(Default)]
pub struct Scratch {
    own: Edges,
    behind: Edges,
    columns: Vec<Column>,
    spans: Vec<Span>,
}

/// A signal of one of the two traces, with the axis on which its rows lie.
#[derive(Clone, Copy)]
struct Source<'a> {
    view: &'a TraceView,
    place: usize,
    axis: &'a Axis,
}

impl Scratch {
    /// Finds the first row of each column of pixels; all lanes share these.
    pub fn edges(&mut self, scene: &TracePlot, width: f32) {
        let columns = width.round().max(1.0) as usize;
        scene.axis.edges(scene.window(), columns, &mut self.own);
        if let Some(behind) = scene.behind.as_ref() {
            behind.axis.edges(scene.window(), columns, &mut self.behind);
        }
    }
}

impl Sheet<'_> {
    /// Heights of all lanes; lanes of quantities take the room that is left.
    pub fn heights(&self, room: f32) -> Vec<f32> {
        let groups = self.scene.groups();
        let lanes = &self.scene.lanes;
        let first = |group: &Range<usize>| &lanes[group.start];
        let height = |group: &Range<usize>| {
            // Each name in the group has a line.
            self.height(first(group)).max(group.len() as f32 * LINE)
        };
        let mut heights: Vec<f32> = groups.iter().map(height).collect();
        let gaps = GAP * groups.len() as f32;
        let used = |of: &dyn Fn(&Lane) -> bool| -> f32 {
            let those = groups.iter().zip(&heights);
            let those = those.filter(|(group, _)| of(first(group)));
            those.map(|(_, height)| height).sum()
        };
        let elastic = |lane: &Lane| {
            let summary = lane.place.map(|place| self.scene.view().summary(place));
            matches!(summary, Some(Summary::Quantity(_)))
        };
        let free = room - gaps - used(&|_| true);
        let times = (1.0 + free / used(&elastic).max(1.0)).clamp(1.0, TALLEST);
        for (group, height) in groups.iter().zip(&mut heights) {
            if elastic(first(group)) {
                *height *= times;
            }
        }
        heights
    }

    fn height(&self, lane: &Lane) -> f32 {
        let two = if self.other(&lane.signal).is_some() {
            TWO
        } else {
            1.0
        };
        let usual = match lane.place.map(|place| self.scene.view().summary(place)) {
            Some(Summary::Quantity(_)) => QUANTITY,
            Some(Summary::Choice(_)) => CHOICE * two,
            Some(Summary::Bit(_)) => BIT * two,
            Some(Summary::Unknown) | None => BIT,
        };
        usual * lane.stretch
    }

    /// Draws the signals of one lane.
    pub fn group(&self, ui: &mut Ui, group: Range<usize>, row: Rect, scratch: &mut Scratch) {
        let places = &self.places;
        let rect =
            Rect::from_x_y_ranges(places.left..=places.right, row.top()..=row.bottom() - GAP);
        let between = Stroke::new(1.0, self.palette.grid);
        ui.painter()
            .hline(places.names..=places.end, row.bottom() - GAP / 2.0, between);
        let lanes = &self.scene.lanes[group.clone()];
        // Colour tells curves of a lane apart; a state is grey unless it deviates.
        let curves = &self.palette.curves;
        let is_state = |lane: &Lane| {
            let summary = lane.place.map(|place| self.scene.view().summary(place));
            matches!(summary, Some(Summary::Choice(_) | Summary::Bit(_)))
        };
        let colour = |number: usize| match lanes {
            [one] if is_state(one) => self.palette.edge,
            [_] => self.palette.accent,
            _ => curves[number % curves.len()],
        };
        let high = rect.height() / lanes.len() as f32;
        // Each signal of the lane has its name and its values in a line of its own.
        let line = |number: usize| {
            let top = rect.top() + number as f32 * high;
            Rect::from_x_y_ranges(rect.x_range(), top..=top + high)
        };
        for (number, lane) in lanes.iter().enumerate() {
            let ink = match lanes.len() {
                1 => self.palette.ink,
                _ => colour(number),
            };
            self.name(ui, lane, line(number), ink);
            if let Some(behind) = self.scene.behind.as_ref().filter(|_| lane.place.is_some()) {
                self.shade(ui, behind, &lane.signal, rect);
            }
        }
        let Some((first, place)) = lanes.first().and_then(|lane| Some((lane, lane.place?))) else {
            note(ui, rect, self.words.traces.not_in_trace, self.palette.warn);
            return;
        };
        let own = self.own(place);
        match own.view.summary(place) {
            Summary::Unknown => note(ui, rect, self.words.traces.not_known, self.palette.quiet),
            Summary::Quantity(_) => self.quantities(ui, lanes, rect, &colour, scratch),
            Summary::Choice(_) | Summary::Bit(_) => {
                self.two_states(ui, first, own, rect, colour(0), scratch);
            }
        }
        for (number, lane) in lanes.iter().enumerate() {
            if let Some(place) = lane.place {
                self.values(ui, place, line(number));
            }
        }
    }

    /// The signal at this index of the trace.
    fn own(&self, place: usize) -> Source<'_> {
        Source {
            view: self.scene.view(),
            place,
            axis: &self.scene.axis,
        }
    }

    /// The signal of this name in the trace behind.
    fn other(&self, signal: &str) -> Option<Source<'_>> {
        let behind = self.scene.behind.as_ref()?;
        let view = &behind.overlay.view;
        Some(Source {
            view,
            place: view.place(signal)?,
            axis: &behind.axis,
        })
    }

    /// Curves on one axis, whose range covers all of them.
    fn quantities(
        &self,
        ui: &Ui,
        lanes: &[Lane],
        rect: Rect,
        colour: &dyn Fn(usize) -> Color32,
        scratch: &mut Scratch,
    ) {
        let of = |lane: &Lane| Some(self.scene.range(lane.place?));
        let ranges = lanes.iter().filter_map(of);
        let both = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
        let Some(range) = ranges.reduce(both) else {
            return;
        };
        let ticks = self.places.left - TICKS..=self.places.left;
        let gutter = Rect::from_x_y_ranges(ticks, rect.y_range());
        lane::y_axis(ui.painter(), gutter, rect, range, self.palette);
        let Scratch {
            own: edges,
            behind,
            columns,
            ..
        } = scratch;
        let mut curve = |source: Source<'_>, edges: &Edges, colour| {
            if let Summary::Quantity(pyramid) = source.view.summary(source.place) {
                pyramid.columns(source.view.samples(source.place), edges, columns);
                lane::quantity(ui.painter(), rect, columns, range, colour);
            }
        };
        for other in lanes.iter().filter_map(|lane| self.other(&lane.signal)) {
            curve(other, behind, self.palette.quiet);
        }
        for (number, place) in lanes.iter().map(|lane| lane.place).enumerate() {
            let Some(place) = place else { continue };
            curve(self.own(place), edges, colour(number));
        }
    }

    /// Draws a state in the upper half and that of the trace behind in the lower: one over the other hides the text.
    fn two_states(
        &self,
        ui: &Ui,
        lane: &Lane,
        own: Source<'_>,
        rect: Rect,
        colour: Color32,
        scratch: &mut Scratch,
    ) {
        let (mut above, mut below) = (rect, rect);
        let Scratch {
            own: edges,
            behind,
            spans,
            ..
        } = scratch;
        if let Some(other) = self.other(&lane.signal) {
            above.max.y = rect.center().y;
            below.min.y = rect.center().y;
            self.states(ui, other, below, self.palette.quiet, behind, spans);
        }
        self.states(ui, own, above, colour, edges, spans);
    }

    fn states(
        &self,
        ui: &Ui,
        source: Source<'_>,
        rect: Rect,
        colour: Color32,
        edges: &Edges,
        spans: &mut Vec<Span>,
    ) {
        let channel = source.view.channel(source.place);
        let window = self.scene.window();
        match source.view.summary(source.place) {
            Summary::Choice(runs) => {
                runs.spans(source.axis, window, edges, spans);
                let label = |value| named(channel, value, self.words);
                lane::choice(ui.painter(), rect, spans, colour, self.palette, label);
            }
            Summary::Bit(runs) => {
                runs.spans(source.axis, window, edges, spans);
                lane::bit(ui.painter(), rect, spans, colour);
            }
            Summary::Quantity(_) | Summary::Unknown => {}
        }
    }

    /// Name and unit of a signal, and a word where the signal deviates from the trace behind.
    fn name(&self, ui: &mut Ui, lane: &Lane, rect: Rect, colour: Color32) {
        let view = self.scene.view();
        let unit = lane.place.map_or("", |place| &view.channel(place).unit);
        let from = pos2(self.places.names + 2.0, rect.top());
        let area = Rect::from_min_max(from, pos2(self.places.left - TICKS, rect.bottom()));
        let layout = Layout::top_down(Align::Min);
        let ui = &mut ui.new_child(UiBuilder::new().max_rect(area).layout(layout));
        ui.set_clip_rect(ui.clip_rect().intersect(area));
        let text = RichText::new(&*self.words.signal(&lane.signal))
            .color(colour)
            .strong();
        ui.add(Label::new(text).truncate().selectable(false));
        if rect.height() >= QUANTITY / 2.0 && !unit.is_empty() {
            let text = RichText::new(unit)
                .size(lane::TEXT)
                .color(self.palette.quiet);
            ui.add(Label::new(text).selectable(false));
        }
        let parting = self.scene.behind.as_ref().and_then(|b| b.parting.as_ref());
        if parting.is_some_and(|parting| parting.stretches.contains_key(&lane.signal)) {
            let text = format!("≠ {}", self.words.traces.deviates);
            let text = RichText::new(text).size(lane::TEXT).color(self.palette.bad);
            ui.add(Label::new(text).selectable(false));
        }
    }

    /// Values under the cursors, or under the pointer.
    fn values(&self, ui: &mut Ui, place: usize, rect: Rect) {
        let view = self.scene.view();
        let rows = self.rows.into_iter().flatten();
        let known = rows.filter_map(|row| view.samples(place).get(row));
        let said = known.map(|value| named(view.channel(place), *value, self.words));
        let mut shown: Vec<String> = said.collect();
        if shown.len() == 2 {
            shown.push(table::difference(self.scene, place));
        }
        for (i, text) in shown.iter().enumerate().filter(|(_, t)| !t.is_empty()) {
            let colour = ui.visuals().text_color();
            put_right(ui, self.places.value(i, rect), text, colour);
        }
    }

    /// Rows in which the signal deviates from the trace behind: a tint, and a bar along the lower edge.
    fn shade(&self, ui: &Ui, behind: &OverlayTrace, signal: &str, rect: Rect) {
        let parting = behind.parting.as_ref();
        let Some(stretches) = parting.and_then(|parting| parting.stretches.get(signal)) else {
            return;
        };
        let painter = ui.painter_at(rect);
        let (window, axis, bad) = (self.scene.window(), &self.scene.axis, self.palette.bad);
        let mut painted = rect.left();
        for rows in stretches {
            let from = lane::x_at(rect, window, axis.at(rows.start));
            let to = lane::x_at(rect, window, axis.at(rows.end)).max(from + 1.0);
            // A stretch within a pixel that is painted already needs no painting.
            if to <= painted || from > rect.right() {
                continue;
            }
            let area = Rect::from_x_y_ranges(from.max(painted)..=to, rect.y_range());
            painter.rect_filled(area, 0.0, bad.gamma_multiply(0.2));
            painter.hline(area.x_range(), rect.bottom() - 1.0, Stroke::new(2.0, bad));
            painted = to;
        }
    }
}

/// A text at the right edge of an area.
pub fn put_right(ui: &mut Ui, area: Rect, text: &str, colour: Color32) {
    let layout = Layout::right_to_left(Align::Center);
    let ui = &mut ui.new_child(UiBuilder::new().max_rect(area).layout(layout));
    let text = RichText::new(text).size(lane::TEXT + 1.0).color(colour);
    ui.add(Label::new(text).truncate().selectable(false));
}

/// A word instead of a curve.
fn note(ui: &mut Ui, rect: Rect, text: &str, colour: Color32) {
    let area = Rect::from_min_size(rect.min + vec2(6.0, 0.0), rect.size());
    let layout = Layout::left_to_right(Align::Center);
    let ui = &mut ui.new_child(UiBuilder::new().max_rect(area).layout(layout));
    ui.add(Label::new(RichText::new(text).color(colour)).selectable(false));
}
