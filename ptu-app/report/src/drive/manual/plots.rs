//! The plots of a run by hand: those of S3's figures 5 to 7, and the whole train.

use btu_rig::drive::manual::Row;

use crate::plot::{Place, Plot, Series, Style};
use ptu_bench::drive::manual::ManualRun;

/// Colours of what is plotted, the same in all plots.
const TOTAL: usize = 0;
const AIR: usize = 1;
const ELECTRIC: usize = 2;
const MOTOR_AIR: usize = 3;
const DEMAND: usize = 4;
/// Full effort as a value of TCMS.
const FULL: f64 = 1024.0;

/// What a curve shows of a row.
type Of = fn(&Row) -> f64;

/// Speed, order, inverter and air of MT pair 1, and the train, over time.
pub fn plots(run: &ManualRun) -> Vec<Plot> {
    let rows = &run.outcome.rows;
    let line = |name, colour, of| curve(rows, name, colour, Style::Line, of);
    let dashed = |name, of| curve(rows, name, DEMAND, Style::Dashed, of);
    let plot = |title: &str, y_label: &str, y_reach, series: Vec<Series>| Plot {
        title: title.into(),
        x_label: "Time since the sequence began, s".into(),
        y_label: y_label.into(),
        x_range: Some((0.0, rows.last().map_or(1.0, |row| row.t_s))),
        y_reach: Some(y_reach),
        series,
        places: places(run),
        ..Plot::default()
    };
    let mut speed = plot(
        "Speed",
        "km/h",
        (0.0, 1.0),
        vec![
            dashed("limit", |r| r.limit_kmh),
            line("actual", TOTAL, |r| r.speed_kmh),
        ],
    );
    speed.shade_slides(rows, |row| row.sliding, |row| row.t_s);
    vec![
        speed,
        plot(
            "Order of TCMS to inverters and brakes",
            "% of full power, full service",
            (-100.0, 100.0),
            vec![line("order", TOTAL, |r| 100.0 * r.value / FULL)],
        ),
        plot(
            "MT pair 1: inverter",
            "kN, brake negative",
            (-1.0, 1.0),
            vec![
                line("TE", TOTAL, |r| r.pairs[0].traction_n / 1e3),
                line("electric brake", ELECTRIC, |r| -r.pairs[0].electric_n / 1e3),
                dashed("demand", |r| r.pairs[0].motor_demand_n / 1e3),
            ],
        ),
        plot(
            "MT pair 1: air brake",
            "kN",
            (0.0, 1.0),
            vec![
                line("T cars", AIR, |r| r.pairs[0].air_t_n / 1e3),
                line("M cars", MOTOR_AIR, |r| r.pairs[0].air_m_n / 1e3),
                dashed("demands", |r| r.pairs[0].air_t_demand_n / 1e3),
                dashed("demands", |r| r.pairs[0].air_m_demand_n / 1e3),
            ],
        ),
        plot(
            "Whole train: brake",
            "kN",
            (0.0, 1.0),
            vec![
                line("electric", ELECTRIC, |r| r.electric_n / 1e3),
                line("air", AIR, |r| r.air_n / 1e3),
                line("total", TOTAL, |r| r.brake_n() / 1e3),
                dashed("demand", |r| r.brake_demand_n / 1e3),
            ],
        ),
    ]
}

fn curve(rows: &[Row], name: &str, colour: usize, style: Style, of: Of) -> Series {
    Series {
        name: name.into(),
        colour,
        style,
        points: rows.iter().map(|row| (row.t_s, of(row))).collect(),
    }
}

/// What was done, as named times.
fn places(run: &ManualRun) -> Vec<Place> {
    let place = |done: &btu_rig::drive::manual::Done| Place {
        x: done.t_s,
        name: done.what(),
    };
    run.outcome.done.iter().map(place).collect()
}
