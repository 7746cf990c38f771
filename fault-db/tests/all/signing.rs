//! A signed run says who signed it, and every later change of it is found and located.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use fault_db::{
    FaultState, Id, OpenOptions, RecordingRecord, RunRecord, RunWriter, Signed, Signer, Statement,
    Store, Verdict,
};
use fuzzing::draw;
use rusqlite::Connection;
use rusqlite::types::Value;
use tempfile::{TempDir, tempdir};

use crate::common::{
    T0_US, change, end, fault, ids, measurement, new_history, open, realistic_trace, repair_of,
    rows, run_record, step,
};

fn signer(seed: u8) -> Arc<Signer> {
    Arc::new(Signer::new("Kim", "technician", &[seed; 32]).expect("a key"))
}

/// A run with all that one may have, signed, and what was said about it later, signed, too.
fn signed_run(store: &Store) -> Id {
    store.sign_with(Some(signer(1)));
    let record = RunRecord {
        train: "612".to_owned(),
        connection: Some("harness".to_owned()),
        symptom: Some("no_departure".to_owned()),
        evidence: Some("{\"clock\":{\"uncertainty_ms\":500}}".to_owned()),
        injected: Some("eb_relay.slow".to_owned()),
        ..run_record("ATC-7")
    };
    let mut run = RunWriter::begin(store, &record).expect("begun");
    for index in 0..4 {
        let mut measured = step(index);
        measured.message = "as expected".to_owned();
        measured.limit_source = Some("paper: S0".to_owned());
        let mut value = measurement("eb_reaction", 0.42);
        value.low = Some(0.1);
        measured.measurements = vec![value, measurement("eb_release", 0.3)];
        run.step(measured).expect("kept");
    }
    let seen = run.fault(&fault(4, T0_US + 5)).expect("stored");
    let trace = run.trace(&[seen.occurrence], &realistic_trace(40, 3));
    let recording = RecordingRecord {
        ordinal: 0,
        procedure: "atp/overspeed".to_owned(),
        t0_bench_us: 7,
        bench_json: "{\"seed\":1}".to_owned(),
        stimuli_json: "{\"tape\":[1,2,3]}".to_owned(),
    };
    let trace = trace.expect("stored");
    run.recording(&recording, &[trace]).expect("stored");
    let id = run.id();
    run.finish(&end(Verdict::Failed)).expect("finished");
    let repair = repair_of("eb_relay", "SN-1", "SN-2", "replaced");
    (store.add_run_note(id, "kim", "brakes looked at", T0_US + 30)).expect("noted");
    (store.record_repair(seen.fault, &repair, "kim", T0_US + 60)).expect("repaired");
    (store.add_note(seen.fault, "kim", "relay was old", T0_US + 70)).expect("noted");
    (store.set_state(seen.fault, FaultState::Verified, "kim", "", T0_US + 80)).expect("verified");
    id
}

/// A signed run in a file `a.db` that is closed.
fn signed_file() -> (TempDir, PathBuf, Id) {
    let (dir, path, store) = new_history();
    let id = signed_run(&store);
    store.close().expect("closed");
    (dir, path, id)
}

#[test]
fn a_signed_run_says_who_signed_it_and_when() {
    let (_dir, _, store) = new_history();
    let id = signed_run(&store);
    let found = store.verify_run(id).expect("verified");
    assert_eq!(found.changes, [""; 0]);
    let run: Vec<&Statement> = found.of_run().collect();
    assert_eq!(run.len(), 1);
    assert_eq!((&run[0].who[..], &run[0].kind[..]), ("Kim", "technician"));
    assert_eq!(run[0].key, signer(1).public_key());
    assert_eq!(run[0].at_us, T0_US + 5_000_000);
    let about = run[0].about.as_ref().expect("about the run");
    assert_eq!((&about.unit[..], &about.verdict[..]), ("ATC-7", "failed"));
    assert_eq!((about.steps, about.measurements), (4, 8));
    let seal = found.seal.as_ref().expect("sealed");
    assert_eq!((&run[0].digest, &run[0].seal), (&seal.digest, &seal.seal));
    // The run, its note, and five events: opened, repair, note, verified.
    let whats: Vec<&str> = found.signatures.iter().map(|one| &one.what[..]).collect();
    assert_eq!(whats, ["run", "note", "event", "event", "event", "event"]);
    let checked = store.check().expect("checked");
    assert_eq!(checked.problems, []);
    assert_eq!((checked.signed[0].runs, checked.signed[0].others), (1, 5));
}

#[test]
fn without_a_key_a_run_is_unsigned_and_nothing_else_changes() {
    let (_dir, _, store) = new_history();
    let run = RunWriter::begin(&store, &run_record("ATC-7")).expect("begun");
    let (id, mut run) = (run.id(), run);
    run.finish(&end(Verdict::Passed)).expect("finished");
    let found = store.verify_run(id).expect("verified");
    assert!(found.signatures.is_empty() && found.changes.is_empty());
    assert!(store.check().expect("checked").signed.is_empty());
}

/// Columns that are places within the file, or that follow from other rows and are checked against these.
const OF_THE_FILE: [(&str, &str); 4] = [
    ("run", "seq"),
    ("fault_occurrence", "seq"),
    ("fault_event", "seq"),
    ("run_note", "seq"),
];

/// Goal: whatever is changed in a signed run is found and located, 100 %.
/// Method: every column of every row of the run, its notes, faults' events and seals is changed in turn, in a copy of
/// its own; blobs at several bytes. The finding must name the row.
#[test]
fn every_changed_field_of_a_signed_run_is_found_and_located() {
    let (dir, path, id) = signed_file();
    let tables = "run run_script step measurement fault_occurrence fault_event \
        run_note trace channel_set recording seal fault";
    let (mut changed, mut by_check, mut missed, mut vague) = (0, 0, Vec::new(), Vec::new());
    let copy = dir.path().join("b.db");
    let mut changes = Vec::new();
    for table in tables.split(' ') {
        for (column, row, value) in cells(&path, table) {
            if !OF_THE_FILE.contains(&(table, &column[..])) {
                let others = others(&value).into_iter().enumerate();
                changes.extend(others.map(|(n, other)| (table, column.clone(), row, n, other)));
            }
        }
    }
    for (table, column, row, n, other) in draw::drawn(changes, 2) {
        let place = format!("{table}.{column} row {row} change {n}");
        std::fs::copy(&path, &copy).expect("copied");
        if !set(&copy, table, &column, row, &other) {
            continue;
        }
        changed += 1;
        let store = Store::open_read_only(&copy).expect("opens");
        let found = match store.verify_run(id) {
            Ok(found) => found.changes,
            Err(error) => vec![error.to_string()],
        };
        if found.is_empty() {
            let found = store.check().map(|report| report.problems);
            if found.is_ok_and(|problems| problems.is_empty()) {
                missed.push(place);
            } else {
                by_check += 1;
            }
        } else if !names(table, &column, &found) {
            vague.push(format!("{place}: {found:?}"));
        }
    }
    let (unseen, unclear) = (missed.len(), vague.len());
    let located = changed - by_check - unseen - unclear;
    println!(
        "{changed} fields changed: {located} found and located by verifying the run, {by_check} found by a check of \
         the file, {unclear} found but not located, {unseen} not found"
    );
    let least = if draw::draws_all() { 250 } else { 125 };
    assert!(changed > least, "{changed}");
    assert!(
        missed.is_empty(),
        "{} of {changed} not found: {missed:#?}",
        missed.len()
    );
    assert!(
        vague.is_empty(),
        "{} of {changed} not located: {vague:#?}",
        vague.len()
    );
}

/// Whether one of the findings names the kind of row.
fn names(table: &str, column: &str, found: &[String]) -> bool {
    let word = match (table, column) {
        ("run", "id" | "unit") => "run",
        ("run", _) => "its ",
        ("run_script", _) => "script",
        ("step", _) => "step",
        ("measurement", _) => "measure",
        ("fault_occurrence", "trace") => "trace",
        ("fault_occurrence", _) => "occurrence",
        ("fault_event", _) | ("fault", _) => "event",
        ("run_note", _) => "note",
        ("trace" | "channel_set", _) => "trace",
        ("recording", _) => "recording",
        _ => "",
    };
    found.iter().any(|found| found.contains(word))
}

fn cells(path: &Path, table: &str) -> Vec<(String, usize, Value)> {
    let conn = Connection::open(path).expect("opens");
    let key = keys(&conn, table);
    let mut select = conn
        .prepare(&format!("SELECT * FROM {table} ORDER BY {key}"))
        .expect("read");
    let columns: Vec<String> = select
        .column_names()
        .iter()
        .map(|name| (*name).to_owned())
        .collect();
    let mut rows = select.query([]).expect("read");
    let (mut cells, mut row) = (Vec::new(), 0);
    while let Some(found) = rows.next().expect("read") {
        for (place, column) in columns.iter().enumerate() {
            cells.push((column.clone(), row, found.get(place).expect("a value")));
        }
        row += 1;
    }
    cells
}

/// Other values of the same type, each a small change.
fn others(value: &Value) -> Vec<Value> {
    match value {
        // In a strict table a column takes one of them.
        Value::Null => vec![
            Value::Integer(1),
            Value::Text("x".into()),
            Value::Blob(vec![1; 16]),
        ],
        Value::Integer(n) => vec![Value::Integer(n + 1)],
        Value::Real(x) => vec![Value::Real(f64::from_bits(x.to_bits() ^ 1))],
        Value::Text(text) if text.is_empty() => vec![Value::Text(" ".into())],
        Value::Text(text) => {
            let middle = text.len() / 2;
            let mut bytes = text.clone().into_bytes();
            bytes[middle] ^= 1;
            let flipped = String::from_utf8(bytes).unwrap_or_else(|_| format!("{text}x"));
            vec![Value::Text(flipped), Value::Text(format!("{text} "))]
        }
        Value::Blob(bytes) if bytes.is_empty() => vec![Value::Blob(vec![1; 16])],
        Value::Blob(bytes) => (0..4)
            .map(|part| {
                let mut bytes = bytes.clone();
                let place = part * (bytes.len() - 1) / 3;
                bytes[place] ^= 0x10;
                Value::Blob(bytes)
            })
            .collect(),
    }
}

/// Changes a cell past triggers; `false` if the table does not take the value.
fn set(path: &Path, table: &str, column: &str, row: usize, value: &Value) -> bool {
    let literal = match value {
        Value::Null => "NULL".to_owned(),
        Value::Integer(n) => n.to_string(),
        Value::Real(x) => format!("{x:?}"),
        Value::Text(text) => format!("'{}'", text.replace('\'', "''")),
        Value::Blob(bytes) => {
            let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
            format!("x'{digits}'")
        }
    };
    let conn = Connection::open(path).expect("opens");
    let key = keys(&conn, table);
    let sql = format!(
        "UPDATE {table} SET {column} = {literal}
         WHERE ({key}) = (SELECT {key} FROM {table} ORDER BY {key} LIMIT 1 OFFSET {row})"
    );
    // A value of another type than the column's, or one that a rule of the table refuses, is no change.
    let of_type = conn.query_row(
        "SELECT type FROM pragma_table_info(?1) WHERE name = ?2",
        [table, column],
        |found| found.get::<_, String>(0),
    );
    drop(conn);
    let of_type = of_type.expect("a column");
    let fits = match value {
        Value::Null => true,
        Value::Integer(_) => of_type == "INTEGER" || of_type == "REAL",
        Value::Real(_) => of_type == "REAL",
        Value::Text(_) => of_type == "TEXT",
        Value::Blob(_) => of_type == "BLOB",
    };
    fits && std::panic::catch_unwind(|| change(path, &sql)).is_ok()
}

fn keys(conn: &Connection, table: &str) -> String {
    let mut select = conn
        .prepare("SELECT name FROM pragma_table_info(?1) WHERE pk > 0 ORDER BY pk")
        .expect("read");
    let names = select.query_map([table], |row| row.get::<_, String>(0));
    let names: Vec<String> = names
        .expect("read")
        .collect::<Result<_, _>>()
        .expect("read");
    names.join(", ")
}

/// Goal: no byte of a trace, a note or a repair is changed unseen.
/// Method: each byte of each in turn, one bit of it in the check and all of them from `CAMPAIGN=8` on. A changed byte
/// that makes a text no text any more is passed over.
#[test]
fn every_changed_byte_of_samples_notes_and_repairs_is_found() {
    let (_dir, path, id) = signed_file();
    let reader = Store::open_read_only(&path).expect("opens");
    let conn = Connection::open(&path).expect("opens");
    conn.execute_batch("PRAGMA synchronous = OFF").expect("set");
    let bits = fuzzing::amount(1).min(8);
    for (table, column, of) in [
        ("trace", "data", "trace"),
        ("recording", "stimuli", "recording"),
        ("run_note", "text", "note"),
        ("fault_event", "body", "event"),
    ] {
        let key = keys(&conn, table);
        let place =
            format!("({key}) = (SELECT {key} FROM {table} ORDER BY {key} LIMIT 1 OFFSET ?2)");
        let sql = format!("UPDATE {table} SET {column} = ?1 WHERE {place}");
        let (mut bytes, mut changed, mut missed) = (0, 0, Vec::new());
        let rows = cells(&path, table).into_iter();
        for (_, row, value) in rows.filter(|cell| cell.0 == column) {
            let set = |value: &Value| {
                let set = conn.execute(&sql, rusqlite::params![value, row as i64]);
                assert_eq!(set.expect("changed"), 1);
            };
            for place in 0..length(&value) {
                bytes += 1;
                for bit in 0..bits {
                    let Some(other) = with_bit_changed(&value, place, bit) else {
                        continue;
                    };
                    set(&other);
                    changed += 1;
                    let found = reader.verify_run(id).expect("read").changes;
                    if !found.iter().any(|found| found.contains(of)) {
                        missed.push(format!("row {row} byte {place} bit {bit}: {found:?}"));
                    }
                }
            }
            set(&value);
        }
        let found = changed - missed.len();
        println!("{table:11} {bytes:5} bytes, {changed:5} bits changed, {found:5} found");
        assert!(changed > 0 && missed.is_empty(), "{table}: {missed:#?}");
    }
    assert_eq!(reader.verify_run(id).expect("read").changes, [""; 0]);
}

fn length(value: &Value) -> usize {
    match value {
        Value::Blob(bytes) => bytes.len(),
        Value::Text(text) => text.len(),
        _ => panic!("{value:?}"),
    }
}

/// The value with one bit of one byte changed; none if that makes a text no text any more.
fn with_bit_changed(value: &Value, place: usize, bit: u64) -> Option<Value> {
    let changed = |bytes: &[u8]| {
        let mut bytes = bytes.to_vec();
        bytes[place] ^= 1 << bit;
        bytes
    };
    match value {
        Value::Blob(bytes) => Some(Value::Blob(changed(bytes))),
        Value::Text(text) => Some(Value::Text(
            String::from_utf8(changed(text.as_bytes())).ok()?,
        )),
        _ => panic!("{value:?}"),
    }
}

/// Goal: taking a row out, or putting one in, is found and located.
#[test]
fn rows_taken_out_or_put_in_are_found() {
    let (dir, path, id) = signed_file();
    for [sql, says] in rows(include_str!("signing/rows.txt")) {
        let copy = dir.path().join("b.db");
        std::fs::copy(&path, &copy).expect("copied");
        change(&copy, sql);
        let found = Store::open_read_only(&copy)
            .expect("opens")
            .verify_run(id)
            .expect("read");
        assert!(
            found.changes.iter().any(|found| found.contains(says)),
            "{sql}: {:?}",
            found.changes
        );
    }
}

/// Goal: who can write the file and knows how seals are made cannot make a changed run look signed.
/// Method: the verdict is changed and the run is sealed again by the program itself, as a forger would.
#[test]
fn a_run_that_was_sealed_again_is_not_what_was_signed() {
    let dir = tempdir().expect("a directory");
    let (ours, forged) = (dir.path().join("a.db"), dir.path().join("b.db"));
    let store = open(&ours);
    let id = signed_run(&store);
    let signed = store.signatures(id).expect("read").remove(0);
    store.close().expect("closed");
    // The forger's own file, whole and well sealed, with his own key of the same name.
    std::fs::copy(&ours, &forged).expect("copied");
    change(
        &forged,
        "UPDATE run SET verdict = 'passed'; DELETE FROM seal WHERE what IN ('run', 'signature')",
    );
    let other = dir.path().join("c.db");
    let store = Store::open(&other, OpenOptions::new(ids(9))).expect("opens");
    let forger = Store::open(&forged, OpenOptions::new(ids(8))).expect("opens");
    let _ = store.import(&forged);
    drop(forger);
    let found = store.check().expect("checked");
    assert!(
        found.signed.iter().all(|key| key.runs == 0),
        "{:?}",
        found.signed
    );
    let changed = signed.replace("\"failed\"", "\"passed\"");
    assert_ne!(changed, signed);
    assert!(Signed::read(&signed).is_ok() && Signed::read(&changed).is_err());
}

/// Goal: signatures travel with the rows, and still hold in another file.
#[test]
fn a_signature_holds_in_the_file_that_it_was_brought_to() {
    let (dir, path, id) = signed_file();
    let other = Store::open(&dir.path().join("b.db"), OpenOptions::new(ids(5))).expect("opens");
    other.import(&path).expect("merged");
    let found = other.verify_run(id).expect("verified");
    assert_eq!((found.of_run().count(), found.signatures.len()), (1, 6));
    assert_eq!(found.changes, [""; 0]);
    assert_eq!(other.check().expect("checked").problems, []);
}

/// Goal: `rebuild` signs nothing and gives nothing a seal that has none, whoever's key is set.
#[test]
fn rebuild_seals_and_signs_nothing_that_was_changed() {
    let (_dir, path, _) = signed_file();
    change(
        &path,
        "DELETE FROM repair; UPDATE run SET operator = 'lee'; DELETE FROM seal WHERE what = 'note'",
    );
    let store = open(&path);
    store.sign_with(Some(signer(1)));
    let before = store.check().expect("checked");
    assert!(!store.rebuild(T0_US + 90).expect("rebuilt").is_empty());
    let after = store.check().expect("checked");
    assert_eq!(after.signed, before.signed);
    let of_seals = |report: &fault_db::CheckReport| -> Vec<String> {
        let seals = report
            .problems
            .iter()
            .filter(|problem| problem.kind.as_str() == "seal");
        seals.map(|problem| problem.detail.to_string()).collect()
    };
    // All findings stay, and what was counted again is one more.
    let mut after = of_seals(&after);
    after.retain(|found| !found.starts_with("counted again"));
    assert_eq!(after, of_seals(&before));
    assert!(after.len() >= 2);
}
