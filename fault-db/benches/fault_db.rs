//! Time to record a fault: `cargo bench -p fault-db --bench fault_db`; traces are in `traces.rs`.
//!
//! Times of commits depend on the disk under the system's temporary directory.

#[path = "../tests/common/mod.rs"]
mod common;

use common::{T0_US, fault, ids, run_record};
use divan::Bencher;
use fault_db::{OpenOptions, RunWriter, Store, Synchronous};
use tempfile::TempDir;

fn main() {
    divan::main();
}

/// One fault with its freeze frame, on the disk.
#[divan::bench(sample_count = 50, sample_size = 1)]
fn fault_committed(bencher: Bencher) {
    let dir = TempDir::new().expect("a temporary directory");
    let options = OpenOptions::new(ids(1)).synchronous(Synchronous::Full);
    let store = Store::open(&dir.path().join("bench.db"), options).expect("opens");
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    bencher.bench_local(|| writer.fault(&fault(1, T0_US)).expect("committed"));
}
