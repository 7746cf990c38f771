//! How long a scan of TCMS takes: `cargo bench -p btu-rig --bench tcms`. One item is one scan. What it
//! shares out over the cars is part of it; `effort` shows that part alone.

use btu_rig::lever::Lever;
use btu_rig::tcms::{CabInputs, Consist, Effort, Order, Tcms, TcmsInputs};
use btu_rig::train::{CarSet, CarsData, Equipment, TrainData};
use divan::Bencher;
use divan::counter::ItemsCount;
use protocol::message::{AtcToTcms, AtcToTcmsBits, Mode, ModeSwitch, Outputs};
use protocol::{Instant, SCAN};

/// Scans of a run of 95 s.
const SCANS: usize = 9500;

fn main() {
    divan::main();
}

/// Efforts of ATO in turn: power, coasting, braking.
const EFFORTS: [i16; 3] = [1023, 0, -600];

fn cab(hcr: bool, train: &TrainData) -> CabInputs {
    CabInputs {
        hcr,
        reverser: 1,
        mode_switch: ModeSwitch::Automatic,
        controller: train.tcms().at(Lever::Neutral),
        dead_man: true,
        ..CabInputs::default()
    }
}

#[divan::bench(args = ["line6", "ideal"])]
fn scan(bencher: Bencher<'_, '_>, name: &str) {
    let train = match name {
        "ideal" => TrainData::ideal(),
        _ => TrainData::line6(),
    };
    let mut equipment = Equipment::default();
    for car in [1, 2, 5, 6] {
        equipment.axle_mps[car] = 12.0;
    }
    let inputs = TcmsInputs {
        cabs: [cab(true, &train), cab(false, &train)],
        doors_closed: true,
        contacts: Some(Outputs::EB_RELAY),
        load_kg: 80_000.0,
        equipment: Some(&equipment),
        ..TcmsInputs::default()
    };
    bencher
        .counter(ItemsCount::new(SCANS))
        .with_inputs(|| Tcms::new(&train))
        .bench_refs(|tcms| {
            let mut now = Instant::ZERO;
            let mut demand = 0.0;
            for scan in 0..SCANS {
                now += SCAN;
                if scan % 5 == 0 {
                    let effort = EFFORTS[scan * EFFORTS.len() / SCANS];
                    let mut bits = AtcToTcmsBits::empty();
                    bits.set(AtcToTcmsBits::POWER, effort > 0);
                    bits.set(AtcToTcmsBits::BRAKE, effort < 0);
                    let order = AtcToTcms {
                        bits,
                        mode: Mode::AutomaticRun,
                        effort,
                        ..AtcToTcms::default()
                    };
                    tcms.receive(now, &order);
                }
                demand += tcms.step(now, divan::black_box(&inputs)).demand;
            }
            demand
        });
}

#[divan::bench]
fn effort(bencher: Bencher<'_, '_>) {
    let cars = CarsData::line6();
    let equipment = Equipment::default();
    bencher
        .counter(ItemsCount::new(SCANS))
        .with_inputs(|| Effort::new(Consist::new(&cars)))
        .bench_refs(|effort| {
            let mut braked_n = 0.0;
            for scan in 0..SCANS {
                let value = EFFORTS[scan * EFFORTS.len() / SCANS];
                let order = Order {
                    share: f64::from(value) / 1024.0,
                    holding: false,
                    no_inverters: false,
                    power_cut: false,
                    speed_mps: 12.0,
                    inverters_out: CarSet::NONE,
                    brakes_out: CarSet::NONE,
                };
                let demands = effort.step(0.01, divan::black_box(&order), Some(&equipment));
                braked_n += demands.brake_n;
            }
            braked_n
        });
}
