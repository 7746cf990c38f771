//! Files of earlier schemas: copied, then brought up to date with all that is in them.

mod common;

use std::path::Path;

use common::{T0_US, open};
use fault_db::{RunFilter, SCHEMA_VERSION, Store, StoreError};
use rusqlite::Connection;
use tempfile::tempdir;

/// What each schema added to the one before.
const STEPS: [&str; 2] = [
    include_str!("../src/schema/0001.sql"),
    include_str!("../src/schema/0002.sql"),
];

/// A file of an earlier schema with a run in it.
fn old_file(path: &Path, version: usize) {
    let conn = Connection::open(path).expect("made");
    let steps = STEPS[..version].concat();
    conn.execute_batch(&format!(
        "{steps}
         PRAGMA user_version = {version};
         INSERT INTO unit VALUES (1, 'ATC-1', 'atc', 'sg100', '{{}}');
         INSERT INTO run VALUES (1, x'0198c0de00007000800000000000cafe', 1, 'line8', 1, '',
            'sim', 1, 2, 'passed', 1, 1, '0.1.0', '', '', NULL, '')"
    ))
    .expect("an old file");
}

/// Schema and number of runs, read without this crate.
fn looked_at(path: &Path) -> (usize, usize) {
    let conn = Connection::open(path).expect("opens");
    let one = |sql: &str| conn.query_row(sql, [], |row| row.get(0)).expect("readable");
    (one("PRAGMA user_version"), one("SELECT count(*) FROM run"))
}

fn runs(store: &Store) -> Vec<fault_db::RunSummary> {
    let all = RunFilter::default();
    store.runs(&all, &|_| false).expect("read")
}

#[test]
fn a_file_of_each_older_schema_is_copied_before_it_is_brought_up_to_date() {
    assert_eq!(
        STEPS.len() + 1,
        SCHEMA_VERSION as usize,
        "each has its file"
    );
    for version in 1..=STEPS.len() {
        let dir = tempdir().expect("a directory");
        let path = dir.path().join("a.db");
        let copy = dir.path().join(format!("a.db.schema{version}"));
        let again = dir.path().join(format!("a.db.schema{version}.2"));
        old_file(&path, version);
        let error = Store::open_read_only(&path).expect_err("reading brings nothing up to date");
        assert!(matches!(error, StoreError::OlderSchema { .. }), "{error}");
        let store = open(&path);
        let [run] = &runs(&store)[..] else {
            panic!("schema {version}: the run is lost");
        };
        store
            .add_run_note(run.id, "kim", "door 3 rattles", T0_US)
            .expect("noted");
        let detail = store.run(run.id, &|_| false).expect("read");
        assert_eq!(detail.notes.len(), 1);
        assert_eq!(store.check().expect("checked").problems, []);
        assert_eq!(looked_at(&copy), (version, 1));
        store.close().expect("closed");
        assert_eq!(looked_at(&path), (SCHEMA_VERSION as usize, 1));
        open(&path);
        assert!(!again.exists(), "nothing old, no copy");
        // The old file laid back, after more work with it: the first copy stays as it is.
        std::fs::remove_file(&path).expect("gone");
        old_file(&path, version);
        open(&path);
        assert_eq!(looked_at(&again), (version, 1));
        assert_eq!(looked_at(&copy), (version, 1));
    }
}
