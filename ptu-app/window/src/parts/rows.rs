//! Rows that scroll together with the widgets above them.

use std::ops::Range;

use eframe::egui::Ui;

/// Rows of one height in a scrolling area; only rows in view are drawn.
pub fn rows(ui: &mut Ui, height: f32, count: usize, show: impl FnOnce(&mut Ui, Range<usize>)) {
    let pitch = height + ui.spacing().item_spacing.y;
    let (top, seen) = (ui.cursor().top(), ui.clip_rect());
    let row = |y: f32| ((y - top) / pitch).clamp(0.0, count as f32);
    let first = row(seen.top()).floor() as usize;
    let end = row(seen.bottom()).ceil() as usize;
    ui.add_space(first as f32 * pitch);
    show(ui, first..end);
    ui.add_space((count - end) as f32 * pitch);
}
