//! A measured value over time with its control limits: of one unit value by value, of all units day by day.

use eframe::egui::{
    Align2, ComboBox, FontId, Rect, RichText, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2,
};
use fault_db::{TrendQuery, TrendStep};

use super::counted::{Asked, is_known};
use crate::parts::lane::{TEXT, y_at, y_axis};
use crate::parts::look_back::since_us;
use crate::parts::named_combo;
use crate::request::{CachedResponse, Request};
use crate::{DataPaths, PageContext, Palette};
use ptu_report::limits::short;
use ptu_report::naming::{DOT, measurement};
use ptu_report::trend::Trend;
use ptu_report::words::{Words, fill};
use ptu_runs::clock;
use ptu_runs::failure::Failure;

/// Height of the chart, and room for the values beside it, points.
const HIGH: f32 = 170.0;
const GUTTER: f32 = 56.0;
const DOT_RADIUS: f32 = 2.5;
/// Room of a list of names, points.
const NAMES: f32 = 170.0;

/// What is measured: a measurement, and of it one step or all.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Measured {
    measurement: Option<String>,
    /// Procedure and step.
    step: Option<(String, String)>,
}

/// What can be chosen, and the trend of what was.
struct Known {
    names: Vec<String>,
    steps: Vec<TrendStep>,
    trend: Option<Trend>,
}

#[derive(Default)]
pub struct ControlChart {
    of: Measured,
    known: CachedResponse<Known>,
    asked: Option<(Measured, Asked, (usize, u64))>,
}

impl ControlChart {
    /// The measurement and the step that were chosen.
    pub fn chosen(&self) -> (Option<String>, Option<(String, String)>) {
        (self.of.measurement.clone(), self.of.step.clone())
    }

    /// Chooses a measurement and a step.
    pub fn choose(&mut self, measurement: Option<String>, step: Option<(String, String)>) {
        self.of = Measured { measurement, step };
    }

    /// Asks again when the data or what is asked for are others.
    pub fn keep_up(&mut self, asked: Asked, context: &PageContext<'_>) {
        let wanted = (self.of.clone(), asked.clone(), context.data_version());
        if self.asked.as_ref() != Some(&wanted) {
            self.asked = Some(wanted);
            let of = self.of.clone();
            let pending = context.queries.run(move |paths| read(paths, of, &asked));
            self.known.request(pending);
        }
        self.known.poll();
    }

    pub fn show(&mut self, ui: &mut Ui, words: &Words) {
        let said = &words.statistics;
        ui.label(RichText::new(said.control).strong());
        match self.known.get() {
            Request::Ready(known) if known.names.is_empty() => {
                ui.label(said.nothing_measured);
            }
            Request::Ready(known) => {
                ui.horizontal_wrapped(|ui| {
                    choose(ui, words, &mut self.of, known);
                });
                match &known.trend {
                    Some(trend) => {
                        ui.label(summary(words, trend));
                        chart(ui, words, trend);
                    }
                    None => drop(ui.label(said.not_measured)),
                }
            }
            Request::Failed(why) => drop(ui.label(&*words.trouble(why))),
            Request::Idle | Request::Pending(_) => drop(ui.label(words.common.loading)),
        }
    }
}

fn read(paths: &DataPaths, of: Measured, asked: &Asked) -> Result<Known, Failure> {
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

/// The measurement, and the step that measures it.
fn choose(ui: &mut Ui, words: &Words, of: &mut Measured, known: &Known) {
    let said = &words.statistics;
    let shown = of.measurement.as_ref().or(known.names.first());
    let shown = shown.map_or_else(String::new, |name| measurement(name, words));
    ui.label(said.measured);
    let combo = ComboBox::from_id_salt("measurement")
        .selected_text(&shown)
        .width(NAMES)
        .truncate();
    let combo = combo.show_ui(ui, |ui| {
        for name in &known.names {
            let on = of.measurement.as_ref() == Some(name);
            if ui.selectable_label(on, measurement(name, words)).clicked() {
                (of.measurement, of.step) = (Some(name.clone()), None);
            }
        }
    });
    named_combo(&combo.response, said.measured, &shown);
    let name = |procedure: &str, step: &str| [procedure, &words.content(step)].join(DOT);
    let shown = of.step.as_ref();
    let shown = shown.map_or_else(
        || said.all_steps.to_owned(),
        |(procedure, step)| name(procedure, step),
    );
    ui.label(words.common.step);
    let combo = ComboBox::from_id_salt("measured step")
        .selected_text(&shown)
        .width(NAMES)
        .truncate();
    let combo = combo.show_ui(ui, |ui| {
        ui.selectable_value(&mut of.step, None, said.all_steps);
        for step in &known.steps {
            let one = Some((step.procedure.clone(), step.step.clone()));
            ui.selectable_value(&mut of.step, one, name(&step.procedure, &step.step));
        }
    });
    named_combo(&combo.response, words.common.step, &shown);
}

/// Mean and control limits, capability, what chance does not explain, and when a limit will be crossed.
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
    let (low, high) = (trend.limits.low, trend.limits.high);
    if trend.limits_differ() {
        text.push(said.limits_differ.to_owned());
    }
    let capability = process.capability(low, high);
    text.extend(capability.map(|is| fill(said.cpk, &[("n", &format!("{:.2}", is.cpk))])));
    text.extend(process.signs.iter().map(|sign| {
        let what = said.sign(sign.kind);
        fill(what, &[("n", &sign.times)])
    }));
    let forecast = process.forecast(low, high);
    text.extend(forecast.map(|at| {
        let day = clock::local_day(at.at_us);
        fill(
            said.forecast,
            &[("limit", &short(at.limit)), ("unit", unit), ("day", &day)],
        )
    }));
    text.join(". ")
}

/// The values as dots, those beyond control marked; mean, control limits and limits as lines.
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
    let lines = [
        (mean, palette.quiet),
        (control.map(|(low, _)| low), palette.warn),
        (control.map(|(_, high)| high), palette.warn),
        (trend.limits.low, palette.bad),
        (trend.limits.high, palette.bad),
    ];
    let levels = lines.iter().filter_map(|(level, _)| *level);
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
    let plot = Rect::from_min_max(gutter.right_top(), pos2(whole.right(), gutter.bottom()));
    let painter = ui.painter().with_clip_rect(whole.intersect(ui.clip_rect()));
    y_axis(&painter, gutter, plot, range, &palette);
    for (level, colour) in lines {
        if let Some(level) = level {
            let y = y_at(plot, range, level);
            painter.hline(plot.x_range(), y, Stroke::new(1.0, colour));
        }
    }
    let long_us = (last.at_us - first.at_us).max(1) as f64;
    for sample in &samples {
        let share = (sample.at_us - first.at_us) as f64 / long_us;
        let inner = plot.shrink2(vec2(2.0 * DOT_RADIUS, 0.0));
        let x = inner.left() + share as f32 * inner.width();
        let is_beyond = control
            .is_some_and(|(low, high)| sample.n == 1 && !(low..=high).contains(&sample.value));
        let colour = if is_beyond {
            palette.bad
        } else {
            palette.accent
        };
        painter.circle_filled(pos2(x, y_at(plot, range, sample.value)), DOT_RADIUS, colour);
    }
    let day = trend.course.day_name();
    let font = FontId::proportional(TEXT);
    for (at, align, at_us) in [
        (plot.left(), Align2::LEFT_BOTTOM, first.at_us),
        (plot.right(), Align2::RIGHT_BOTTOM, last.at_us),
    ] {
        let at = pos2(at, whole.bottom());
        painter.text(at, align, day(at_us), font.clone(), palette.quiet);
    }
}
