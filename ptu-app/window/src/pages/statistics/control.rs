//! Control chart: a measured value over time with control limits; each value of one unit, or all units day by day.

use eframe::egui::{
    Align2, FontId, Rect, RichText, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2,
};
use egui_material_icons::icons::ICON_WARNING;
use fault_db::{TrendQuery, TrendStep};

use super::counted::{Asked, is_known};
use crate::parts::lane::{TEXT, y_at, y_axis};
use crate::parts::look_back::since_us;
use crate::parts::{caption, chip, ground, pick};
use crate::request::FollowingResponse;
use crate::settings::Measured;
use crate::{DataPaths, PageContext, Palette, Sizes};
use ptu_report::limits::short;
use ptu_report::naming::{DOT, measurement};
use ptu_report::trend::Trend;
use ptu_report::words::{Words, fill};
use ptu_runs::clock;
use ptu_runs::failure::Failure;

/// Height of the chart, and width for the values at its axis, points.
const HIGH: f32 = 170.0;
const GUTTER: f32 = 56.0;
/// Width for the names of the lines, points.
const BESIDE: f32 = 130.0;
const DOT_RADIUS: f32 = 2.5;
/// Widths of the lists of measurements and of steps, points.
const NAMES: f32 = 160.0;
const STEPS: f32 = 240.0;

/// Measurements and steps to choose from, and the trend of the chosen measurement.
struct Known {
    names: Vec<String>,
    steps: Vec<TrendStep>,
    trend: Option<Trend>,
}

#[derive(Default)]
pub struct ControlChart {
    /// The measurement and step that a person chose.
    pub of: Measured,
    known: FollowingResponse<(Measured, Asked), Known>,
}

impl ControlChart {
    /// Reads again when the data or the choice have changed.
    pub fn keep_up(&mut self, asked: Asked, context: &PageContext<'_>) {
        let wanted = ((self.of.clone(), asked), true);
        self.known.keep_up(wanted, context, read);
    }

    pub fn show(&mut self, ui: &mut Ui, words: &Words) {
        let said = &words.statistics;
        ground(&Palette::of(ui)).show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.horizontal_wrapped(|ui| {
                ui.label(RichText::new(said.measured).size(Sizes::of(ui).lead));
                if let Some(known) = self.known.get().value() {
                    choose(ui, words, &mut self.of, known);
                }
            });
            let Some(known) = self.known.get().shown(ui, words) else {
                return;
            };
            match &known.trend {
                _ if known.names.is_empty() => drop(ui.label(said.nothing_measured)),
                Some(trend) => {
                    let warn = Palette::of(ui).warn;
                    for sign in signs(words, trend) {
                        chip(ui, (ICON_WARNING, &sign), warn);
                    }
                    caption(ui, &summary(words, trend));
                    chart(ui, words, trend);
                }
                None => drop(ui.label(said.not_measured)),
            }
        });
    }
}

fn read(paths: &DataPaths, (of, asked): (Measured, Asked)) -> Result<Known, Failure> {
    let mut known = Known {
        names: Vec::new(),
        steps: Vec::new(),
        trend: None,
    };
    if !paths.is_there() {
        return Ok(known);
    }
    let store = paths.read()?;
    if !is_known(&store, asked.unit.as_deref())? {
        return Ok(known);
    }
    known.names = store.measurement_names()?;
    let Some(measurement) = of.measurement.or_else(|| known.names.first().cloned()) else {
        return Ok(known);
    };
    let mut query = TrendQuery {
        measurement,
        unit: asked.unit.clone(),
        since_us: since_us(asked.days, clock::now_us()),
        ..TrendQuery::default()
    };
    known.steps = store.trend_steps(&query)?;
    if let Some((procedure, step)) = of.step {
        (query.procedure, query.step) = (Some(procedure), Some(step));
    }
    known.trend = Trend::read(&store, query)?;
    Ok(known)
}

/// Lists from which the measurement and its step are chosen.
fn choose(ui: &mut Ui, words: &Words, of: &mut Measured, known: &Known) {
    let said = &words.statistics;
    let mut name = of.measurement.clone();
    if name.is_none() {
        name = known.names.first().cloned();
    }
    let names = known.names.iter();
    let names = names.map(|name| (Some(name.clone()), measurement(name, words)));
    if pick(ui, (said.measured, NAMES), &mut name, names) {
        (of.measurement, of.step) = (name, None);
    }
    let steps = known.steps.iter().map(|step| {
        let name = [&*step.procedure, &*words.content(&step.step)].join(DOT);
        (Some((step.procedure.clone(), step.step.clone())), name)
    });
    let all = (None, said.all_steps.to_owned());
    let steps = std::iter::once(all).chain(steps);
    pick(ui, (words.common.step, STEPS), &mut of.step, steps);
}

/// Text: mean, control limits and capability.
fn summary(words: &Words, trend: &Trend) -> String {
    let said = &words.statistics;
    let Some(process) = &trend.process else {
        return said.not_measured.to_owned();
    };
    let unit = &trend.limits.unit;
    let mean = short(process.mean);
    let mut text = vec![fill(
        said.mean,
        &[("n", &process.n), ("mean", &mean), ("unit", unit)],
    )];
    text.extend(process.control.map(|(low, high)| {
        fill(
            said.control_limits,
            &[("low", &short(low)), ("high", &short(high)), ("unit", unit)],
        )
    }));
    if trend.limits_differ() {
        text.push(said.limits_differ.to_owned());
    }
    let capability = process.capability(trend.limits.low, trend.limits.high);
    text.extend(capability.map(|is| fill(said.cpk, &[("n", &format!("{:.2}", is.cpk))])));
    text.join(". ")
}

/// Texts: patterns that chance does not explain, and the day on which a limit is expected to be crossed.
fn signs(words: &Words, trend: &Trend) -> Vec<String> {
    let said = &words.statistics;
    let Some(process) = &trend.process else {
        return Vec::new();
    };
    let signs = process.signs.iter();
    let signs = signs.map(|sign| fill(said.sign(sign.kind), &[("n", &sign.times)]));
    let mut text: Vec<_> = signs.collect();
    let forecast = process.forecast(trend.limits.low, trend.limits.high);
    text.extend(forecast.map(|at| {
        let (limit, day) = (short(at.limit), clock::local_day(at.at_us));
        let unit = &trend.limits.unit;
        let said_of: [(&str, &dyn std::fmt::Display); 3] =
            [("limit", &limit), ("unit", unit), ("day", &day)];
        fill(said.forecast, &said_of)
    }));
    text
}

/// Draws the values as dots, those beyond the control limits marked; mean, control limits and limits as lines.
fn chart(ui: &mut Ui, words: &Words, trend: &Trend) {
    let samples = trend.course.samples();
    let size = vec2(ui.available_width(), HIGH);
    let (whole, response) = ui.allocate_exact_size(size, Sense::hover());
    let name = fill(words.statistics.chart_of, &[("n", &samples.len())]);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return;
    };
    let palette = Palette::of(ui);
    let mean = trend.process.as_ref().map(|process| process.mean);
    let control = trend.process.as_ref().and_then(|process| process.control);
    let said = &words.statistics;
    let lines = [
        (mean, said.mean_line, palette.quiet),
        (
            control.map(|(low, _)| low),
            said.control_line,
            palette.quiet,
        ),
        (
            control.map(|(_, high)| high),
            said.control_line,
            palette.quiet,
        ),
        (trend.limits.low, said.limit_line, palette.ink),
        (trend.limits.high, said.limit_line, palette.ink),
    ];
    let levels = lines.iter().filter_map(|(level, ..)| *level);
    let all = samples.iter().map(|sample| sample.value).chain(levels);
    let (least, most) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let room = ((most - least) / 10.0).max(f64::EPSILON * most.abs().max(1.0) * 10.0);
    let range = (least - room, most + room);
    let gutter = Rect::from_min_max(
        whole.min,
        pos2(whole.left() + GUTTER, whole.bottom() - 16.0),
    );
    let right = whole.right() - BESIDE;
    let plot = Rect::from_min_max(gutter.right_top(), pos2(right, gutter.bottom()));
    let painter = ui.painter().with_clip_rect(whole.intersect(ui.clip_rect()));
    y_axis(&painter, gutter, plot, range, &palette);
    let font = FontId::proportional(TEXT);
    let mut named: Vec<f32> = Vec::new();
    for (level, name, colour) in lines {
        let Some(level) = level else { continue };
        let y = y_at(plot, range, level);
        let (from, to) = (pos2(plot.left(), y), pos2(plot.right(), y));
        let stroke = Stroke::new(1.0, colour);
        match name == said.control_line {
            true => painter.extend(Shape::dashed_line(&[from, to], stroke, 4.0, 4.0)),
            false => drop(painter.line_segment([from, to], stroke)),
        }
        // A name too close to an earlier one is left out, or the two would overlap.
        if named.iter().all(|other| (other - y).abs() > TEXT) {
            let text = fill(name, &[("n", &short(level))]);
            let at = to + vec2(8.0, 0.0);
            painter.text(at, Align2::LEFT_CENTER, text, font.clone(), colour);
            named.push(y);
        }
    }
    let long_us = (last.at_us - first.at_us).max(1) as f64;
    for sample in &samples {
        let share = (sample.at_us - first.at_us) as f64 / long_us;
        let inner = plot.shrink2(vec2(2.0 * DOT_RADIUS, 0.0));
        let x = inner.left() + share as f32 * inner.width();
        let is_beyond = control
            .is_some_and(|(low, high)| sample.n == 1 && !(low..=high).contains(&sample.value));
        let (radius, colour) = match is_beyond {
            true => (1.6 * DOT_RADIUS, palette.warn),
            false => (DOT_RADIUS, palette.accent),
        };
        let at = pos2(x, y_at(plot, range, sample.value));
        painter.circle_filled(at, radius, colour);
    }
    let day = trend.course.day_name();
    for (at, align, at_us) in [
        (plot.left(), Align2::LEFT_BOTTOM, first.at_us),
        (plot.right(), Align2::RIGHT_BOTTOM, last.at_us),
    ] {
        let at = pos2(at, whole.bottom());
        painter.text(at, align, day(at_us), font.clone(), palette.quiet);
    }
}
