//! Brings 10 000 runs with their traces to a private server on the loopback, then again, and says how
//! long that took: `cargo bench -p fault-db --bench sync`. `PTU_BENCH_RUNS` asks for another number,
//! `PTU_BENCH_FILE` for the history in a file, which then remembers the sync.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "what a benchmark or an example is for"
)]

#[path = "../tests/common/mod.rs"]
mod common;
#[path = "../tests/server/private.rs"]
#[allow(dead_code)] // tests use the rest of it
mod private;

use std::path::{Path, PathBuf};
use std::time::Instant;

use fault_db::{
    Address, OpenOptions, RunWriter, Store, StoreError, SyncOptions, SyncOutcome, Synchronous,
    Verdict,
};

const RUNS: u32 = 10_000;
const STEPS: u32 = 30;
const TRACE_ROWS: usize = 300;
/// Runs written in one commit.
const TOGETHER: u32 = 250;

fn main() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = match std::env::var_os("PTU_BENCH_FILE") {
        Some(file) => file.into(),
        None => made(folder.path()),
    };
    let cluster = private::Cluster::start(&[]);
    let address = cluster.database();
    for what in ["first sync", "again, nothing new"] {
        let begun = Instant::now();
        let outcome = sync(&path, &address).expect("a sync");
        println!(
            "{what:20} {:6.1} s  {} runs, {} events, {} traces, {:.0} MB on the wire; greatest memory {} MiB",
            begun.elapsed().as_secs_f64(),
            outcome.runs,
            outcome.events,
            outcome.traces,
            outcome.bytes as f64 / 1e6,
            greatest_memory_mib(),
        );
    }
}

/// A file of runs that all have the same size.
fn made(folder: &Path) -> PathBuf {
    let runs = std::env::var("PTU_BENCH_RUNS")
        .ok()
        .and_then(|runs| runs.parse().ok());
    let runs = runs.unwrap_or(RUNS);
    let path = folder.join("history.db");
    let begun = Instant::now();
    write(&path, runs).expect("a history");
    println!(
        "{runs} runs of {STEPS} steps, each with a fault and a trace of {TRACE_ROWS} x 40 samples: {:.0} MB, written in {:.1} s",
        std::fs::metadata(&path).expect("a file").len() as f64 / 1e6,
        begun.elapsed().as_secs_f64()
    );
    path
}

fn write(path: &Path, runs: u32) -> Result<(), StoreError> {
    let options = OpenOptions::new(common::ids(1)).synchronous(Synchronous::Normal);
    let store = Store::open(path, options)?;
    let traces: Vec<_> = (0..20)
        .map(|seed| common::realistic_trace(TRACE_ROWS, seed))
        .collect();
    for first in (0..runs).step_by(TOGETHER as usize) {
        store.transaction(|| {
            (first..runs.min(first + TOGETHER)).try_for_each(|run| one(&store, run, &traces))
        })?;
    }
    store.close()
}

fn one(store: &Store, number: u32, traces: &[fault_db::TraceData]) -> Result<(), StoreError> {
    let at_us = common::T0_US + i64::from(number) * 3_600_000_000;
    let mut record = common::run_record(&format!("U-{}", number % 150));
    record.started_at_us = at_us;
    let mut run = RunWriter::begin(store, &record)?;
    for index in 0..STEPS {
        let mut step = common::step(index);
        if index % 3 == 0 {
            step.measurements
                .push(common::measurement("eb_reaction", 0.42));
        }
        run.step(step)?;
    }
    let stored = run.fault(&common::fault(i64::from(number % 40), at_us))?;
    run.trace(
        &[stored.occurrence],
        &traces[number as usize % traces.len()],
    )?;
    run.finish(&common::end(Verdict::Failed))
}

fn sync(path: &Path, address: &str) -> Result<SyncOutcome, StoreError> {
    let address: Address = address.parse()?;
    let server = Store::connect(&address, common::ids(7))?;
    let store = Store::open(path, OpenOptions::new(common::ids(8)))?;
    let mut options = SyncOptions {
        laptop: "bench",
        traces: true,
        as_copy: false,
        now_us: &|| common::T0_US,
        go_on: &mut |_| true,
    };
    store.sync(&server, &mut options)
}

/// The most memory this program ever had, the making of the history included.
fn greatest_memory_mib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM"));
    let kib = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<u64>().ok());
    kib.unwrap_or_default() / 1024
}
