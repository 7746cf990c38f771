//! Another trace, or that of a good unit, behind a trace, and where the two first differ.

use std::collections::BTreeMap;
use std::ops::Range;

use fault_db::{Id, Store};

use super::TraceView;
use ptu_bench::data::ScriptsDirectory;
use ptu_bench::failure::Failure;
use ptu_bench::replay::{Comparison, Deviation, Original, Rule, compare, good_twin, rule_between};

/// What a trace is compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OverlaySource {
    /// The same stimuli on a sound unit.
    Twin,
    /// Another trace.
    Trace(Id),
}

/// Which trace is shown behind another.
#[derive(Debug)]
pub struct Overlay {
    /// What it is.
    pub against: OverlaySource,
    /// Its samples.
    pub view: TraceView,
    rule: Rule,
}

/// The first difference between a trace and the trace behind, which may be shifted by some rows.
#[derive(Debug)]
pub struct FirstDifference {
    /// Rows by which the other one is laid later.
    pub shift_rows: i64,
    /// Rows of the trace that differ, by signal.
    pub stretches: BTreeMap<String, Vec<Range<usize>>>,
    /// The first signal that differs.
    pub first: Option<Deviation>,
    /// Why it could not be told.
    pub trouble: Option<String>,
}

impl Overlay {
    /// Reads or makes what the trace `id` is to be laid against.
    ///
    /// # Errors
    /// The other trace is gone, this one has no recording, or what its bench was made of is gone.
    pub fn get(
        store: &Store,
        scripts: &ScriptsDirectory,
        id: Id,
        against: OverlaySource,
    ) -> Result<Self, Failure> {
        let (data, rule) = match against {
            OverlaySource::Twin => good_twin(&Original::read(store, id)?, scripts)?,
            OverlaySource::Trace(other) => (store.trace(other)?, rule_between(store, id, other)?),
        };
        Ok(Self {
            against,
            view: TraceView::new(data),
            rule,
        })
    }

    /// The first difference of `came` from it.
    pub fn parting(&self, came: &TraceView, shift_rows: i64) -> FirstDifference {
        let rule = self.rule.shifted(shift_rows);
        let (found, trouble) = match compare(came.data(), self.view.data(), &rule, &[]) {
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
