//! The trace that is drawn behind another one, and where the two deviate.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{TracePlot, axis};
use crate::trace_view::overlay::{FirstDifference, Overlay, OverlaySource};
use crate::trace_view::view::TraceView;
use crate::trace_view::{Axis, Kind};

/// The trace that is drawn behind for comparison.
#[derive(Debug)]
pub struct OverlayTrace {
    pub overlay: Arc<Overlay>,
    pub axis: Axis,
    /// Rows by which it is laid later.
    pub shift_rows: i64,
    /// The first difference; `None` until it is computed.
    pub parting: Option<FirstDifference>,
}

impl TracePlot {
    /// Lays something behind the trace.
    pub fn lay_behind(&mut self, overlay: Arc<Overlay>) {
        self.behind = Some(OverlayTrace {
            axis: behind_axis(&overlay.view, self.axis.kind(), 0),
            overlay,
            shift_rows: 0,
            parting: None,
        });
    }

    /// Removes the trace behind.
    pub fn lay_nothing_behind(&mut self) {
        self.behind = None;
    }

    /// Shifts the trace behind by this many rows; where the two deviate has to be computed again.
    pub fn shift(&mut self, rows: i64) {
        let kind = self.axis.kind();
        if let Some(behind) = &mut self.behind
            && behind.shift_rows != rows
        {
            behind.shift_rows = rows;
            behind.axis = behind_axis(&behind.overlay.view, kind, rows);
        }
    }

    /// Takes the first difference from the trace behind.
    pub fn told(&mut self, against: &OverlaySource, parting: FirstDifference) {
        if let Some(behind) = &mut self.behind
            && behind.overlay.against == *against
        {
            behind.parting = Some(parting);
        }
    }

    /// Shows the signals that deviate, the first one first, and where they begin to.
    pub fn show_deviating(&mut self, most: usize) {
        let parting = self.behind.as_ref().and_then(|b| b.parting.as_ref());
        let Some(parting) = parting else {
            return;
        };
        let mut signals: Vec<_> = parting.stretches.iter().collect();
        signals.sort_by_key(|(_, stretches)| stretches.first().map(|rows| rows.start));
        let first = parting.first.as_ref();
        let row = first.map(|first| first.row);
        let mut names: Vec<String> = first.map(|f| f.signal.clone()).into_iter().collect();
        names.extend(signals.into_iter().map(|(name, _)| name.clone()));
        let mut known = BTreeSet::new();
        names.retain(|name| known.insert(name.clone()));
        names.truncate(most);
        if !names.is_empty() {
            self.set_signals(&names);
        }
        if let Some(row) = row {
            self.camera.centre(self.axis.at(row));
        }
    }
}

/// Axis of the trace behind; of a trace without distance no row is in view.
pub(super) fn behind_axis(view: &TraceView, kind: Kind, shift_rows: i64) -> Axis {
    axis(view, kind, shift_rows).unwrap_or_else(|| Axis::Distance {
        at_m: Vec::new(),
        rows_back: 0,
        back_m: 0.0,
    })
}
