//! A page of two halves: beside each other, or one above the other in a narrow window. The divider can be dragged.

use eframe::egui::{Panel, Rangef, Ui};

/// A window narrower than this has the halves one above the other, points.
const BESIDE: f32 = 1100.0;
/// Least width and height of the first half, and what is left of them to the second.
const LEAST: [f32; 2] = [200.0, 90.0];
const LEFT: [f32; 2] = [440.0, 150.0];

/// The first half of a page; the second is the page's central panel.
pub struct FirstHalf {
    pub name: &'static str,
    /// Its width until the divider is dragged, points.
    pub width: f32,
    /// Its share of a narrow window's height until the divider is dragged.
    pub share: f32,
}

impl FirstHalf {
    /// The window is so narrow that the halves are one above the other.
    pub fn is_narrow(ui: &Ui) -> bool {
        ui.ctx().content_rect().width() < BESIDE
    }

    pub fn show<R>(&self, ui: &mut Ui, content: impl FnOnce(&mut Ui) -> R) -> R {
        let beside = !Self::is_narrow(ui);
        let (panel, room, axis) = if beside {
            (Panel::left(self.name), ui.available_width(), 0)
        } else {
            let above = Panel::top(format!("{} above", self.name));
            (above.resizable(true), ui.available_height(), 1)
        };
        let most = (room - LEFT[axis]).max(LEAST[axis]);
        let size = if beside {
            self.width
        } else {
            room * self.share
        };
        let range = Rangef::new(LEAST[axis], most);
        let panel = panel.default_size(range.clamp(size)).size_range(range);
        let half = panel.show(ui, |ui| {
            // It stays as large as it was made, whatever is in it.
            ui.set_min_size(ui.available_size());
            content(ui)
        });
        half.inner
    }
}
