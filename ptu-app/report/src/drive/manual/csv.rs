//! A run by hand as CSV: a line each cycle.

use std::fmt::Write;

use btu_rig::drive::manual::{Pair, Row};

use super::super::csv::cell;
use ptu_bench::drive::manual::ManualRun;

/// A number of a row.
type Of = fn(&Row) -> f64;
/// A number of one of its pairs.
type OfPair = fn(&Pair) -> f64;

/// Columns of a cycle.
const COLUMNS: [(&str, Of); 14] = [
    ("t_s", |r| r.t_s),
    ("x_m", |r| r.x_m),
    ("speed_kmh", |r| r.speed_kmh),
    ("limit_kmh", |r| r.limit_kmh),
    ("accel_m_s2", |r| r.accel_mps2),
    ("jerk_m_s3", |r| r.jerk_mps3),
    ("lever", |r| r.lever),
    ("tcms_value", |r| r.value),
    ("motor_demand_n", |r| r.motor_demand_n),
    ("brake_demand_n", |r| r.brake_demand_n),
    ("te_n", |r| r.traction_n),
    ("electric_n", |r| r.electric_n),
    ("air_n", |r| r.air_n),
    ("sliding", |r| f64::from(u8::from(r.sliding))),
];

/// Columns of each MT pair, behind `pair1_` to `pair4_`.
const PAIR_COLUMNS: [(&str, OfPair); 7] = [
    ("motor_demand_n", |p| p.motor_demand_n),
    ("te_n", |p| p.traction_n),
    ("electric_n", |p| p.electric_n),
    ("air_t_demand_n", |p| p.air_t_demand_n),
    ("air_t_n", |p| p.air_t_n),
    ("air_m_demand_n", |p| p.air_m_demand_n),
    ("air_m_n", |p| p.air_m_n),
];

/// All of it.
pub fn csv(run: &ManualRun) -> String {
    let train = COLUMNS.iter().map(|column| column.0.to_owned());
    let pairs = (1..=btu_rig::drive::manual::PAIRS).flat_map(|pair| {
        PAIR_COLUMNS
            .iter()
            .map(move |column| format!("pair{pair}_{}", column.0))
    });
    let names: Vec<_> = train.chain(pairs).collect();
    let mut text = format!("{}\n", names.join(","));
    for row in &run.outcome.rows {
        let train = COLUMNS.iter().map(|column| (column.1)(row));
        let of_pair = |pair| PAIR_COLUMNS.iter().map(move |column| (column.1)(pair));
        let cells: Vec<_> = train
            .chain(row.pairs.iter().flat_map(of_pair))
            .map(cell)
            .collect();
        // Writing to a text cannot fail.
        let _ = writeln!(text, "{}", cells.join(","));
    }
    text
}
