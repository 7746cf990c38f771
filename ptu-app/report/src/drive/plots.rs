//! The plots of automatic runs as the papers have them, and of many runs.

use btu_rig::drive::{Mark, Row, ScatterDraw};
use protocol::signal::Signal;

use super::facts::off;
use crate::plot::{AxisMark, Plot, Series, Style};
use ptu_runs::drive::Driven;
use ptu_runs::drive::monte_carlo::MonteCarlo;

/// Length of track before the stop point that is shown enlarged, m.
const LAST_M: f64 = 12.0;
/// Share of an axis shown beyond the end of the run, so that the stop can be seen.
const BEYOND: f64 = 0.01;
/// Least length of track past the stop point that is shown enlarged, m.
const PAST_M: f64 = 1.0;
/// Bars of the histogram.
const BARS: usize = 60;
/// Dots of a scatter plot at most: more hide each other.
const MOST_DOTS: usize = 2_000;

/// Value of a row that a curve shows.
type Of = fn(&Row) -> f64;

const TIME: Of = |row| row.t_s;
const PLACE: Of = |row| row.x_m;
const TRACTION_KN: Of = |row| row.value(Signal::Traction) / 1e3;
const ELECTRIC_KN: Of = |row| row.value(Signal::ElectricBrake) / 1e3;
const AIR_KN: Of = |row| row.value(Signal::AirBrake) / 1e3;

/// A curve: name, colour, style and value.
type Curve<'a> = (&'a str, usize, Style, Of);

fn series(rows: &[Row], x: Of, (name, colour, style, y): Curve<'_>) -> Series {
    Series {
        name: name.into(),
        colour,
        style,
        points: rows.iter().map(|row| (x(row), y(row))).collect(),
    }
}

/// Speed, effort, acceleration and jerk over time and distance, forces, and the last metres.
pub fn plots(runs: &[Driven]) -> Vec<Plot> {
    let mut plots = Vec::new();
    let alone = runs.len() == 1;
    for (along, x_label, x) in [
        ("time", "Time since the train began to move, s", TIME),
        ("distance", "Position in the section, m", PLACE),
    ] {
        let mut add = |title: &str, y_label: &str, series: Vec<Series>, y_reach| {
            plots.push(Plot {
                title: format!("{title} over {along}"),
                x_label: x_label.into(),
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
            let mut position = each(runs, x, PLACE, "true");
            let by_unit: Curve<'_> = ("by the unit", 1, Style::Dashed, |r| {
                r.value(Signal::Position)
            });
            let only = runs.iter().filter(|_| alone);
            position.extend(only.map(|run| series(&run.outcome.rows, x, by_unit)));
            add("Position", "m", position, Some((0.0, 1.0)));
        }
        let effort: Of = |r| r.value(Signal::Effort);
        let effort = each(runs, x, effort, "effort");
        add("Effort", "−1024 .. 1023", effort, Some((-1024.0, 1023.0)));
        let accel: Of = |r| r.value(Signal::TrainAccel) * 3.6;
        let accel = each(runs, x, accel, "acceleration");
        add("Acceleration", "km/h/s", accel, Some((-3.0, 3.0)));
        let jerk = each(runs, x, moving_jerk, "jerk");
        add("Jerk", "m/s³", jerk, Some((-1.0, 1.0)));
    }
    if let [run] = runs {
        for (plot, x) in plots
            .iter_mut()
            .filter(|plot| plot.title.starts_with("Speed"))
            .zip([TIME, PLACE])
        {
            plot.shaded = slides(&run.outcome.rows, x);
        }
        plots.push(forces(run));
    }
    plots.extend(last_metres(runs));
    plots
}

/// Where cars slip or slide, from the first row of each stretch to its last.
fn slides(rows: &[Row], x: Of) -> Vec<(f64, f64)> {
    let stretches = rows.chunk_by(|a, b| a.sliding == b.sliding);
    let sliding = stretches.filter(|stretch| stretch[0].sliding);
    sliding
        .map(|stretch| (x(&stretch[0]), x(&stretch[stretch.len() - 1])))
        .collect()
}

/// Jerk of the moving train: the unavoidable jerk of the standstill itself is left out, as in the figures.
fn moving_jerk(row: &Row) -> f64 {
    if row.speed_kmh == 0.0 && row.t_s > 0.0 {
        f64::NAN
    } else {
        row.value(Signal::TrainJerk)
    }
}

/// One curve for each run, named by its controller where there are several.
fn each(runs: &[Driven], x: Of, y: Of, name: &str) -> Vec<Series> {
    let one = |(at, run): (usize, &Driven)| {
        let name = if runs.len() > 1 {
            run.case.controller.name()
        } else {
            name
        };
        series(&run.outcome.rows, x, (name, at, Style::Line, y))
    };
    runs.iter().enumerate().map(one).collect()
}

fn speed(runs: &[Driven], x: Of) -> Vec<Series> {
    let limit: Curve<'_> = ("limit", 4, Style::Line, |r| r.value(Signal::Limit));
    let target: Curve<'_> = ("target", 1, Style::Dashed, |r| r.value(Signal::Target));
    let first = runs.iter().take(1);
    let mut all: Vec<_> = first
        .map(|run| series(&run.outcome.rows, x, limit))
        .collect();
    if let [run] = runs {
        all.push(series(&run.outcome.rows, x, target));
    }
    all.extend(each(runs, x, |r| r.speed_kmh, "actual"));
    all
}

fn forces(run: &Driven) -> Plot {
    let curves: [Curve<'_>; 3] = [
        ("traction", 0, Style::Line, TRACTION_KN),
        ("electric brake", 2, Style::Line, |r| -ELECTRIC_KN(r)),
        ("air brake", 1, Style::Line, |r| -AIR_KN(r)),
    ];
    let run = std::slice::from_ref(run);
    Plot {
        title: "Forces on the rails over distance".into(),
        x_label: "Position in the section, m".into(),
        y_label: "kN".into(),
        x_range: Some(range(run, PLACE)),
        series: curves
            .map(|curve| series(&run[0].outcome.rows, PLACE, curve))
            .into(),
        places: places(run, false),
        ..Plot::default()
    }
}

/// Plot of the last metres: true speed over the distance from the stop point, with PSM4 and the places of the stops.
fn last_metres(runs: &[Driven]) -> Option<Plot> {
    let section = &runs.first()?.case.plan.section;
    let stop_m = section.stop_m;
    let mut all = each(runs, PLACE, |r| r.speed_kmh, "actual");
    for (one, run) in all.iter_mut().zip(runs) {
        let kept = |row: &Row| row.t_s >= 0.0 && row.x_m >= stop_m - LAST_M - 2.0;
        let mut rows = run.outcome.rows.iter();
        one.points.retain(|_| rows.next().is_some_and(kept));
        one.points.iter_mut().for_each(|point| point.0 -= stop_m);
    }
    let errors = runs.iter().filter_map(|run| run.outcome.stop_error_m);
    let past = errors
        .clone()
        .fold(PAST_M, |most, error| most.max(error + 0.5));
    let at = |(x, name): (f64, String)| AxisMark { x, name };
    let psm4 = (-(stop_m - section.markers_m[3]), "PSM4".into());
    Some(Plot {
        title: "The last metres".into(),
        x_label: "Way past the stop point, m".into(),
        y_label: "km/h".into(),
        x_range: Some((-LAST_M, past)),
        y_reach: Some((0.0, 1.0)),
        series: all,
        places: std::iter::once(psm4)
            .chain(errors.map(|error| (error, off(error))))
            .map(at)
            .collect(),
        ..Plot::default()
    })
}

/// Range from the least value in the first rows of all runs to the greatest in their last rows, and a little beyond.
fn range(runs: &[Driven], x: Of) -> (f64, f64) {
    let rows = |run: &Driven| Some((x(run.outcome.rows.first()?), x(run.outcome.rows.last()?)));
    let ends = runs.iter().filter_map(rows);
    let all = ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (low, high) = all.unwrap_or((0.0, 1.0));
    (low, high + (high - low) * BEYOND)
}

/// Markers and stop point: by place, or by time if there is one run alone.
fn places(runs: &[Driven], by_time: bool) -> Vec<AxisMark> {
    let Some(run) = runs.first() else {
        return Vec::new();
    };
    if by_time {
        let marks = run.outcome.landmarks.iter().filter(|_| runs.len() == 1);
        let marks = marks.filter(|mark| matches!(mark.what, Mark::Psm(_) | Mark::Stop));
        let place = |mark: &btu_rig::drive::Landmark| AxisMark {
            x: mark.t_s,
            name: match mark.what {
                Mark::Psm(psm) => format!("PSM{psm}"),
                _ => mark.what.to_string(),
            },
        };
        return marks.map(place).collect();
    }
    let section = &run.case.plan.section;
    let markers = (1..)
        .zip(section.markers_m)
        .map(|(i, x)| (x, format!("PSM{i}")));
    let all = markers.chain([(section.stop_m, "stop".into())]);
    all.map(|(x, name)| AxisMark { x, name }).collect()
}

/// Plots of the stop errors, and of values that go with them.
pub fn plots_of_many(many: &MonteCarlo) -> Vec<Plot> {
    /// A number that is drawn for each run.
    type Drawn = fn(&ScatterDraw) -> f64;
    let drawn: [(&str, Drawn); 7] = [
        ("passengers, t", |d| d.load_kg / 1000.0),
        ("gradients added, ‰", |d| {
            d.conditions.gradient_offset_permille
        }),
        ("adhesion", |d| d.conditions.adhesion),
        ("delays, of nominal", |d| d.conditions.delay_factor),
        ("brakes, of nominal", |d| d.conditions.brake_factor),
        ("wheel diameter, of configured", |d| {
            d.conditions.wheel_factor
        }),
        ("PSM4 off by, cm", |d| {
            d.conditions.marker_offsets_m[3] * 100.0
        }),
    ];
    // A number that is the same in all runs was held fixed, or does not act on the train.
    let differs = |of: Drawn| {
        let mut pairs = many.trials.windows(2);
        pairs.any(|pair| of(&pair[0].drawn) != of(&pair[1].drawn))
    };
    let against = |(name, of): (&str, Drawn)| {
        let trials = many.trials.iter();
        let points =
            trials.filter_map(|trial| Some((of(&trial.drawn), trial.stop_error_m? * 100.0)));
        Plot {
            title: format!("Stop error by {name}"),
            x_label: name.into(),
            y_label: "cm".into(),
            series: vec![unnamed(Style::Dots, points.take(MOST_DOTS).collect())],
            ..Plot::default()
        }
    };
    let drawn = drawn.into_iter().filter(|(_, of)| differs(*of));
    std::iter::once(histogram(many))
        .chain(drawn.map(against))
        .collect()
}

fn unnamed(style: Style, points: Vec<(f64, f64)>) -> Series {
    Series {
        name: String::new(),
        colour: 0,
        style,
        points,
    }
}

fn histogram(many: &MonteCarlo) -> Plot {
    let errors = many.stop_errors_m();
    let end = |error: Option<&f64>| error.copied().unwrap_or(0.0);
    let (low, high) = (end(errors.first()), end(errors.last()));
    let width = ((high - low) / BARS as f64).max(1e-4);
    let mut counts = vec![0.0; BARS + 1];
    for error in &errors {
        counts[(((error - low) / width) as usize).min(BARS)] += 1.0;
    }
    let bar = |(i, count): (usize, f64)| ((low + (i as f64 + 0.5) * width) * 100.0, count);
    let tolerance_cm = many.case.tolerance_m() * 100.0;
    let place = |x: f64| AxisMark {
        x,
        name: format!("{x:+.0} cm"),
    };
    Plot {
        title: "Stop errors".into(),
        x_label: "Past the stop point, cm".into(),
        y_label: "runs".into(),
        y_reach: Some((0.0, 1.0)),
        series: vec![unnamed(
            Style::Bars,
            counts.into_iter().enumerate().map(bar).collect(),
        )],
        places: [-tolerance_cm, tolerance_cm].map(place).into(),
        ..Plot::default()
    }
}
