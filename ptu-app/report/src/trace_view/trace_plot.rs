//! The view of a trace: lanes, the part in view, cursors, and the trace behind.

mod behind;

use std::ops::Range;
use std::sync::Arc;

use super::listing::OpenTrace;
use super::statistics::{self, Statistics};
use super::view::{Summary, TraceView};
use super::{Axis, Kind, OverlayTrace, VisibleRange, Window, choose};
use crate::ticks;

/// Fewest rows in view.
const FEWEST_ROWS: f64 = 8.0;
/// Least way in view, m.
const LEAST_WAY_M: f64 = 0.5;

/// Zooms that can be undone.
const MOST_ZOOMS: usize = 50;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cursor {
    A,
    B,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Lane {
    pub signal: String,
    /// Where the signal is in the trace; `None` = the trace lacks it.
    pub place: Option<usize>,
    /// Height as a multiple of the usual height.
    pub stretch: f32,
    /// The signal is drawn in the lane of the signal above it.
    pub joined: bool,
}

/// Sign before a listed signal that is drawn in the lane of the signal above it.
const JOINED: char = '+';

/// Name of the signal in an entry of a list of signals.
pub fn bare(entry: &str) -> &str {
    entry.strip_prefix(JOINED).unwrap_or(entry)
}

/// The entry of the same signal, moved into the lane of the signal above it or back into a lane of its own.
pub fn toggled(entry: &str) -> String {
    match entry.strip_prefix(JOINED) {
        Some(alone) => alone.to_owned(),
        None => format!("{JOINED}{entry}"),
    }
}

/// A trace with all that a person has chosen to see of it.
#[derive(Debug)]
pub struct TracePlot {
    pub opened: Arc<OpenTrace>,
    pub axis: Axis,
    pub camera: VisibleRange,
    /// Lanes from top to bottom.
    pub lanes: Vec<Lane>,
    cursors: [Option<usize>; 2],
    /// The scale of a quantity spans the values in view; else all values of the trace.
    pub close: bool,
    pub behind: Option<OverlayTrace>,
    /// Views before each zoom, the latest last.
    before: Vec<Window>,
    /// Rows of the statistics, and the statistics by lane; empty until somebody asks for statistics.
    said: (Range<usize>, Vec<Option<Statistics>>),
}

impl TracePlot {
    /// The whole trace over time, with these signals; with the usual signals if the list is empty.
    pub fn new(opened: Arc<OpenTrace>, signals: &[String]) -> Self {
        let axis = Axis::time(opened.view.data(), opened.view.trigger_row() as i64);
        let mut scene = Self {
            camera: camera(&axis, &opened.view),
            axis,
            opened,
            lanes: Vec::new(),
            cursors: [None; 2],
            close: false,
            behind: None,
            before: Vec::new(),
            said: Default::default(),
        };
        scene.set_signals(signals);
        scene
    }

    pub fn view(&self) -> &TraceView {
        &self.opened.view
    }

    pub fn window(&self) -> Window {
        self.camera.window()
    }

    /// Sets the axis to time or distance; false if the trace tells no distance. The same rows stay in view.
    pub fn set_axis(&mut self, kind: Kind) -> bool {
        if self.axis.kind() == kind {
            return true;
        }
        let Some(axis) = Axis::of(kind, self.opened.view.data(), 0) else {
            return false;
        };
        self.before.clear();
        let rows = self.rows_in_view();
        self.camera = camera(&axis, &self.opened.view);
        if rows.len() < self.axis.rows() && !rows.is_empty() {
            self.camera.show(axis.at(rows.start), axis.at(rows.end));
        }
        self.axis = axis;
        if let Some(behind) = &mut self.behind {
            behind.set_axis(kind);
        }
        true
    }

    /// Shows these signals from top to bottom; the usual signals if the list is empty.
    pub fn set_signals(&mut self, signals: &[String]) {
        let usual;
        let signals = if signals.is_empty() {
            usual = choose::usual(&self.opened.view);
            &usual
        } else {
            signals
        };
        let known = std::mem::take(&mut self.lanes);
        let lane = |entry: &String| {
            let signal = bare(entry);
            Lane {
                stretch: known
                    .iter()
                    .find(|lane| lane.signal == signal)
                    .map_or(1.0, |lane| lane.stretch),
                place: self.opened.view.place(signal),
                joined: signal.len() < entry.len(),
                signal: signal.to_owned(),
            }
        };
        self.lanes = signals.iter().map(lane).collect();
        self.said = Default::default();
    }

    /// The signals shown, from top to bottom, as [`set_signals`](Self::set_signals) takes them.
    pub fn signals(&self) -> Vec<String> {
        let entry = |lane: &Lane| match lane.joined {
            true => toggled(&lane.signal),
            false => lane.signal.clone(),
        };
        self.lanes.iter().map(entry).collect()
    }

    /// Whether a signal can be drawn in the lane of the signal above it: both are quantities of the same unit.
    pub fn can_join(&self, lane: usize) -> bool {
        let unit = |lane: usize| {
            let place = self.lanes.get(lane)?.place?;
            let is_quantity = matches!(self.view().summary(place), Summary::Quantity(_));
            is_quantity.then(|| &self.view().channel(place).unit)
        };
        lane > 0 && unit(lane).is_some() && unit(lane) == unit(lane - 1)
    }

    /// Ranges of `lanes` that are drawn together in one lane, from top to bottom.
    pub fn groups(&self) -> Vec<Range<usize>> {
        let mut groups: Vec<Range<usize>> = Vec::new();
        for (place, lane) in self.lanes.iter().enumerate() {
            match groups.last_mut() {
                Some(group) if lane.joined && self.can_join(place) => group.end = place + 1,
                _ => groups.push(place..place + 1),
            }
        }
        groups
    }

    /// Zooms to a stretch of the axis; [`zoom_back`](Self::zoom_back) undoes it.
    pub fn zoom_to(&mut self, from: f64, to: f64) {
        self.remember();
        let (from, to) = (from.min(to), from.max(to));
        self.camera.restore(Window { from, to });
    }

    /// Keeps what is in view now for [`zoom_back`](Self::zoom_back).
    pub fn remember(&mut self) {
        if self.before.last() == Some(&self.window()) {
            return;
        }
        if self.before.len() == MOST_ZOOMS {
            self.before.remove(0);
        }
        self.before.push(self.window());
    }

    /// Restores the view before the last zoom; false when there was none.
    pub fn zoom_back(&mut self) -> bool {
        let before = self.before.pop();
        if let Some(window) = before {
            self.camera.restore(window);
        }
        before.is_some()
    }

    /// Whether a zoom can be undone.
    pub fn can_zoom_back(&self) -> bool {
        !self.before.is_empty()
    }

    /// Makes a lane taller or flatter.
    pub fn stretch(&mut self, lane: usize, times: f32) {
        if let Some(lane) = self.lanes.get_mut(lane) {
            lane.stretch = (lane.stretch * times).clamp(0.5, 6.0);
        }
    }

    /// Scale of a quantity: its least and greatest value, also in the trace behind, with some room. With `close` the
    /// values in view count, else all values of the trace.
    pub fn range(&self, place: usize) -> (f64, f64) {
        let extent = |view: &TraceView, place, axis: &Axis| {
            if self.close {
                view.extent_of(place, axis.rows_in(self.window()))
            } else {
                view.extent(place)
            }
        };
        let own = extent(self.view(), place, &self.axis);
        let other = self.behind.as_ref().and_then(|behind| {
            let view = &behind.overlay.view;
            let place = view.place(&self.view().channel(place).name)?;
            extent(view, place, &behind.axis)
        });
        let all = match (own, other) {
            (Some(a), Some(b)) => (a.0.min(b.0), a.1.max(b.1)),
            (a, b) => a.or(b).unwrap_or((0.0, 0.0)),
        };
        ticks::range(all)
    }

    pub fn rows_in_view(&self) -> Range<usize> {
        self.axis.rows_in(self.window())
    }

    /// Row of a cursor.
    pub fn cursor(&self, cursor: Cursor) -> Option<usize> {
        self.cursors[cursor as usize]
    }

    /// Puts a cursor on the last row at or before a place on the axis; does nothing before the first row.
    pub fn put(&mut self, cursor: Cursor, place: f64) {
        if let Some(row) = self.axis.row_at(place) {
            self.cursors[cursor as usize] = Some(row);
        }
    }

    /// Moves a cursor by rows.
    pub fn step(&mut self, cursor: Cursor, rows: isize) {
        let last = self.axis.rows().saturating_sub(1);
        if let Some(row) = &mut self.cursors[cursor as usize] {
            *row = row.saturating_add_signed(rows).min(last);
        }
    }

    /// Takes both cursors away.
    pub fn clear_cursors(&mut self) {
        self.cursors = [None; 2];
    }

    /// Value of a signal under a cursor: the last sample at or before it.
    pub fn value(&self, place: usize, cursor: Cursor) -> Option<f64> {
        let row = self.cursor(cursor)?;
        self.view().samples(place).get(row).copied()
    }

    /// Increase of a quantity from A to B.
    pub fn difference(&self, place: usize) -> Option<f64> {
        let Summary::Quantity(_) = self.view().summary(place) else {
            return None;
        };
        Some(self.value(place, Cursor::B)? - self.value(place, Cursor::A)?)
    }

    /// Rows for the statistics, and whether they are those between the cursors, both included; else they are in view.
    pub fn stretch_rows(&self) -> (Range<usize>, bool) {
        match self.cursors {
            [Some(a), Some(b)] => (a.min(b)..a.max(b) + 1, true),
            _ => (self.rows_in_view(), false),
        }
    }

    /// Statistics by lane over [`stretch_rows`](Self::stretch_rows); `None` for a signal that the trace lacks.
    pub fn statistics(&mut self) -> &[Option<Statistics>] {
        let (rows, _) = self.stretch_rows();
        if self.said.0 != rows || self.said.1.len() != self.lanes.len() {
            let of = |lane: &Lane| {
                let place = lane.place?;
                Some(statistics::over(&self.opened.view, place, rows.clone()))
            };
            self.said = (rows.clone(), self.lanes.iter().map(of).collect());
        }
        &self.said.1
    }
}

fn camera(axis: &Axis, view: &TraceView) -> VisibleRange {
    let least = match axis.kind() {
        Kind::Time => FEWEST_ROWS * view.data().period_us as f64 / 1e6,
        Kind::Distance => LEAST_WAY_M,
    };
    VisibleRange::new(axis.whole(), least)
}

#[cfg(test)]
mod tests;
