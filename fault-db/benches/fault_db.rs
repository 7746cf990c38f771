//! What recording and reading cost: `cargo bench -p fault-db`; traces are in `traces.rs`.
//!
//! Times of commits depend on the disk under the system's temporary directory.

#[path = "../tests/common/mod.rs"]
mod common;

use common::{T0_US, end, fault, ids, open, run_record, step};
use divan::Bencher;
use divan::counter::ItemsCount;
use fault_db::{FaultFilter, OpenOptions, RunWriter, Store, StoreError, Synchronous, Verdict};
use tempfile::TempDir;

const STEPS: u32 = 1_000;

fn main() {
    divan::main();
}

fn store_at(dir: &TempDir, synchronous: Synchronous) -> Result<Store, StoreError> {
    let options = OpenOptions::new(ids(1)).synchronous(synchronous);
    Store::open(&dir.path().join("bench.db"), options)
}

fn directory() -> TempDir {
    TempDir::new().expect("a temporary directory")
}

/// A run of a thousand empty steps with every commit on the disk; per step.
#[divan::bench(sample_count = 30, sample_size = 1)]
fn empty_step_persisted(bencher: Bencher) {
    let dir = directory();
    let store = store_at(&dir, Synchronous::Full).expect("opens");
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| {
        let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
        for index in 0..STEPS {
            writer.step(step(index)).expect("kept");
        }
        writer.finish(&end(Verdict::Passed)).expect("finished");
    });
}

/// One fault with its freeze frame, on the disk.
#[divan::bench(sample_count = 50, sample_size = 1)]
fn fault_committed(bencher: Bencher) {
    let dir = directory();
    let store = store_at(&dir, Synchronous::Full).expect("opens");
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    bencher.bench_local(|| writer.fault(&fault(1, T0_US)).expect("committed"));
}

/// Open, list, close: what a command does, but for the process itself.
#[divan::bench]
fn open_and_list_200_faults(bencher: Bencher) {
    let dir = directory();
    let path = dir.path().join("bench.db");
    let store = open(&path);
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    for code in 0..200 {
        writer.fault(&fault(code, T0_US + code)).expect("stored");
    }
    drop(writer);
    store.close().expect("closed");
    bencher.bench_local(|| {
        let store = Store::open_read_only(&path).expect("opens");
        store.faults(&FaultFilter::default()).expect("listed").len()
    });
}
