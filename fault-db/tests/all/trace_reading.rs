//! Parts of traces out of a file: the right rows, nothing but what is needed, and damage by its name.

use crate::common::{open, problems, realistic_trace, refused, run_record, tells};
use fault_db::{Id, RunWriter, Store, StoreError, TraceData, TraceError};
use rusqlite::Connection;
use tempfile::TempDir;

/// A file with one trace in it.
struct Kept {
    directory: TempDir,
    store: Store,
    id: Id,
}

impl Kept {
    fn new(trace: &TraceData) -> Self {
        let directory = TempDir::new().expect("a directory");
        let store = open(&directory.path().join("h.db"));
        let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
        let id = writer.trace(&[], trace).expect("stored");
        drop(writer);
        Self {
            directory,
            store,
            id,
        }
    }

    fn bytes(&self) -> Vec<u8> {
        self.other()
            .query_row("SELECT data FROM trace", [], |row| row.get(0))
            .expect("there")
    }

    fn put(&self, bytes: &[u8]) {
        let changed = self.other().execute("UPDATE trace SET data = ?1", [bytes]);
        assert_eq!(changed.expect("changed"), 1);
    }

    fn other(&self) -> Connection {
        Connection::open(self.directory.path().join("h.db")).expect("opened")
    }
}

#[test]
fn a_window_has_its_rows_its_times_and_its_trigger() {
    // Short: fetched whole. Long: 40 000 rows are over the size from which parts are fetched.
    for rows in [600, 40_000] {
        let trace = realistic_trace(rows, 2);
        let kept = Kept::new(&trace);
        let trigger = rows / 3;
        let (from, to) = (trigger - 10, trigger + 20);
        let window = kept
            .store
            .trace_window(kept.id, &["enum_2", "speed"], from..to)
            .expect("read");
        assert_eq!(window.rows(), 30);
        let names: Vec<_> = window.channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["enum_2", "speed"]);
        for name in names {
            let whole = trace.column(name).expect("there");
            assert_eq!(window.column(name), Some(&whole[from..to]), "{name}");
        }
        assert_eq!(window.trigger_row, Some(10));
        let later_us = from as i64 * 50_000;
        assert_eq!(window.t0_us, trace.t0_us + later_us);
        assert_eq!(window.t0_bench_us, trace.t0_bench_us + later_us);

        let all = kept.store.trace_window(kept.id, &[], rows - 5..rows + 99);
        let all = all.expect("clipped to what there is");
        assert_eq!((all.rows(), all.channels.len()), (5, 40));
        assert_eq!(all.trigger_row, None, "not among these rows");
        let none = kept.store.trace_window(kept.id, &["speed"], rows..rows + 1);
        assert_eq!(none.expect("empty").rows(), 0);
    }
}

#[test]
fn a_trace_head_describes_the_trace() {
    let trace = realistic_trace(600, 2);
    let kept = Kept::new(&trace);
    let head = kept.store.trace_head(kept.id).expect("read");
    assert_eq!((head.unit_serial.as_str(), head.rows), ("ATC-7", 600));
    assert_eq!(head.channels, trace.channels);
    assert_eq!(head.trigger_row, Some(200));
    let other = Id::from_bytes([7; 16]);
    assert!(matches!(
        kept.store.trace_head(other),
        Err(StoreError::NotFound { .. })
    ));
}

/// Goal: no work for other channels, so no stumbling over their damage either; and damage by its name.
/// Method: of a trace that is fetched in parts the last byte is changed, which is the last channel's.
#[test]
fn damage_in_one_channel_leaves_the_others_readable() {
    for rows in [600, 40_000] {
        let trace = realistic_trace(rows, 4);
        let kept = Kept::new(&trace);
        let mut bytes = kept.bytes();
        *bytes.last_mut().expect("not empty") ^= 0x10;
        kept.put(&bytes);
        let speed = kept.store.trace_channels(kept.id, &["speed"]);
        let speed = speed.expect("whole");
        assert_eq!(speed.column("speed"), trace.column("speed"), "{rows} rows");
        let damaged = kept.store.trace_channels(kept.id, &["bit_19"]);
        refused!(damaged, _, "bit_19", "checksum");
        refused!(kept.store.trace(kept.id), _, "bit_19");
        let mut found = problems(&kept.store);
        found.retain(|problem| problem.kind.as_str() == "trace");
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(tells(&found[0], &kept.id.to_string()));
    }
}

#[test]
fn a_blob_that_is_cut_or_of_another_trace_is_refused() {
    for rows in [600, 40_000] {
        let trace = realistic_trace(rows, 4);
        let kept = Kept::new(&trace);
        let bytes = kept.bytes();
        for length in [0, 1, 20, 1000, bytes.len() - 1] {
            kept.put(&bytes[..length]);
            for found in [
                kept.store.trace(kept.id),
                kept.store.trace_window(kept.id, &["speed"], 0..10),
            ] {
                let StoreError::Trace { source, .. } = found.expect_err("cut") else {
                    panic!("{rows} rows, {length} bytes");
                };
                assert!(matches!(source, TraceError::Blob { .. }), "{source}");
            }
        }
        // Whole in itself, but not what this row's checksum is of.
        let other = realistic_trace(rows, 5);
        let other = Kept::new(&other).bytes();
        kept.put(&other);
        let StoreError::Trace { source, .. } = kept.store.trace(kept.id).expect_err("another")
        else {
            panic!("{rows} rows");
        };
        assert_eq!(source, TraceError::Checksum);
    }
}
