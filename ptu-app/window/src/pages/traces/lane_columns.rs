//! Where the parts of the picture are, from left to right: names, lanes, and values under the cursors.

use eframe::egui::{Rect, Ui};

/// Room for names left of the lanes, and for the values beside their axes.
const NAMES: f32 = 150.0;
pub const TICKS: f32 = 52.0;
/// Room for a value under a cursor.
const VALUE: f32 = 92.0;
/// Narrowest lanes.
const NARROWEST: f32 = 50.0;

/// Where the parts of the picture are, from left to right.
#[derive(Clone, Copy)]
pub struct LaneColumns {
    /// Left edge of the names.
    pub names: f32,
    /// Left edge of the lanes.
    pub left: f32,
    /// Right edge of the lanes.
    pub right: f32,
    /// Right edge of the values.
    pub end: f32,
}

impl LaneColumns {
    /// Where the values of a column are, at the height of `beside`.
    pub fn value(&self, column: usize, beside: Rect) -> Rect {
        let right = self.right + (column + 1) as f32 * VALUE;
        Rect::from_x_y_ranges(right - VALUE + 6.0..=right - 2.0, beside.y_range())
    }

    pub fn of(ui: &Ui, all: Rect, values: usize) -> Self {
        let scroll = &ui.spacing().scroll;
        let end = all.right() - scroll.bar_width - scroll.bar_outer_margin - 2.0;
        let left = all.left() + NAMES + TICKS;
        Self {
            names: all.left(),
            left,
            right: (end - values as f32 * VALUE).max(left + NARROWEST),
            end,
        }
    }
}
