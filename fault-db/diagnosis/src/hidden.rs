//! Unsafe modes that the checks so far might not have shown: while there are any, a unit is not called healthy.

use super::model::{Hypothesis, Model};

/// An unsafe mode at one level.
#[derive(Clone, Debug)]
struct UnsafeMode {
    /// For checks that act otherwise than on a healthy unit, by index: share of the mode's runs in which the check did
    /// not pass.
    shown_in: Vec<(usize, f64)>,
    /// Probability that all checks made so far would have passed with this mode.
    hidden: f64,
}

/// All unsafe modes of a model.
#[derive(Clone, Debug)]
pub struct Hidden {
    modes: Vec<UnsafeMode>,
    /// A mode has been looked for once `hidden` is at most this.
    enough: f64,
}

impl Hidden {
    /// The state before any check.
    pub fn new(model: &Model<'_>) -> Self {
        let unsafe_modes = model.effects().iter().filter_map(|effect| {
            let Hypothesis::Mode { mode, column } = *effect else {
                return None;
            };
            let mode = &model.dictionary.modes[mode];
            let cells = mode.columns[column].cells.iter();
            let shown = cells.map(|(place, cell)| (*place, cell.not_passed()));
            mode.name.unsafe_.then(|| UnsafeMode {
                shown_in: shown.filter(|(_, share)| *share > 0.0).collect(),
                hidden: 1.0,
            })
        });
        Self {
            modes: unsafe_modes.collect(),
            enough: model.settings.hidden_fault,
        }
    }

    /// Notes that the check with index `place` was made.
    pub fn see(&mut self, place: usize) {
        for mode in &mut self.modes {
            mode.hidden *= 1.0 - mode.shows(place);
        }
    }

    /// Sum, over the modes that still hide, of the probability that the check with index `place` shows them; `None` if
    /// it is too small to be worth the check.
    pub fn worth(&self, place: usize) -> Option<f64> {
        let hiding = self.modes.iter().filter(|mode| mode.hidden > self.enough);
        let worth: f64 = hiding.map(|mode| mode.hidden * mode.shows(place)).sum();
        (worth > self.enough).then_some(worth)
    }
}

impl UnsafeMode {
    fn shows(&self, place: usize) -> f64 {
        let at = self
            .shown_in
            .binary_search_by_key(&place, |(place, _)| *place);
        at.map_or(0.0, |at| self.shown_in[at].1)
    }
}
