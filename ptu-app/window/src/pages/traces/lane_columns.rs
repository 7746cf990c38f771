//! Horizontal positions of the columns of a trace view: names, lanes, and values at the cursors.

use eframe::egui::{Rect, Ui};

/// Widths left of the lanes: names, and values beside the axes, points.
const NAMES: f32 = 150.0;
pub const TICKS: f32 = 52.0;
/// Width of a column of values, points.
const VALUE: f32 = 92.0;
/// Least width of the lanes, points.
const NARROWEST: f32 = 50.0;

/// Horizontal positions of the columns, points.
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
    /// Area of a value in this column of values, at the height of `beside`.
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
