//! Unsafe modes that no check so far would have shown: a unit is not called healthy while there are any.

use super::model::{Hypothesis, Model};

/// An unsafe mode at one level.
#[derive(Clone, Debug)]
struct UnsafeMode {
    /// Share of runs that did not pass each check that acts otherwise than on a healthy unit, by its index.
    shown_in: Vec<(usize, f64)>,
    /// Probability that the checks made so far would all have passed with it.
    hidden: f64,
}

/// All unsafe modes of a model.
#[derive(Clone, Debug)]
pub struct Hidden {
    modes: Vec<UnsafeMode>,
    /// A mode that hides with this probability at most has been looked for.
    enough: f64,
}

impl Hidden {
    /// Before any check.
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

    /// The check with this index was made.
    pub fn see(&mut self, place: usize) {
        for mode in &mut self.modes {
            mode.hidden *= 1.0 - mode.shows(place);
        }
    }

    /// By how much the check with this index makes the modes that still hide likelier to be shown, over all of them; `None` if
    /// that is not worth a check.
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
