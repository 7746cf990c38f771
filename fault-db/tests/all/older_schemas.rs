//! Files of earlier schemas: copied, then brought up to date with all that is in them.

use std::path::Path;

use crate::common::{T0_US, ids, open};
use fault_db::{FaultState, OpenOptions, RunFilter, SCHEMA_VERSION, Store, StoreError};
use rusqlite::Connection;
use tempfile::tempdir;

/// What each schema added to the one before, as far as SQL alone does it.
const STEPS: [&str; 3] = [
    include_str!("../../src/schema/0001.sql"),
    include_str!("../../src/schema/0002.sql"),
    include_str!("../../src/schema/0003.sql"),
];

/// A file that a program of the fourth schema wrote: four runs with a fault each, one of them with a trace
/// and its recording, a repair, an acknowledgement and a note.
const FOURTH: &[u8] = include_bytes!("../data/schema4.db.zst");

/// The same file, as a program of the fifth schema brought it up to date.
const FIFTH: &[u8] = include_bytes!("../data/schema5.db.zst");

/// The same, brought up to date by the sixth.
const SIXTH: &[u8] = include_bytes!("../data/schema6.db.zst");

/// The same, brought up to date by the seventh.
const SEVENTH: &[u8] = include_bytes!("../data/schema7.db.zst");

const OLDEST_TO_LAST: std::ops::RangeInclusive<usize> = 1..=STEPS.len() + 4;

/// A file of an earlier schema with runs in it; how many.
fn old_file(path: &Path, version: usize) -> usize {
    if version > STEPS.len() {
        let packed = [FOURTH, FIFTH, SIXTH, SEVENTH][version - STEPS.len() - 1];
        let file = zstd::decode_all(packed).expect("packed");
        std::fs::write(path, file).expect("written");
        return 4;
    }
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
    1
}

/// What happened on two lines in two years: a fault that was repaired, came back and was closed by people
/// whose clocks differ, one that is open, and one of a run that never ended.
const PAST: &str = r#"
    INSERT INTO run VALUES
        (2, x'0198c0de00007000800000000000cafd', 1, 'line6', 1, '', 'sim', 31536000000000, 31536000000009,
            'failed', 1, 1, '0.1.0', '', '', NULL, ''),
        (3, x'0198c0de00007000800000000000cafc', 1, 'line8', 1, '', 'sim', 31536000000000, NULL, NULL,
            NULL, NULL, '0.1.0', '', '', NULL, '');
    INSERT INTO step VALUES (2, 0, 'atp/overspeed', 'EB', 'failed', 0, 1, '', 1);
    INSERT INTO measurement VALUES
        (2, 0, 0, 'eb_reaction', 0.61, 's', NULL, 0.58, 'failed'), (2, 0, 1, 'eb_reaction', NULL, 's', 0, 1, 'error');
    INSERT INTO fault VALUES
        (1, x'00000000000000000000000000000001', 1, 231, 'eb_relay_open', 'eb_relay', 'critical', 'closed', 5, 31536000000002, 3),
        (2, x'00000000000000000000000000000002', 1, 400, 'twc_lost', 'twc_cpu', 'minor', 'open', 31536000000001, 31536000000001, 1);
    INSERT INTO fault_occurrence VALUES
        (1, x'00000000000000000000000000000011', 1, 1, NULL, 5, 5, 'late', '[]', NULL),
        (2, x'00000000000000000000000000000012', 1, 2, 0, 31536000000001, 1, 'again', '[]', NULL),
        (3, x'00000000000000000000000000000013', 1, 2, 0, 31536000000002, 2, 'again', '[]', NULL),
        (4, x'00000000000000000000000000000014', 2, 3, NULL, 31536000000001, 1, '', '[]', NULL);
    INSERT INTO fault_event VALUES
        (1, x'00000000000000000000000000000021', 1, 'opened', 5, '', 'late', 'open'),
        (2, x'00000000000000000000000000000022', 1, 'closed', 31536000000900, 'lee', '이상 없음', 'closed'),
        (3, x'00000000000000000000000000000023', 1, 'recurred', 31536000000001, '', 'again', 'open'),
        (4, x'00000000000000000000000000000024', 1, 'note', 31536000000003, 'kim', 'contacts burnt', NULL),
        (5, x'00000000000000000000000000000025', 1, 'repair', 400, 'kim', '{"part":" EB_relay","note":"changed"}', 'repaired'),
        (6, x'00000000000000000000000000000026', 1, 'repair', 31536000000004, 'kim', 'no json', 'repaired'),
        (7, x'00000000000000000000000000000027', 2, 'opened', 31536000000001, '', '', 'open');
"#;

/// Goal: what is counted, who repaired what, whose turn it was and the chain of runs follow from the old rows
/// as they would have from new ones; and the file takes part in everything as one that was always new.
#[test]
fn a_migrated_file_has_the_counts_and_seals_of_a_new_one() {
    for version in 1..=STEPS.len() {
        let dir = tempdir().expect("a directory");
        let path = dir.path().join("a.db");
        old_file(&path, version);
        let conn = Connection::open(&path).expect("opens");
        conn.execute_batch(PAST).expect("a past");
        let store = open(&path);
        let report = store.check().expect("checked");
        assert_eq!(
            (report.runs, report.problems),
            (2, vec![]),
            "schema {version}"
        );
        let told = |sql: &str| -> Vec<String> {
            let mut select = conn.prepare(sql).expect(sql);
            let rows = select.query_map([], |row| row.get(0)).expect(sql);
            rows.collect::<Result<_, _>>().expect(sql)
        };
        let turns = "SELECT hex(substr(id, 16)) || turn FROM fault_event ORDER BY fault, turn";
        assert_eq!(
            told(turns),
            ["211", "252", "233", "244", "265", "226", "271"]
        );
        let faults = "SELECT line || ' ' || repairs || ' ' || ifnull(closed_at_us, '-') FROM fault";
        assert_eq!(told(faults), ["line8 2 31536000000900", "line8 0 -"]);
        let repairs =
            "SELECT part || '/' || opened_at_us || '/' || ifnull(back_at_us, '-') FROM repair";
        assert_eq!(
            told(repairs),
            ["eb_relay/5/31536000000001", "/31536000000001/-"]
        );
        let years =
            "SELECT at || ': ' || seen || ' ' || opened || ' ' || closed || ' ' || bare FROM tally
            WHERE dim = 0 AND grain = 0 ORDER BY at";
        assert_eq!(told(years), ["0: 1 1 0 0", "12: 3 1 1 0"]);
        let found = "SELECT CAST(rowid AS TEXT) FROM event_words WHERE event_words MATCH '\"없 음\" OR burnt'
            ORDER BY rowid";
        assert_eq!(told(found), ["2", "4"]);
        let new = Store::open(&dir.path().join("b.db"), OpenOptions::new(ids(2))).expect("opens");
        let merged = new.merge_from(&store).expect("merged");
        assert_eq!((merged.faults, merged.refused.count), (2, 1));
        assert!(
            merged.refused.named[0]
                .reason
                .starts_with("body is no repair"),
            "{:?}",
            merged.refused
        );
        assert_eq!(new.check().expect("checked").problems, []);
        // Closed by somebody who knew a repair that this file does not have.
        let closed = fault_db::FaultFilter {
            states: vec![FaultState::Closed],
            ..Default::default()
        };
        assert_eq!(store.faults(&closed).expect("listed").len(), 1);
        assert_eq!(new.faults(&closed).expect("listed").len(), 0);
    }
}

/// Two files that shared runs before runs were sealed: each has sealed them, and both chains stay whole.
#[test]
fn runs_that_two_files_shared_before_are_in_both_chains() {
    let dir = tempdir().expect("a directory");
    let (a, b) = (dir.path().join("a.db"), dir.path().join("b.db"));
    for path in [&a, &b] {
        old_file(path, 3);
        Connection::open(path)
            .and_then(|conn| conn.execute_batch(PAST))
            .expect("a past");
    }
    let a = open(&a);
    let b = Store::open(&b, OpenOptions::new(ids(2))).expect("opens");
    assert_eq!(a.merge_from(&b).expect("merged").runs, 0);
    let report = a.check().expect("checked");
    assert_eq!((report.runs, report.problems), (4, vec![]));
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
        *OLDEST_TO_LAST.end() + 1,
        SCHEMA_VERSION as usize,
        "each has its file"
    );
    for version in OLDEST_TO_LAST {
        let dir = tempdir().expect("a directory");
        let path = dir.path().join("a.db");
        let copy = dir.path().join(format!("a.db.schema{version}"));
        let again = dir.path().join(format!("a.db.schema{version}.2"));
        let old_runs = old_file(&path, version);
        let error = Store::open_read_only(&path).expect_err("reading brings nothing up to date");
        assert!(matches!(error, StoreError::OlderSchema { .. }), "{error}");
        let store = open(&path);
        assert_eq!(runs(&store).len(), old_runs, "schema {version}");
        let run = &runs(&store)[0];
        store
            .add_run_note(run.id, "kim", "door 3 rattles", T0_US)
            .expect("noted");
        let detail = store.run(run.id, &|_| false).expect("read");
        assert_eq!(detail.notes.last().expect("it").text, "door 3 rattles");
        assert_eq!(store.check().expect("checked").problems, []);
        assert_eq!(looked_at(&copy), (version, old_runs));
        store.close().expect("closed");
        assert_eq!(looked_at(&path), (SCHEMA_VERSION as usize, old_runs));
        open(&path);
        assert!(!again.exists(), "nothing old, no copy");
        // The old file laid back, after more work with it: the first copy stays as it is.
        std::fs::remove_file(&path).expect("gone");
        old_file(&path, version);
        open(&path);
        assert_eq!(looked_at(&again), (version, old_runs));
        assert_eq!(looked_at(&copy), (version, old_runs));
    }
}

/// Goal: programs that open an old file at the same moment all get it, brought up to date once, and what it was
/// is kept whole under its own version.
/// Method: many files, since the moment that matters is short.
#[test]
fn programs_that_open_an_old_file_together_keep_one_good_copy() {
    for round in 0..20 {
        let dir = tempdir().expect("a directory");
        let path = dir.path().join("a.db");
        old_file(&path, 3);
        std::thread::scope(|scope| {
            for seed in [11, 12, 13] {
                let path = &path;
                scope.spawn(move || {
                    let options = OpenOptions::new(ids(seed)).busy_timeout_ms(30_000);
                    let store = Store::open(path, options).expect("opens");
                    assert_eq!(runs(&store).len(), 1);
                });
            }
        });
        assert_eq!(looked_at(&path), (SCHEMA_VERSION as usize, 1));
        let entries = std::fs::read_dir(dir.path()).expect("read");
        let names = entries.map(|entry| entry.expect("an entry").file_name());
        let names = names.map(|name| name.to_string_lossy().into_owned());
        let copies: Vec<_> = names.filter(|name| name.contains(".schema")).collect();
        assert!(copies.contains(&"a.db.schema3".to_owned()), "{copies:?}");
        for copy in copies {
            let found = looked_at(&dir.path().join(&copy));
            assert_eq!(found, (3, 1), "round {round}: {copy}");
        }
    }
}
