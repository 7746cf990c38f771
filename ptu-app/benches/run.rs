//! Speed of a bench: `cargo bench -p ptu-app`.
//!
//! Items per second of `acceptance_suite` are seconds of bench time per second of wall time, loading
//! of scripts and all SQLite commits included; items of `short_steps` are persisted steps.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use btu_rig::procedure::loader::load;
use divan::Bencher;
use divan::counter::ItemsCount;
use fault_db::Store;
use ptu_runs::clock;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::run::{self, BenchChoice, BenchSetup, Outcome, RunPlan};
use ptu_runs::stop::Stop;

const STEPS: usize = 5000;

fn main() {
    divan::main();
}

fn setup() -> (ScriptsDirectory, BenchSetup) {
    let scripts = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../scripts"));
    let directory = ScriptsDirectory::find(Some(scripts)).expect("scripts");
    let setup = BenchChoice::default().setup(&directory).expect("a bench");
    (directory, setup)
}

/// Loads, runs and records `texts` in a new database under `folder`.
fn run(texts: &BTreeMap<String, String>, setup: &BenchSetup, folder: &Path) -> Outcome {
    let loaded = load(
        texts,
        &setup.config.content,
        &setup.line.content,
        &setup.train,
    );
    assert!(loaded.errors.is_empty(), "{:?}", loaded.errors);
    let mut procedures = loaded.procedures;
    procedures.retain(|procedure| !procedure.on_request);
    let mut plan = RunPlan::of(procedures);
    let store = Store::open(&folder.join("history.db"), clock::open_options()).expect("store");
    let stop = Stop::default();
    let (store, outcome) = run::run(&mut plan, setup.clone(), store, &stop, &mut ()).expect("run");
    store.close().expect("close");
    outcome
}

#[divan::bench(sample_count = 20)]
fn acceptance_suite(bencher: Bencher<'_, '_>) {
    let (directory, setup) = setup();
    let texts = directory.procedures().expect("procedures");
    let folder = tempfile::tempdir().expect("folder");
    let bench_seconds = run(&texts, &setup, folder.path()).bench_time.as_secs();
    bencher
        .counter(ItemsCount::new(bench_seconds as usize))
        .bench_local(|| run(&texts, &setup, folder.path()));
}

#[divan::bench(sample_count = 20)]
fn short_steps(bencher: Bencher<'_, '_>) {
    let (_, setup) = setup();
    let script = format!(
        "procedure(title = \"Short steps\")\nfor i in range({STEPS}):\n    step(\"step %d\" % i, expect = never(speed, above = kmh(300)))\n"
    );
    let texts = BTreeMap::from([("short.star".to_owned(), script)]);
    let folder = tempfile::tempdir().expect("folder");
    bencher
        .counter(ItemsCount::new(STEPS))
        .bench_local(|| run(&texts, &setup, folder.path()));
}

/// From process start to the printed list of a small history.
#[divan::bench(sample_count = 50)]
fn faults_list_process(bencher: Bencher<'_, '_>) {
    let (directory, mut setup) = setup();
    setup.faults = directory
        .chosen_faults(&["eb_relay.slow".to_owned()])
        .expect("fault");
    let texts = directory.procedures().expect("procedures");
    let folder = tempfile::tempdir().expect("folder");
    run(&texts, &setup, folder.path());
    let db = folder.path().join("history.db");
    bencher.bench_local(|| {
        let output = Command::new(env!("CARGO_BIN_EXE_ptu"))
            .args(["faults", "list", "--db"])
            .arg(&db)
            .output()
            .expect("ptu");
        assert!(output.status.success());
        output.stdout
    });
}
