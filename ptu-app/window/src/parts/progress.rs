//! Progress of a run in one bar: passed, not passed, still to come.

use eframe::egui::{Rect, Role, Sense, Ui, Vec2, WidgetInfo, pos2};

use crate::Palette;
use ptu_report::words::{Words, fill};
use ptu_runs::bench_worker::Progress;

/// Text: number of steps run, of all.
pub fn running_text(run: &Progress, words: &Words) -> String {
    let counts = run.counts();
    let of = [("n", &counts.run() as _), ("all", &counts.planned as _)];
    fill(words.frame.running, &of)
}

/// Text: number of steps run, of all, and of steps that did not pass.
pub fn progress_text(run: &Progress, words: &Words) -> String {
    let counts = run.counts();
    let of = [
        ("done", &counts.run() as _),
        ("all", &counts.planned as _),
        ("bad", &counts.not_passed() as _),
    ];
    fill(words.procedures.progress, &of)
}

pub fn progress(ui: &mut Ui, size: Vec2, run: &Progress, words: &Words) {
    let palette = Palette::of(ui);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let counts = run.counts();
    let name = running_text(run, words);
    response.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &name));
    let done = match run.is_running() {
        true => palette.accent,
        false => palette.edge,
    };
    // Repetitions count for the length of the bar, but not as steps.
    let bad = f64::from(counts.not_passed()) / f64::from(counts.run().max(1));
    let end = rect.left() + rect.width() * run.share();
    let bad = end - rect.width() * run.share() * bad as f32;
    let part =
        |from: f32, to: f32| Rect::from_min_max(pos2(from, rect.top()), pos2(to, rect.bottom()));
    let painter = ui.painter();
    painter.rect_filled(rect, 2.0, palette.grid);
    painter.rect_filled(part(rect.left(), bad), 2.0, done);
    painter.rect_filled(part(bad, end), 2.0, palette.bad);
}
