//! Whether a page shows the connected unit only.

use eframe::egui::Ui;

use crate::PageContext;
use ptu_report::words::fill;

/// The unit connected last, and whether only what belongs to it is shown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnitFilter {
    unit: Option<String>,
    all: bool,
}

impl UnitFilter {
    /// Follows the connected unit, and offers all of them; true when it takes others than before.
    pub fn show(&mut self, ui: &mut Ui, context: &PageContext<'_>) -> bool {
        let before = self.taken().map(str::to_owned);
        let connected = context.units.chosen().serial();
        if connected.is_some() && connected != self.unit {
            self.unit = connected;
            self.all = false;
        }
        if let Some(unit) = &self.unit {
            let mut only = !self.all;
            ui.checkbox(
                &mut only,
                fill(context.words.common.only_unit, &[("unit", unit)]),
            );
            self.all = !only;
        }
        before.as_deref() != self.taken()
    }

    /// The unit that is taken; none = all.
    pub fn taken(&self) -> Option<&str> {
        self.unit.as_deref().filter(|_| !self.all)
    }

    pub fn takes(&self, unit: &str) -> bool {
        self.taken().is_none_or(|taken| taken == unit)
    }
}
