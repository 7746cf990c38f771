//! The charts: occurrences over time, by unit, by code.

use eframe::egui::{Align2, Rect, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};
use fault_db::DailyCount;

use super::charts::{CountsOverTime, DAY_US, by_name, over_time};
use crate::gui::Palette;
use crate::gui::parts::lane::cut_text;
use ptu_bench::clock;
use ptu_report::naming;
use ptu_report::words::{Words, fill};

const HEIGHT: f32 = 86.0;
/// Room a name takes in a chart by name.
const NAME: f32 = 120.0;

/// The three charts side by side.
pub fn charts(ui: &mut Ui, words: &Words, counts: &[&DailyCount]) {
    let Some(chart) = over_time(counts) else {
        return;
    };
    let width = (ui.available_width() - 2.0 * ui.spacing().item_spacing.x) / 3.0;
    ui.horizontal(|ui| {
        in_time(ui, words, &chart, width);
        let units = by_name(counts, |count| count.unit_serial.as_str());
        named(ui, words, words.faults.by_unit, &units, width);
        let codes = by_name(counts, |count| {
            naming::event(count.code, &count.code_name, words)
        });
        named(ui, words, words.faults.by_code, &codes, width);
    });
}

fn in_time(ui: &mut Ui, words: &Words, chart: &CountsOverTime, width: f32) {
    let title = fill(words.faults.over_time, &[("days", &chart.days)]);
    let Some(rect) = frame(ui, &title, width, chart.bars.iter().sum()) else {
        return;
    };
    let palette = Palette::of(ui);
    let most = chart.bars.iter().max().copied().unwrap_or(1).max(1) as f32;
    let painter = ui.painter();
    let small = TextStyle::Small.resolve(ui.style());
    let plot = Rect::from_min_max(rect.min, rect.max - vec2(0.0, 14.0));
    let step = plot.width() / chart.bars.len() as f32;
    for (place, bar) in (0..).zip(&chart.bars) {
        let left = plot.left() + step * place as f32;
        let height = plot.height() * *bar as f32 / most;
        let right = left + (step - 1.0).clamp(1.0, 40.0);
        let bar = Rect::from_min_max(
            pos2(left, plot.bottom() - height),
            pos2(right, plot.bottom()),
        );
        painter.rect_filled(bar, 0.0, palette.accent);
    }
    // Noon, since a day of summer time begins an hour before one of winter.
    let from = clock::local_day(chart.from_us + DAY_US / 2);
    painter.text(
        rect.left_bottom(),
        Align2::LEFT_BOTTOM,
        from,
        small.clone(),
        palette.quiet,
    );
    let most = format!("{most:.0}");
    painter.text(
        plot.right_top(),
        Align2::RIGHT_TOP,
        most,
        small,
        palette.quiet,
    );
}

fn named(
    ui: &mut Ui,
    words: &Words,
    title: &str,
    (names, others): &(Vec<(impl AsRef<str>, u64)>, u64),
    width: f32,
) {
    let sum = names.iter().map(|(_, count)| count).sum::<u64>() + others;
    let Some(rect) = frame(ui, title, width, sum) else {
        return;
    };
    let palette = Palette::of(ui);
    let small = TextStyle::Small.resolve(ui.style());
    let most = names
        .iter()
        .map(|(_, count)| *count)
        .max()
        .unwrap_or(1)
        .max(1) as f32;
    let rest = (*others > 0).then_some((words.faults.others, *others));
    let names = names.iter().map(|(name, count)| (name.as_ref(), *count));
    let rows = names.chain(rest);
    let height = rect.height() / 7.0;
    let painter = ui.painter().with_clip_rect(rect);
    for (place, (name, count)) in (0..).zip(rows) {
        let middle = rect.top() + height * (place as f32 + 0.5);
        let left = rect.left() + NAME.min(rect.width() / 2.0);
        let ink = ui.visuals().text_color();
        let row = Rect::from_x_y_ranges(rect.left()..=left - 4.0, middle..=middle);
        cut_text(&painter, row, name.to_owned(), small.clone(), ink);
        let room = (rect.right() - left - 26.0).max(1.0);
        let size = vec2(room * (count as f32 / most).min(1.0), height - 3.0);
        let bar = Rect::from_min_size(pos2(left, middle - size.y / 2.0), size);
        painter.rect_filled(bar, 0.0, palette.accent);
        let end = pos2(bar.right() + 3.0, middle);
        painter.text(
            end,
            Align2::LEFT_CENTER,
            count.to_string(),
            small.clone(),
            palette.quiet,
        );
    }
}

/// Title and room of a chart.
fn frame(ui: &mut Ui, title: &str, width: f32, sum: u64) -> Option<Rect> {
    let (rect, response) = ui.allocate_exact_size(vec2(width, HEIGHT + 18.0), Sense::hover());
    let name = format!("{title}: {sum}");
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    if !ui.is_rect_visible(rect) {
        return None;
    }
    let small = TextStyle::Small.resolve(ui.style());
    let quiet = Palette::of(ui).quiet;
    ui.painter()
        .text(rect.min, Align2::LEFT_TOP, title, small, quiet);
    Some(Rect::from_min_max(rect.min + vec2(0.0, 18.0), rect.max))
}
