//! The plots of one run, or of several side by side, as the papers have them.

use btu_rig::drive::Row;

use super::figures::off;
use crate::plot::{Place, Plot, Series, Style};
use ptu_bench::drive::Driven;

/// Way before the stop point that is shown larger, m.
const LAST_M: f64 = 12.0;
/// Share of an axis shown beyond the end of the run, so that the stop can be seen.
const BEYOND: f64 = 0.01;
/// Way past the stop point, m.
const PAST_M: f64 = 1.0;

/// What a curve shows of a row.
type Of = fn(&Row) -> f64;

const TIME: Of = |row| row.t_s;
const PLACE: Of = |row| row.x_m;

/// Speed, effort, acceleration and jerk over time and distance, forces, and the last metres.
pub fn plots(runs: &[Driven]) -> Vec<Plot> {
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
                ..Plot::default()
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
        for (plot, x) in plots
            .iter_mut()
            .filter(|plot| plot.title.starts_with("Speed"))
            .zip([TIME, PLACE])
        {
            plot.shade_slides(&run.outcome.rows, |row| row.sliding, x);
        }
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
    let errors = runs.iter().filter_map(|run| run.outcome.stop_error_m);
    let past = errors
        .clone()
        .fold(PAST_M, |most, error| most.max(error + 0.5));
    let at = errors.map(|error| Place {
        x: error,
        name: off(error),
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
        ..Plot::default()
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
