//! What recording and reading cost: `cargo bench -p fault-db`.
//!
//! Times of commits depend on the disk under the system's temporary directory.

#[path = "../tests/common/mod.rs"]
mod common;

use common::{T0_US, end, fault, ids, open, realistic_trace, run_record, step};
use divan::Bencher;
use divan::counter::ItemsCount;
use fault_db::trace::TraceCodec;
use fault_db::{
    FaultFilter, Id, OpenOptions, RunWriter, Store, StoreError, Synchronous, TraceData, Verdict,
};
use tempfile::TempDir;

const ROWS: usize = 600;
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

#[divan::bench]
fn trace_encode(bencher: Bencher) {
    let trace = realistic_trace(ROWS, 1);
    let mut codec = TraceCodec::new().expect("a codec");
    let bytes = codec.encode(&trace).expect("encodable").len();
    let samples = ROWS * trace.channels.len();
    println!(
        "trace: {bytes} bytes, {:.3} per sample",
        bytes as f64 / samples as f64
    );
    bencher.bench_local(|| codec.encode(&trace));
}

#[divan::bench(sample_count = 300, sample_size = 1)]
fn trace_encode_and_insert_at_normal(bencher: Bencher) {
    let dir = directory();
    let store = store_at(&dir, Synchronous::Normal).expect("opens");
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    let trace = realistic_trace(ROWS, 1);
    bencher.bench_local(|| writer.trace(&[], &trace).expect("stored"));
}

fn with_trace(trace: &TraceData) -> (TempDir, Store, Id) {
    let dir = directory();
    let store = store_at(&dir, Synchronous::Normal).expect("opens");
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    let id = writer.trace(&[], trace).expect("stored");
    drop(writer);
    (dir, store, id)
}

#[divan::bench]
fn trace_read_one_channel(bencher: Bencher) {
    let (_dir, store, id) = with_trace(&realistic_trace(ROWS, 1));
    bencher.bench_local(|| store.trace_channels(id, &["speed"]).expect("readable"));
}

#[divan::bench]
fn trace_read_whole(bencher: Bencher) {
    let (_dir, store, id) = with_trace(&realistic_trace(ROWS, 1));
    bencher.bench_local(|| store.trace(id).expect("readable"));
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
