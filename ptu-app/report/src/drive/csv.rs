//! Runs as CSV: a line each cycle, or of a Monte Carlo a line each run.

use std::fmt::Write;

use btu_rig::drive::Row;

use super::figures::FIGURES;
use super::{Outcomes, Results};
use crate::csv::Cell;
use ptu_bench::drive::Driven;
use ptu_bench::drive::monte_carlo::MonteCarlo;

/// A number of a row.
type Of = fn(&Row) -> f64;

/// Columns of a cycle.
const COLUMNS: [(&str, Of); 15] = [
    ("t_s", |r| r.t_s),
    ("x_m", |r| r.x_m),
    ("speed_kmh", |r| r.speed_kmh),
    ("measured_kmh", |r| r.measured_kmh),
    ("limit_kmh", |r| r.limit_kmh),
    ("target_kmh", |r| r.target_kmh),
    ("effort", |r| r.effort),
    ("accel_m_s2", |r| r.accel_mps2),
    ("jerk_m_s3", |r| r.jerk_mps3),
    ("position_by_unit_m", |r| r.position_m),
    ("traction_n", |r| r.traction_n),
    ("electric_brake_n", |r| r.electric_brake_n),
    ("air_brake_n", |r| r.air_brake_n),
    ("power_w", |r| r.power_w),
    ("sliding", |r| f64::from(u8::from(r.sliding))),
];

/// All of it.
pub fn csv(results: &Results) -> String {
    match &results.outcomes {
        Outcomes::Single(runs) => cycles(runs),
        Outcomes::Many(many) => trials(many),
    }
}

fn cycles(runs: &[Driven]) -> String {
    let names: Vec<_> = COLUMNS.iter().map(|column| column.0).collect();
    let mut text = format!("section,controller,{}\n", names.join(","));
    for run in runs {
        let (section, controller) = (run.case.plan.section.section, run.case.controller.name());
        for row in &run.outcome.rows {
            let cells: Vec<_> = COLUMNS.iter().map(|column| cell((column.1)(row))).collect();
            // Writing to a text cannot fail.
            let _ = writeln!(text, "{section},{controller},{}", cells.join(","));
        }
    }
    text
}

fn trials(many: &[MonteCarlo]) -> String {
    let names: Vec<_> = FIGURES.iter().map(|figure| figure.key).collect();
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
            let of = |i: usize| trial.metrics.as_ref().map_or(f64::NAN, FIGURES[i].of);
            let figures: Vec<_> = (0..FIGURES.len()).map(of).collect();
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
pub fn cell(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.6}")
    } else {
        String::new()
    }
}
