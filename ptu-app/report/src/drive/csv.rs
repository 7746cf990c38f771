//! Runs as CSV: a line each cycle, or of a Monte Carlo a line each run.

use std::fmt::Write;

use btu_rig::drive::{Metrics, Row};
use protocol::signal::Signal;

use super::{Outcomes, Results};
use crate::csv::{Cell, MARK};
use ptu_runs::drive::monte_carlo::MonteCarlo;

/// A column of a cycle: its name and its value.
type Column = (&'static str, fn(&Row) -> f64);

/// Columns of an automatic run.
const COLUMNS: [Column; 15] = [
    ("t_s", |r| r.t_s),
    ("x_m", |r| r.x_m),
    ("speed_kmh", |r| r.speed_kmh),
    ("measured_kmh", |r| r.value(Signal::Speed)),
    ("limit_kmh", |r| r.value(Signal::Limit)),
    ("target_kmh", |r| r.value(Signal::Target)),
    ("effort", |r| r.value(Signal::Effort)),
    ("accel_m_s2", |r| r.value(Signal::TrainAccel)),
    ("jerk_m_s3", |r| r.value(Signal::TrainJerk)),
    ("position_by_unit_m", |r| r.value(Signal::Position)),
    ("traction_n", |r| r.value(Signal::Traction)),
    ("electric_brake_n", |r| r.value(Signal::ElectricBrake)),
    ("air_brake_n", |r| r.value(Signal::AirBrake)),
    ("power_w", |r| r.power_w),
    ("sliding", |r| f64::from(r.sliding)),
];

pub fn csv(results: &Results) -> String {
    let mut text = MARK.to_owned();
    match &results.outcomes {
        Outcomes::Single(runs) => {
            let names: Vec<_> = COLUMNS.iter().map(|column| column.0).collect();
            text += &format!("section,controller,{}\n", names.join(","));
            for run in runs {
                let controller = run.case.controller.name();
                let before = format!("{},{controller},", run.case.plan.section.section);
                cycles(&mut text, &before, &run.outcome.rows);
            }
        }
        Outcomes::Many(many) => text += &trials(many),
    }
    text
}

fn cycles(text: &mut String, before: &str, rows: &[Row]) {
    for row in rows {
        let cells = COLUMNS.map(|column| cell((column.1)(row)));
        // Writing to a text cannot fail.
        let _ = writeln!(text, "{before}{}", cells.join(","));
    }
}

fn trials(many: &[MonteCarlo]) -> String {
    let names: Vec<_> = Metrics::ALL.iter().map(|figure| figure.key).collect();
    let mut text = format!(
        "section,controller,seed,ending,load_kg,gradient_offset_permille,adhesion,delay_factor,\
         brake_factor,wheel_factor,psm1_m,psm2_m,psm3_m,psm4_m,stop_error_m,{}\n",
        names.join(",")
    );
    for one in many {
        let (section, controller) = (one.case.plan.section.section, one.case.controller.name());
        for trial in &one.trials {
            let c = &trial.drawn.conditions;
            let drawn = [
                trial.drawn.load_kg,
                c.gradient_offset_permille,
                c.adhesion,
                c.delay_factor,
                c.brake_factor,
                c.wheel_factor,
            ];
            let error = [trial.stop_error_m.unwrap_or(f64::NAN)];
            let metrics = trial.metrics.as_ref();
            let figures: Vec<_> = Metrics::ALL
                .iter()
                .map(|figure| metrics.map_or(f64::NAN, figure.of))
                .collect();
            let values = drawn
                .iter()
                .chain(&c.marker_offsets_m)
                .chain(&error)
                .chain(&figures);
            let cells: Vec<_> = values.map(|value| cell(*value)).collect();
            let (seed, ending) = (trial.seed, &trial.ending);
            // Writing to a text cannot fail.
            let _ = writeln!(
                text,
                "{section},{controller},{seed},{},{}",
                Cell::Text(ending.to_string()).written(),
                cells.join(",")
            );
        }
    }
    text
}

/// A number, or nothing for what is not known.
fn cell(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.6}")
    } else {
        String::new()
    }
}
