//! Whether a page shows one unit only.

use eframe::egui::Ui;

use super::{names, pick};
use crate::PageContext;

/// Width of the box, points.
const BOX: f32 = 90.0;

/// The unit connected last, and the one of which alone something is shown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnitFilter {
    connected: Option<String>,
    taken: Option<String>,
}

impl UnitFilter {
    /// Follows the connected unit, and offers it, these and all together; true when it takes others than before.
    pub fn show(&mut self, ui: &mut Ui, context: &PageContext<'_>, known: &[String]) -> bool {
        let before = self.taken.clone();
        let connected = context.units.chosen().serial();
        if connected.is_some() && connected != self.connected {
            self.connected.clone_from(&connected);
            self.taken = connected;
        }
        let own = [&self.connected, &self.taken].into_iter().flatten();
        let units = names(known.iter().chain(own).map(String::as_str));
        if !units.is_empty() {
            let words = context.words;
            let all = (None, words.statistics.all_units.to_owned());
            let each = units.into_iter().map(|unit| (Some(unit.clone()), unit));
            let all = std::iter::once(all).chain(each);
            pick(ui, (words.common.unit, BOX), &mut self.taken, all);
        }
        before != self.taken
    }

    /// Takes this one alone; none = all.
    pub fn take(&mut self, unit: Option<String>) {
        self.taken = unit;
    }

    /// The unit that is taken; none = all.
    pub fn taken(&self) -> Option<&str> {
        self.taken.as_deref()
    }

    pub fn takes(&self, unit: &str) -> bool {
        self.taken().is_none_or(|taken| taken == unit)
    }
}
