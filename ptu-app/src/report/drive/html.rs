//! Runs as one HTML page with nothing outside it: figures, conditions, plots as the papers have
//! them, and how to repeat the run.

use btu_rig::drive::Row;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::figures::{FIGURES, centimetres, conditions, ending, title};
use super::plot::{Place, Plot, Series, Style};
use super::{Results, html_many};
use crate::clock;
use crate::drive::{Case, Driven};

/// Way before the stop point that is shown larger, m.
const LAST_M: f64 = 12.0;
/// Share of an axis shown beyond the end of the run, so that the stop can be seen.
const BEYOND: f64 = 0.01;
/// Way past the stop point, m.
const PAST_M: f64 = 1.0;

/// The page.
pub fn html(results: &Results) -> String {
    let (heading, body) = match results {
        Results::Single(runs) => (
            "Station-to-station run",
            html! { @for group in groups(runs) { (section(group)) } },
        ),
        Results::Many(many) => (
            "Monte Carlo of station-to-station runs",
            html! { @for one in many { (html_many::section(one)) } },
        ),
    };
    let command = std::env::args()
        .skip(1)
        .map(|argument| quoted(&argument))
        .collect::<Vec<_>>();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (heading) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (heading) }
                (body)
                footer {
                    p { "Repeat with " code { "ptu " (command.join(" ")) } }
                    p { "ptu " (env!("CARGO_PKG_VERSION")) ", " (clock::local(clock::now_us())) }
                }
            }
        }
    };
    page.into_string()
}

/// Runs of the same section together: its controllers side by side.
fn groups(runs: &[Driven]) -> impl Iterator<Item = &[Driven]> {
    runs.chunk_by(|a, b| a.case.plan.section.section == b.case.plan.section.section)
}

fn section(runs: &[Driven]) -> Markup {
    let Some(first) = runs.first() else {
        return html! {};
    };
    let alone = runs.len() == 1;
    html! {
        section {
            h2 { (if alone { title(&first.case) } else {
                format!("{} section {}", first.case.bench.line.content.name, first.case.plan.section.section)
            }) }
            @for run in runs {
                p.verdict.good[run.aligned()].bad[!run.aligned()] {
                    @if !alone { b { (run.case.controller.name()) ": " } }
                    (ending(run))
                }
            }
            div.tables { (figures(runs)) (facts(&first.case)) }
            @for plot in plots(runs) { (plot.svg()) }
            @for run in runs { (events(run, alone)) }
        }
    }
}

fn figures(runs: &[Driven]) -> Markup {
    let of = |run: &Driven, shown: &dyn Fn(&btu_rig::drive::Metrics) -> String| {
        run.outcome.metrics.as_ref().map_or("–".into(), shown)
    };
    html! {
        table {
            @if runs.len() > 1 {
                tr { th {} @for run in runs { th.number { (run.case.controller.name()) } } th {} }
            }
            tr {
                th { "Stop error" }
                @for run in runs {
                    td.number { (run.outcome.stop_error_m.map_or("–".into(), |e| format!("{:+.1}", e * 100.0))) }
                }
                td { "cm" }
            }
            @for figure in &FIGURES {
                tr {
                    th { (figure.name) }
                    @for run in runs { td.number { (of(run, &|m| figure.shown(m))) } }
                    td { (figure.unit) }
                }
            }
        }
    }
}

/// What was run, on what, under which conditions.
pub fn facts(case: &Case) -> Markup {
    let bench = &case.bench;
    let settings = bench
        .settings
        .iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>();
    html! {
        table {
            @for (name, value) in conditions(case) { tr { th { (name) } td { (value) } } }
            tr { th { "Unit configuration" } td { (bench.config.content.name) ", " code { (format!("{:08x}", bench.config.crc)) } } }
            @if !settings.is_empty() {
                tr { th { "Keys changed" } td { @for setting in settings { code { (setting) } br; } } }
            }
            tr { th { "Track database" } td { (bench.line.content.name) ", " code { (format!("{:08x}", bench.line.crc)) } } }
            tr { th { "Length to the stop point" } td { (format!("{:.2} m", case.plan.section.stop_m - case.plan.section.start_m)) } }
            tr { th { "Seed" } td { (case.seed) } }
        }
    }
}

fn events(run: &Driven, alone: bool) -> Markup {
    html! {
        details open[alone] {
            summary { "Events" @if !alone { ", " (run.case.controller.name()) } }
            table {
                tr { th.number { "Time s" } th.number { "Place m" } th { "Event" } }
                @for landmark in &run.outcome.landmarks {
                    tr {
                        td.number { (format!("{:.2}", landmark.t_s)) }
                        td.number { (format!("{:.2}", landmark.x_m)) }
                        td { (landmark.what) }
                    }
                }
            }
        }
    }
}

/// What a curve shows of a row.
type Of = fn(&Row) -> f64;

const TIME: Of = |row| row.t_s;
const PLACE: Of = |row| row.x_m;

fn plots(runs: &[Driven]) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (along, x) in [("time", TIME), ("distance", PLACE)] {
        let label = if along == "time" {
            "Time since the train began to move, s"
        } else {
            "Position in the section, m"
        };
        let mut add = |title: &str, y_label: &str, series: Vec<Series>, y_reach| {
            plots.push(Plot {
                title: format!("{title} over {along}"),
                x_label: label.into(),
                y_label: y_label.into(),
                x_range: Some(range(runs, x)),
                y_reach,
                series,
                places: places(runs, along == "time"),
            });
        };
        add("Speed", "km/h", speed(runs, x), Some((0.0, 1.0)));
        if along == "time" {
            add("Position", "m", position(runs), Some((0.0, 1.0)));
        }
        add(
            "Effort",
            "−1024 .. 1023",
            each(runs, x, |r| r.effort, "effort"),
            Some((-1024.0, 1023.0)),
        );
        add(
            "Acceleration",
            "km/h/s",
            each(runs, x, |r| r.accel_mps2 * 3.6, "acceleration"),
            Some((-3.0, 3.0)),
        );
        add(
            "Jerk",
            "m/s³",
            each(runs, x, moving_jerk, "jerk"),
            Some((-1.0, 1.0)),
        );
    }
    if let [run] = runs {
        plots.push(forces(run));
    }
    plots.extend(last_metres(runs));
    plots
}

/// The unavoidable jerk of the standstill itself is left out, as in the figures.
fn moving_jerk(row: &Row) -> f64 {
    if row.speed_kmh == 0.0 && row.t_s > 0.0 {
        f64::NAN
    } else {
        row.jerk_mps3
    }
}

fn curve(name: &str, colour: usize, style: Style, rows: &[Row], x: Of, y: Of) -> Series {
    Series {
        name: name.into(),
        colour,
        style,
        points: rows.iter().map(|row| (x(row), y(row))).collect(),
    }
}

/// One curve for each run, named by its controller where there are several.
fn each(runs: &[Driven], x: Of, y: Of, name: &str) -> Vec<Series> {
    let named = |run: &Driven| {
        if runs.len() > 1 {
            run.case.controller.name().into()
        } else {
            name.to_owned()
        }
    };
    let one =
        |(i, run): (usize, &Driven)| curve(&named(run), i, Style::Line, &run.outcome.rows, x, y);
    runs.iter().enumerate().map(one).collect()
}

fn speed(runs: &[Driven], x: Of) -> Vec<Series> {
    let Some(first) = runs.first() else {
        return Vec::new();
    };
    let mut series = vec![curve(
        "limit",
        4,
        Style::Line,
        &first.outcome.rows,
        x,
        |r| r.limit_kmh,
    )];
    if runs.len() == 1 {
        series.push(curve(
            "target",
            1,
            Style::Dashed,
            &first.outcome.rows,
            x,
            |r| r.target_kmh,
        ));
        series.push(curve(
            "actual",
            0,
            Style::Line,
            &first.outcome.rows,
            x,
            |r| r.speed_kmh,
        ));
    } else {
        series.extend(each(runs, x, |r| r.speed_kmh, "actual"));
    }
    series
}

fn position(runs: &[Driven]) -> Vec<Series> {
    let mut series = each(runs, TIME, |r| r.x_m, "true");
    if let [run] = runs {
        series.push(curve(
            "by the unit",
            1,
            Style::Dashed,
            &run.outcome.rows,
            TIME,
            |r| r.position_m,
        ));
    }
    series
}

fn forces(run: &Driven) -> Plot {
    let rows = &run.outcome.rows;
    Plot {
        title: "Forces on the rails over distance".into(),
        x_label: "Position in the section, m".into(),
        y_label: "kN".into(),
        x_range: Some(range(std::slice::from_ref(run), PLACE)),
        series: vec![
            curve("traction", 0, Style::Line, rows, PLACE, |r| {
                r.traction_n / 1e3
            }),
            curve("electric brake", 2, Style::Line, rows, PLACE, |r| {
                -r.electric_brake_n / 1e3
            }),
            curve("air brake", 1, Style::Line, rows, PLACE, |r| {
                -r.air_brake_n / 1e3
            }),
        ],
        places: places(std::slice::from_ref(run), false),
        ..Plot::default()
    }
}

/// The last metres larger: speed by the way that is left, true and as the unit sees it.
fn last_metres(runs: &[Driven]) -> Option<Plot> {
    let first = runs.first()?;
    let stop_m = first.case.plan.section.stop_m;
    let mut series = Vec::new();
    for (i, run) in runs.iter().enumerate() {
        let name = if runs.len() > 1 {
            run.case.controller.name()
        } else {
            "actual"
        };
        let rows = run.outcome.rows.iter().filter(|row| row.t_s >= 0.0);
        let last: Vec<_> = rows
            .filter(|row| row.x_m >= stop_m - LAST_M - 2.0)
            .copied()
            .collect();
        let mut one = curve(name, i, Style::Line, &last, PLACE, |r| r.speed_kmh);
        one.points.iter_mut().for_each(|point| point.0 -= stop_m);
        series.push(one);
    }
    let off = runs.iter().filter_map(|run| run.outcome.stop_error_m);
    let past = off
        .clone()
        .fold(PAST_M, |most, error| most.max(error + 0.5));
    let at = off.map(|error| Place {
        x: error,
        name: centimetres(error),
    });
    Some(Plot {
        title: "The last metres".into(),
        x_label: "Way past the stop point, m".into(),
        y_label: "km/h".into(),
        x_range: Some((-LAST_M, past)),
        y_reach: Some((0.0, 1.0)),
        series,
        places: std::iter::once(Place {
            x: -(stop_m - first.case.plan.section.markers_m[3]),
            name: "PSM4".into(),
        })
        .chain(at)
        .collect(),
    })
}

/// From the first row of any run to its last, and a little beyond.
fn range(runs: &[Driven], x: Of) -> (f64, f64) {
    let rows = |run: &Driven| Some((x(run.outcome.rows.first()?), x(run.outcome.rows.last()?)));
    let ends = runs.iter().filter_map(rows);
    let all = ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (low, high) = all.unwrap_or((0.0, 1.0));
    (low, high + (high - low) * BEYOND)
}

/// Markers and stop point: by place, or by the time of the only run.
fn places(runs: &[Driven], by_time: bool) -> Vec<Place> {
    let Some(run) = runs.first() else {
        return Vec::new();
    };
    if by_time {
        let marks = run.outcome.landmarks.iter().filter(|_| runs.len() == 1);
        let marks = marks.filter(|mark| mark.what.starts_with("PSM") || mark.what == "stop");
        let name = |what: &str| what.trim_end_matches(" passed").to_owned();
        return marks
            .map(|mark| Place {
                x: mark.t_s,
                name: name(&mark.what),
            })
            .collect();
    }
    let section = &run.case.plan.section;
    let markers = (1..).zip(section.markers_m).map(|(i, x)| Place {
        x,
        name: format!("PSM{i}"),
    });
    markers
        .chain([Place {
            x: section.stop_m,
            name: "stop".into(),
        }])
        .collect()
}

/// An argument as a shell takes it back.
fn quoted(argument: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:@+%".contains(c);
    if !argument.is_empty() && argument.chars().all(plain) {
        return argument.to_owned();
    }
    format!("'{}'", argument.replace('\'', "'\\''"))
}

/// Look of the page, light and dark.
const STYLE: &str = include_str!("style.css");
