//! A trace of another run or of a good unit behind a trace, and the place where the two first
//! differ.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use fault_db::{Id, Store, TraceData};

use super::{Axis, Kind, TraceView};
use crate::trace_io::{Columns, beside};
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::failure::{Failure, Trouble};
use ptu_runs::replay::{Comparison, Deviation, Original, Rule, compare, good_twin, rule_between};

/// Source of the trace with which a trace is compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OverlaySource {
    /// The trace of a sound unit under the same stimuli.
    Twin,
    /// Another trace.
    Trace(Id),
    /// Signals of a file.
    File(Arc<Path>),
}

/// A trace that is shown behind another one.
#[derive(Debug)]
pub struct Overlay {
    pub against: OverlaySource,
    pub view: TraceView,
    rule: Rule,
    /// Rows of the trace for which the other trace has samples; `None` = all rows of the other trace.
    has: Option<Range<usize>>,
}

/// The trace that is drawn behind for comparison.
#[derive(Debug)]
pub struct OverlayTrace {
    pub overlay: Arc<Overlay>,
    pub axis: Axis,
    /// Rows by which the trace behind is shifted to later times.
    pub shift_rows: i64,
    /// The first difference; `None` until it is computed.
    pub parting: Option<FirstDifference>,
}

impl OverlayTrace {
    pub fn new(overlay: Arc<Overlay>, kind: Kind) -> Self {
        let mut behind = Self {
            axis: Axis::places(Vec::new()),
            overlay,
            shift_rows: 0,
            parting: None,
        };
        behind.set_axis(kind);
        behind
    }

    /// Sets the axis to time or distance; by distance, no row of a trace without distance is in view.
    pub fn set_axis(&mut self, kind: Kind) {
        let axis = Axis::of(kind, self.overlay.view.data(), self.shift_rows);
        self.axis = axis.unwrap_or_else(|| Axis::places(Vec::new()));
    }
}

/// The first difference between a trace and the trace behind, which may be shifted by some rows.
#[derive(Debug)]
pub struct FirstDifference {
    /// Rows by which the trace behind is shifted to later times.
    pub shift_rows: i64,
    /// Rows of the trace that differ, by signal.
    pub stretches: BTreeMap<String, Vec<Range<usize>>>,
    /// The first signal that differs.
    pub first: Option<Deviation>,
    /// Why the comparison failed.
    pub trouble: Option<Trouble>,
}

impl Overlay {
    /// Reads or makes the trace that is laid behind the trace `id`.
    ///
    /// # Errors
    /// The other trace is gone, this one has no recording, what its bench was made of is gone, or the file cannot be read or has
    /// nothing in common with the trace.
    pub fn get(
        store: &Store,
        scripts: &ScriptsDirectory,
        id: Id,
        against: OverlaySource,
    ) -> Result<Self, Failure> {
        let (data, rule, has) = match &against {
            OverlaySource::Twin => {
                let (twin, rule) = good_twin(&Original::read(store, id)?, scripts)?;
                (twin, rule, None)
            }
            OverlaySource::Trace(other) => {
                (store.trace(*other)?, rule_between(store, id, *other)?, None)
            }
            OverlaySource::File(file) => {
                let (aligned, rule) =
                    beside(store, (id, store.trace(id)?), file, 0, &Columns::default())?;
                (aligned.imported, rule, Some(aligned.rows))
            }
        };
        Ok(Self {
            against,
            view: TraceView::new(data),
            rule,
            has,
        })
    }

    /// The first difference of `came` from this trace.
    pub fn parting(&self, came: &TraceView, shift_rows: i64) -> FirstDifference {
        let rule = self.rule.shifted(shift_rows);
        let beside;
        let came = match &self.has {
            None => came.data(),
            // Rows that the trace behind leaves out do not differ.
            Some(has) => {
                beside = only(came.data(), has, shift_rows);
                &beside
            }
        };
        let (found, trouble) = match compare(came, self.view.data(), &rule, &[]) {
            Ok(found) => (Some(found), None),
            Err(failure) => (None, Some(failure.message)),
        };
        let deviations = found.map_or_else(Vec::new, |found: Comparison| found.deviations);
        FirstDifference {
            shift_rows,
            first: deviations.first().cloned(),
            stretches: deviations
                .into_iter()
                .map(|deviation| (deviation.signal, deviation.stretches))
                .collect(),
            trouble,
        }
    }
}

/// The trace with no sample known outside these rows, which are shifted by `later` rows.
fn only(came: &TraceData, rows: &Range<usize>, later: i64) -> TraceData {
    let mut came = came.clone();
    let all = came.rows();
    let at = |row: usize| row.saturating_add_signed(later as isize).min(all);
    let (first, end) = (at(rows.start), at(rows.end));
    for column in &mut came.columns {
        column[..first].fill(f64::NAN);
        column[end..].fill(f64::NAN);
    }
    came
}

#[cfg(test)]
mod tests {
    use super::super::tests::trace;
    use super::*;

    #[test]
    fn the_first_difference_follows_the_shift_and_incomparable_traces_give_a_reason() {
        let other = |columns: &[(&str, &[f64])]| Overlay {
            against: OverlaySource::Twin,
            view: TraceView::new(trace(columns)),
            rule: Rule::exact(),
            has: None,
        };
        let came = TraceView::new(trace(&[("speed", &[0.0, 0.0, 9.0, 9.0])]));
        let expected = other(&[("speed", &[0.0, 9.0, 9.0, 9.0])]);
        let parting = expected.parting(&came, 0);
        assert_eq!(parting.stretches["speed"].first(), Some(&(1..2)));
        assert_eq!(parting.first.expect("deviates").signal, "speed");
        assert!(expected.parting(&came, 1).stretches.is_empty());
        assert!(expected.parting(&came, 50).trouble.is_some());
    }
}
