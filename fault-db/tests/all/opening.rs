//! Files that are not what they should be: named, with the next move, and left as they were. `bad_databases` among the
//! program's sessions has what is no history at all.

use std::path::Path;

use crate::common::{
    Deeds, T0_US, end, failed_run, fault, ids, open, problems, refused, run_record,
};
use fault_db::{FaultFilter, OpenOptions, RunFilter, RunWriter, Store, StoreError, Verdict};
use rusqlite::Connection;
use tempfile::tempdir;

#[test]
fn a_file_locked_by_another_is_named_so() {
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("a.db");
    let options = OpenOptions::new(ids(1)).busy_timeout_ms(20);
    let store = Store::open(&path, options).expect("opens");
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    let other = Connection::open(&path).expect("opens");
    other.execute_batch("BEGIN EXCLUSIVE").expect("locked");
    let locked_out = writer.fault(&fault(1, T0_US));
    refused!(
        locked_out,
        StoreError::Locked(_),
        "a.db is locked by another program"
    );
    let read = store.runs(&RunFilter::default());
    assert_eq!(read.expect("reading goes on").len(), 1);
    other.execute_batch("ROLLBACK").expect("released");
    writer.fault(&fault(1, T0_US)).expect("goes on");
    writer.finish(&end(Verdict::Passed)).expect("finished");
}

/// Goal: work under way may wait longer for another writer than opening did.
#[test]
fn the_busy_timeout_of_an_open_store_can_be_changed() {
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("a.db");
    let options = OpenOptions::new(ids(1)).busy_timeout_ms(1);
    let store = Store::open(&path, options).expect("opens");
    let mut writer = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    store.set_busy_timeout_ms(30_000).expect("set");
    let other = Connection::open(&path).expect("opens");
    other.execute_batch("BEGIN EXCLUSIVE").expect("locked");
    std::thread::scope(|scope| {
        scope.spawn(move || {
            std::thread::sleep(std::time::Duration::from_millis(300));
            other.execute_batch("ROLLBACK").expect("released");
        });
        writer.fault(&fault(1, T0_US)).expect("in the end");
    });
    writer.finish(&end(Verdict::Passed)).expect("finished");
}

/// Method: tests may run as root, whom permissions do not stop; an immutable attribute or a
/// read-only mount is not to be had everywhere. What is left is a reader's own connection.
#[test]
fn reading_never_writes() {
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("a b?#.db");
    let writer = open(&path);
    RunWriter::begin(&writer, &run_record("ATC-7")).expect("begun");
    writer.close().expect("closed");
    let before = std::fs::read(&path).expect("there");
    let store = Store::open_read_only(&path).expect("opens");
    assert!(store.is_read_only());
    assert_eq!(store.runs(&RunFilter::default()).expect("listed").len(), 1);
    assert_eq!(store.faults(&FaultFilter::default()).expect("listed"), []);
    let begun = RunWriter::begin(&store, &run_record("ATC-7"));
    refused!(begun, StoreError::ReadOnly(_));
    assert_eq!(std::fs::read(&path).expect("there"), before);
}

/// A file with enough in it to be cut and scratched.
fn full_file(path: &Path) -> Vec<u8> {
    let store = open(path);
    let faults: Vec<_> = (0..50).map(|code| fault(code, T0_US)).collect();
    failed_run(&store, &run_record("ATC-7"), &[], &faults);
    store.close().expect("closed");
    std::fs::read(path).expect("there")
}

/// Goal: a copy that broke off is refused by name, also for writing and as the source of an import, and
/// nothing is written to it.
#[test]
fn a_half_copied_file_is_named_and_left_as_it_is() {
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("half.db");
    let bytes = full_file(&path);
    let ours = open(&dir.path().join("ours.db"));
    for part in [2, 3, 10] {
        let half = &bytes[..bytes.len() / part];
        std::fs::write(&path, half).expect("cut");
        let opened = Store::open(&path, OpenOptions::new(ids(1)));
        let read = Store::open_read_only(&path);
        for tried in [
            opened.map(drop),
            read.map(drop),
            ours.import(&path).map(drop),
        ] {
            refused!(tried, StoreError::Malformed(_), "half.db", "db check");
        }
        assert_eq!(std::fs::read(&path).expect("there"), half, "1/{part}");
    }
    assert_eq!(ours.runs(&RunFilter::default()).expect("listed"), []);
}

/// Goal: a file with a stretch of garbage in it never passes for whole, wherever that is, and neither a
/// check nor a refused import writes to it.
#[test]
fn garbage_in_the_middle_is_found() {
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("scratched.db");
    let bytes = full_file(&path);
    let pages = bytes.len() / 4096;
    let mut refused = 0;
    for page in (1..pages).step_by(3) {
        let mut scratched = bytes.clone();
        scratched[page * 4096..][..4096].fill(0xA5);
        std::fs::write(&path, &scratched).expect("written");
        let found = Store::open_read_only(&path)
            .and_then(|store| store.check())
            .map(|report| report.problems.len());
        assert!(!matches!(found, Ok(0)), "page {page} passed for whole");
        // A merge may not need that page; if it does, all or nothing, and the right file is named.
        let ours = open(&dir.path().join(format!("ours{page}.db")));
        if let Err(error) = ours.import(&path) {
            refused += 1;
            assert!(error.to_string().contains("scratched.db"), "{error}");
            let runs = ours.runs(&RunFilter::default());
            assert_eq!(runs.expect("listed"), []);
        }
        let left = std::fs::read(&path).expect("there");
        assert_eq!(left, scratched, "page {page}");
    }
    assert!(refused > 3, "{refused}");
}

/// Goal: the database file copied alone, while a program had it open, is as it was when its log was last
/// written back: whole, or refused, never something in between.
#[test]
fn a_file_without_its_write_ahead_log_is_an_earlier_state_or_unreadable() {
    let dir = tempdir().expect("a directory");
    let path = dir.path().join("a.db");
    full_file(&path);
    let store = Store::open(&path, OpenOptions::new(ids(2))).expect("opens");
    for code in 100..104 {
        failed_run(&store, &run_record("ATC-8"), &[], &[fault(code, T0_US)]);
    }
    let alone = dir.path().join("alone.db");
    std::fs::copy(&path, &alone).expect("copied");
    let copy = Store::open_read_only(&alone).expect("opens");
    assert_eq!(problems(&copy), []);
    let runs = copy.runs(&RunFilter::default()).expect("listed");
    assert_eq!(runs.len(), 1, "what was in the log is not there");
}

/// Goal: whoever writes is told that others do not find what was written, and an older log does not go over the file that they
/// find. Method: the file is replaced, or gets a second name, between a write and the closing.
#[test]
#[cfg(unix)]
fn a_file_that_is_another_one_when_it_is_closed_is_told() {
    type Deed = fn(&Path);
    let deeds: [Deed; 3] = [
        |file| {
            std::fs::copy(file.with_extension("old"), file.with_extension("new")).expect("copied");
            std::fs::rename(file.with_extension("new"), file).expect("replaced");
        },
        |file| std::fs::hard_link(file, file.with_extension("second")).expect("linked"),
        |file| std::fs::remove_file(file).expect("removed"),
    ];
    for deed in deeds {
        let dir = tempdir().expect("a directory");
        let path = dir.path().join("a.db");
        full_file(&path);
        let old = path.with_extension("old");
        std::fs::copy(&path, &old).expect("copied");
        let store = Store::open(&path, OpenOptions::new(ids(2))).expect("opens");
        let run = store.runs(&RunFilter::default()).expect("listed")[0].id;
        store.put_run_note(run, "Lee", "seen", T0_US);
        deed(&path);
        refused!(store.close(), StoreError::FileChanged { .. });
    }
}
