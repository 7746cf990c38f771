//! Choice of one unit, or of all, on a page.

use eframe::egui::Ui;

use super::{names, pick};
use crate::PageContext;

/// Width of the box, points.
const BOX: f32 = 90.0;

/// The unit connected last, and the chosen unit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnitFilter {
    connected: Option<String>,
    /// The unit that was chosen; none = all.
    pub taken: Option<String>,
}

impl UnitFilter {
    /// Follows the connected unit, and offers that unit, the known units and all together; true when the choice
    /// has changed.
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

    /// Chooses a unit; none = all.
    pub fn choose(&mut self, unit: Option<String>) {
        self.taken = unit;
    }

    pub fn takes(&self, unit: &str) -> bool {
        self.taken.as_deref().is_none_or(|taken| taken == unit)
    }
}
