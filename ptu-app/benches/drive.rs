//! Speed of a station-to-station run: `cargo bench -p ptu-app --bench drive`.

use std::path::Path;

use btu_rig::drive::DrivePlan;
use btu_rig::train::TrainData;
use divan::Bencher;
use protocol::config::ControllerKind;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::drive::{DriveBench, Setting, drive, unit_config};

fn main() {
    divan::main();
}

/// A run from power-up of the unit to standstill; the tester listens, or not.
fn run(bencher: Bencher<'_, '_>, controller: ControllerKind, train: TrainData, tester: bool) {
    let scripts = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../scripts"));
    let directory = ScriptsDirectory::find(Some(scripts)).expect("scripts");
    let settings = vec![Setting::new("ato.controller", controller.name())];
    let bench = DriveBench {
        config: unit_config(&directory, "sg100", &settings).expect("unit configuration"),
        line: directory.line("line8").expect("line"),
        settings,
    };
    let (config, line) = (&bench.config.content, &bench.line.content);
    let nominal = DrivePlan::new(config, line, train, 61, None).expect("plan");
    let plan = DrivePlan { tester, ..nominal };
    bencher.bench_local(|| drive(&bench, plan.clone(), 1));
}

/// Section 61 with the train of eight cars, as a single run does it.
#[divan::bench(args = ControllerKind::ALL, sample_count = 30)]
fn eight_cars(bencher: Bencher<'_, '_>, controller: ControllerKind) {
    run(bencher, controller, TrainData::line6(), true);
}

/// Eight cars with a silent tester, as a Monte Carlo drives them.
#[divan::bench(args = ControllerKind::ALL, sample_count = 30)]
fn eight_cars_tester_silent(bencher: Bencher<'_, '_>, controller: ControllerKind) {
    run(bencher, controller, TrainData::line6(), false);
}
