//! Time of a trace, all cases in one run so that they compare: `cargo bench -p fault-db --bench traces`.
//!
//! 600 rows of 40 channels, 24 000 samples of realistic signals; an hour has 72 000 rows of them. Times
//! of commits depend on the disk under the system's temporary directory.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "what a benchmark or an example is for"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{T0_US, ids, realistic_trace, run_record};
use divan::Bencher;
use divan::counter::ItemsCount;
use fault_db::trace::TraceCodec;
use fault_db::{Id, OpenOptions, RunWriter, Store, Synchronous, TraceData};
use rusqlite::{Connection, params};
use tempfile::TempDir;

const ROWS: usize = 600;
const CHANNELS: usize = 40;
const HOUR_ROWS: usize = 72_000;
const SAMPLES: usize = ROWS * CHANNELS;

fn main() {
    divan::main();
}

/// A directory that goes when the bench is over, and a store in it.
fn store() -> (TempDir, Store) {
    let directory = TempDir::new().expect("a temporary directory");
    let options = OpenOptions::new(ids(1)).synchronous(Synchronous::Normal);
    let store = Store::open(&directory.path().join("bench.db"), options).expect("opens");
    (directory, store)
}

/// A file as a store would open it, with a table of one's own.
fn plain_file(table: &str) -> (TempDir, Connection) {
    let directory = TempDir::new().expect("a temporary directory");
    let conn = Connection::open(directory.path().join("plain.db")).expect("opens");
    conn.execute_batch(
        "PRAGMA auto_vacuum=INCREMENTAL; PRAGMA journal_mode=WAL; PRAGMA synchronous=NORMAL;",
    )
    .expect("set up");
    conn.execute_batch(table).expect("created");
    (directory, conn)
}

fn packed() -> Vec<u8> {
    let trace = realistic_trace(ROWS, 1);
    let mut codec = TraceCodec::new().expect("a codec");
    codec.encode(&trace).expect("encodable")
}

mod write {
    use super::*;

    #[divan::bench]
    fn encode(bencher: Bencher) {
        let trace = realistic_trace(ROWS, 1);
        let mut codec = TraceCodec::new().expect("a codec");
        let bytes = codec.encode(&trace).expect("encodable").len();
        let per_sample = bytes as f64 / SAMPLES as f64;
        println!("trace: {bytes} bytes, {per_sample:.4} per sample");
        bencher
            .counter(ItemsCount::new(SAMPLES))
            .bench_local(|| codec.encode(&trace));
    }

    #[divan::bench(sample_count = 1000, sample_size = 1)]
    fn encode_and_insert(bencher: Bencher) {
        let (_directory, store) = store();
        let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
        let trace = realistic_trace(ROWS, 1);
        bencher
            .counter(ItemsCount::new(SAMPLES))
            .bench_local(|| writer.trace(&[], &trace).expect("stored"));
    }

    /// Baseline: the same bytes in a table that has nothing else, one commit each.
    #[divan::bench(sample_count = 1000, sample_size = 1)]
    fn same_bytes_as_a_plain_blob(bencher: Bencher) {
        let (_directory, conn) =
            plain_file("CREATE TABLE plain(id INTEGER PRIMARY KEY, data BLOB)");
        let packed = packed();
        bencher.counter(ItemsCount::new(SAMPLES)).bench_local(|| {
            conn.prepare_cached("INSERT INTO plain(data) VALUES (?1)")
                .and_then(|mut insert| insert.execute([&packed]))
                .expect("stored")
        });
    }

    /// Baseline: the same bytes in a table that is found by the four keys of traces.
    #[divan::bench(sample_count = 1000, sample_size = 1)]
    fn same_bytes_with_the_same_keys(bencher: Bencher) {
        let (_directory, conn) = plain_file(
            "CREATE TABLE plain(seq INTEGER PRIMARY KEY, id BLOB NOT NULL UNIQUE, run INTEGER,
                t0_us INTEGER, data BLOB);
             CREATE INDEX plain_by_run ON plain(run);
             CREATE INDEX plain_by_time ON plain(t0_us);
             CREATE INDEX plain_by_end ON plain(substr(id, 13));",
        );
        let packed = packed();
        let mut next = 0u128;
        bencher.counter(ItemsCount::new(SAMPLES)).bench_local(|| {
            next += 1;
            // The last bytes of an id are random.
            let id =
                (next << 64 | next.wrapping_mul(0x9E37_79B9_7F4A_7C15) & 0xFFFF_FFFF).to_be_bytes();
            conn.prepare_cached("INSERT INTO plain(id, run, t0_us, data) VALUES (?1, ?2, ?3, ?4)")
                .and_then(|mut insert| insert.execute(params![id, 1, T0_US, packed]))
                .expect("stored")
        });
    }

    /// One row a sample, found by trace, channel and time; all of a trace in one commit.
    #[divan::bench(sample_count = 20, sample_size = 1)]
    fn one_row_per_sample(bencher: Bencher) {
        let (_directory, conn) = plain_file(
            "CREATE TABLE sample(trace INTEGER, channel INTEGER, at_us INTEGER, value REAL,
                UNIQUE(trace, channel, at_us))",
        );
        let mut number = 0;
        let trace = realistic_trace(ROWS, 1);
        bencher.counter(ItemsCount::new(SAMPLES)).bench_local(|| {
            number += 1;
            let commit = conn.unchecked_transaction().expect("begun");
            let mut insert = commit
                .prepare_cached("INSERT INTO sample VALUES (?1, ?2, ?3, ?4)")
                .expect("prepared");
            for row in 0..ROWS {
                let at_us = T0_US + row as i64 * trace.period_us;
                for (channel, column) in trace.columns.iter().enumerate() {
                    let values = params![number, channel, at_us, column[row]];
                    insert.execute(values).expect("stored");
                }
            }
            drop(insert);
            commit.commit().expect("committed");
        });
    }
}

mod read {
    use super::*;

    fn kept(trace: &TraceData) -> (TempDir, Store, Id) {
        let (directory, store) = store();
        let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
        let id = writer.trace(&[], trace).expect("stored");
        drop(writer);
        (directory, store, id)
    }

    #[divan::bench]
    fn one_channel(bencher: Bencher) {
        let (_directory, store, id) = kept(&realistic_trace(ROWS, 1));
        bencher.bench_local(|| store.trace_channels(id, &["speed"]).expect("readable"));
    }

    #[divan::bench]
    fn one_channels_window(bencher: Bencher) {
        let (_directory, store, id) = kept(&realistic_trace(ROWS, 1));
        bencher.bench_local(|| {
            store
                .trace_window(id, &["speed"], 200..300)
                .expect("readable")
        });
    }

    #[divan::bench]
    fn whole(bencher: Bencher) {
        let (_directory, store, id) = kept(&realistic_trace(ROWS, 1));
        bencher.bench_local(|| store.trace(id).expect("readable"));
    }

    #[divan::bench]
    fn hour_one_channel(bencher: Bencher) {
        let (_directory, store, id) = kept(&realistic_trace(HOUR_ROWS, 1));
        bencher.bench_local(|| store.trace_channels(id, &["speed"]).expect("readable"));
    }

    #[divan::bench]
    fn hour_one_channels_window(bencher: Bencher) {
        let (_directory, store, id) = kept(&realistic_trace(HOUR_ROWS, 1));
        bencher.bench_local(|| {
            store
                .trace_window(id, &["speed"], 50_000..50_100)
                .expect("readable")
        });
    }

    #[divan::bench(sample_count = 20, sample_size = 1)]
    fn hour_whole(bencher: Bencher) {
        let (_directory, store, id) = kept(&realistic_trace(HOUR_ROWS, 1));
        bencher.bench_local(|| store.trace(id).expect("readable"));
    }
}
