//! How long the train models take, with TCMS's sharing out of effort for a train of cars:
//! `cargo bench -p btu-rig --bench train`. One item is the two steps of 5 ms of a scan.

use btu_rig::conditions::Conditions;
use btu_rig::tcms::{Consist, Demands, Effort, Order};
use btu_rig::train::{CarSet, Train, TrainData, TrainInputs, TrainState};
use divan::Bencher;
use divan::counter::ItemsCount;

/// Scans of a run of 95 s.
const SCANS: usize = 9500;

fn main() {
    divan::main();
}

/// Power to 60 km/h, coasting, braking to a stop: the three things a train does.
fn run((train, effort): &mut (Train, Option<Effort>)) -> TrainState {
    let mut state = TrainState::default();
    for scan in 0..SCANS {
        let share = [1.0, 0.05, -0.6][(scan / 2500).min(2)];
        let order = Order {
            share,
            holding: false,
            no_inverters: false,
            power_cut: false,
            speed_mps: train.velocity_mps().abs(),
            inverters_out: CarSet::NONE,
            brakes_out: CarSet::NONE,
        };
        let demands = effort.as_mut().map_or_else(Demands::default, |effort| {
            effort.step(0.01, &order, Some(&train.equipment()))
        });
        let inputs = TrainInputs {
            demand: share,
            motor_n: demands.motor_n,
            air_n: demands.air_n,
            gradient_permille: -3.0,
            ..TrainInputs::default()
        };
        train.step(0.005, &inputs);
        state = train.step(0.005, &inputs);
    }
    state
}

#[divan::bench(args = ["line6", "ideal", "line6 sliding"])]
fn section_run(bencher: Bencher<'_, '_>, name: &str) {
    let data = match name {
        "ideal" => TrainData::ideal(),
        _ => TrainData::line6(),
    };
    let mut conditions = Conditions::default();
    if name == "line6 sliding" {
        conditions.adhesion = 0.06;
    }
    let train = Train::new(&data, &conditions);
    let effort = match &data {
        TrainData::Cars(cars) => Some(Effort::new(Consist::new(cars))),
        TrainData::Ideal(_) => None,
    };
    bencher
        .counter(ItemsCount::new(SCANS))
        .with_inputs(|| (train.clone(), effort.clone()))
        .bench_refs(run);
}
