//! Time of ATO's part of a cycle: `cargo bench -p ato-under-test`.
//!
//! Goal: one control cycle of the slowest controller takes at most 5 µs.

use ato_under_test::ato::controller::{ControllerInput, controller};
use divan::{Bencher, black_box};
use protocol::config::{ControllerKind, UnitConfig};

fn main() {
    divan::main();
}

/// A station stop seen cycle after cycle: every phase of a profile, errors of both signs.
fn situations() -> Vec<ControllerInput> {
    let cycles = 1800;
    (0..cycles)
        .map(|i| {
            let share = f64::from(i) / f64::from(cycles);
            ControllerInput {
                cruise_mps: 16.7,
                speed_mps: 16.0 * (share * std::f64::consts::PI).sin()
                    + 0.3 * (f64::from(i) * 0.7).sin(),
                accel_mps2: 0.8 * (share * std::f64::consts::PI).cos(),
                to_stop_m: Some(850.0 * (1.0 - share)),
                markers_to_stop_m: [546.0, 108.5, 21.0, 3.5],
                mass_kg: 432_000.0,
                brake_mps2: 0.97,
                granted_n: 300_000.0 * (share * std::f64::consts::PI).cos(),
            }
        })
        .collect()
}

#[divan::bench(args = ["servo", "pi", "fuzzy", "pss"])]
fn control_cycle(bencher: Bencher, name: &str) {
    let text = include_str!("../../scripts/units/sg100.toml");
    let mut config = UnitConfig::from_toml(text)
        .expect("the configuration is sound")
        .ato;
    config.controller = ControllerKind::from_name(name).expect("a known controller");
    let mut controller = controller(&config);
    let situations = situations();
    let mut next = 0;
    bencher.counter(1usize).bench_local(|| {
        next = (next + 1) % situations.len();
        if next == 0 {
            controller.reset();
        }
        controller.step(black_box(&situations[next]))
    });
}
