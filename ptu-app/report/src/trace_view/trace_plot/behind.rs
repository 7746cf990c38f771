//! The trace that is drawn behind another one, and where the two deviate.

use std::collections::BTreeSet;

use super::TracePlot;
use crate::trace_view::overlay::{FirstDifference, OverlaySource};

impl TracePlot {
    /// Shifts the trace behind by this many rows; where the two deviate has to be computed again.
    pub fn shift(&mut self, rows: i64) {
        let kind = self.axis.kind();
        if let Some(behind) = &mut self.behind
            && behind.shift_rows != rows
        {
            behind.shift_rows = rows;
            behind.set_axis(kind);
        }
    }

    /// Keeps the first difference from the trace behind, unless another trace is behind by now.
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
