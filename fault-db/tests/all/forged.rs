//! Attacks on signatures and chains by somebody who can write the file and knows how seals are made.

use std::path::Path;
use std::sync::Arc;

use fault_db::{FaultState, Id, OpenOptions, PruneRule, RunWriter, Signed, Signer, Store, Verdict};
use rusqlite::Connection;
use sha2::{Digest as _, Sha256};
use tempfile::tempdir;

use crate::common::{
    T0_US, change, end, fault, ids, new_history, open, realistic_trace, recorded, run_record,
};

fn signer() -> Arc<Signer> {
    Arc::new(Signer::new("Kim", "technician", &[3; 32]).expect("a key"))
}

/// A run with a fault and a note.
fn run(store: &Store, serial: &str) -> (Id, Id) {
    let mut run = RunWriter::begin(store, &run_record(serial)).expect("begun");
    let seen = run.fault(&fault(4, T0_US + 5)).expect("stored");
    for (seed, of) in [(3, &[seen.occurrence][..]), (4, &[])] {
        (run.trace(of, &realistic_trace(40, seed))).expect("stored");
    }
    let id = run.id();
    run.finish(&end(Verdict::Failed)).expect("finished");
    (store.add_run_note(id, "kim", "looked at", T0_US + 6_000_000)).expect("noted");
    (id, seen.fault)
}

/// Appends an entry to the file's own chain, well made.
fn append(path: &Path, what: &str, id: Id, says: &str) {
    let conn = Connection::open(path).expect("opens");
    let field = |kind: u8, bytes: &[u8]| {
        let length = (bytes.len() as u64).to_be_bytes();
        [&[kind][..], &length, bytes].concat()
    };
    let fields = [
        field(3, what.as_bytes()),
        field(1, &1_i64.to_be_bytes()),
        field(4, id.as_bytes()),
        field(3, says.as_bytes()),
    ];
    let digest = Sha256::digest(fields.concat());
    let last = "SELECT origin, ordinal, hash FROM seal WHERE origin = (SELECT value FROM about WHERE key = 'file_id') ORDER BY ordinal DESC";
    let (origin, ordinal, before): (Vec<u8>, i64, Vec<u8>) = conn
        .query_row(last, [], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?)))
        .expect("a chain");
    let hash = Sha256::digest([&before[..], &digest].concat());
    drop(conn);
    let hex = |bytes: &[u8]| {
        bytes
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect::<String>()
    };
    change(
        path,
        &format!(
            "INSERT INTO seal(origin, ordinal, what, id, says, digest, hash) VALUES
                (x'{}', {}, '{what}', x'{}', '{}', x'{}', x'{}')",
            hex(&origin),
            ordinal + 1,
            hex(id.as_bytes()),
            says.replace('\'', "''"),
            hex(&digest),
            hex(&hash)
        ),
    );
}

/// Goal: a signature of one run, note or event signs no other.
/// Method: each signed document of a run and its fault is appended to another run, and to that run's fault.
#[test]
fn a_signature_signs_what_it_names_and_nothing_else() {
    let (dir, path, store) = new_history();
    store.sign_with(Some(signer()));
    let (signed, of_signed) = run(&store, "ATC-7");
    store.sign_with(None);
    let (other, of_other) = run(&store, "ATC-8");
    store.close().expect("closed");
    let conn = Connection::open(&path).expect("opens");
    let mut select =
        (conn.prepare("SELECT says FROM seal WHERE what = 'signature'")).expect("asked");
    let texts: Vec<String> = (select.query_map([], |row| row.get(0)).expect("asked"))
        .collect::<Result<_, _>>()
        .expect("read");
    assert_eq!(
        texts.len(),
        3,
        "the run, its note and its fault's beginning"
    );
    for (text, group) in texts.iter().flat_map(|text| {
        [
            (text, other),
            (text, of_other),
            (text, signed),
            (text, of_signed),
        ]
    }) {
        let is_its_own = match &Signed::read(text).expect("signed").statement()["what"] {
            what if what == "event" => group == of_signed,
            _ => group == signed,
        };
        if is_its_own {
            continue;
        }
        let copy = dir.path().join("b.db");
        std::fs::copy(&path, &copy).expect("copied");
        append(&copy, "signature", group, text);
        let forged = Store::open_read_only(&copy).expect("opens");
        let run = if [other, of_other].contains(&group) {
            other
        } else {
            signed
        };
        let seen = forged.verify_run(run).expect("verified");
        assert_eq!(seen.of_run().count(), usize::from(run == signed), "{text}");
        assert!(
            seen.changes
                .iter()
                .any(|said| said.contains("is of another")),
            "{:?}",
            seen.changes
        );
        let shown = forged.run(other).expect("read");
        assert_eq!(shown.signature, None, "{text}");
        assert_eq!(forged.signatures(other).expect("read"), [""; 0]);
        assert!(
            !forged.check().expect("checked").problems.is_empty(),
            "{text}"
        );
    }
}

/// Goal: a run or note whose rows were changed after it was signed is nowhere shown as signed; traces are rows of the run.
#[test]
fn what_was_changed_is_not_shown_as_signed() {
    let (dir, path, store) = new_history();
    store.sign_with(Some(signer()));
    let (id, seen) = run(&store, "ATC-7");
    let by_of = |store: &Store| {
        let shown = store.run(id).expect("read");
        (
            shown.signature.map(|of| of.who),
            shown.notes[0].signed_by.clone(),
        )
    };
    let kim = || Some("Kim".to_owned());
    assert_eq!(by_of(&store), (kim(), kim()));
    store.close().expect("closed");
    for (sql, left, signed) in [
        ("UPDATE run SET verdict = 'passed'", "note", (None, kim())),
        (
            "UPDATE run_note SET text = 'all good'",
            "run",
            (kim(), None),
        ),
        ("DELETE FROM trace", "note", (None, kim())),
        (
            "UPDATE trace SET (data, sha256) =
                (SELECT o.data, o.sha256 FROM trace o WHERE o.seq <> trace.seq LIMIT 1)",
            "note",
            (None, kim()),
        ),
    ] {
        let copy = dir.path().join("b.db");
        std::fs::copy(&path, &copy).expect("copied");
        change(&copy, sql);
        let store = Store::open_read_only(&copy).expect("opens");
        // What else is signed is left, and goes into the certificate of the run.
        let texts = store.signatures(id).expect("read");
        assert!(
            texts.len() == 1 && texts[0].contains(&format!("\"what\":\"{left}\"")),
            "{texts:?}"
        );
        assert_eq!(by_of(&store), signed, "{sql}");
    }
    let store = open(&path);
    for state in [
        FaultState::Repaired,
        FaultState::Verified,
        FaultState::Closed,
    ] {
        (store.set_state(seen, state, "kim", "", T0_US + 9)).expect("set");
    }
    let pruned = store.prune(&PruneRule::default()).expect("pruned");
    assert!(pruned.traces > 0, "{pruned:?}");
    assert_eq!(by_of(&store), (kim(), kim()), "after a prune");
}

/// Goal: a signed document has one form, byte for byte.
#[test]
fn a_signed_document_in_another_form_is_refused() {
    let kept = Signed::new(&signer(), &serde_json::json!({"what": "run", "id": "1"})).text();
    assert!(Signed::read(&kept).is_ok());
    let signature = kept.split('"').nth(3).expect("a signature");
    let statement = kept.split_once("\"statement\":").expect("a statement").1;
    let statement = &statement[..statement.len() - 1];
    for other in [
        kept.replacen('{', "{\"signature\":\"Passed\",", 1),
        kept.replacen("{\"id\"", "{\"id\":\"0\",\"id\"", 1),
        kept.replace("\":", "\": "),
        format!("{kept} "),
        kept.replace("run", "\\u0072un"),
        format!("{{\"statement\":{statement},\"signature\":\"{signature}\"}}"),
    ] {
        assert_ne!(other, kept);
        assert!(Signed::read(&other).is_err(), "{other}");
    }
}

/// Goal: a history that was put back to an older copy is told by a file that has imported the later runs, whether it went on
/// or not; its own copies are still taken back by itself.
#[test]
fn a_rollback_is_seen_by_who_imported_the_later_runs() {
    let dir = tempdir().expect("a directory");
    let [a, old, b] = ["a.db", "old.db", "b.db"].map(|name| dir.path().join(name));
    let store = open(&a);
    run(&store, "ATC-7");
    store.backup(&old).expect("copied");
    run(&store, "ATC-8");
    store.close().expect("closed");
    let other = Store::open(&b, OpenOptions::new(ids(5))).expect("opens");
    other.import(&a).expect("merged");
    for goes_on in [false, true] {
        if goes_on {
            let put_back = Store::open(&old, OpenOptions::new(ids(77))).expect("opens");
            run(&put_back, "ATC-9");
            put_back.close().expect("closed");
        }
        let seen = Store::open_read_only(&old).expect("opens");
        let said = other.seen_otherwise(&seen).expect("compared");
        assert!(
            said.iter()
                .any(|said| said.contains("was cut") || said.contains("was rewritten")),
            "{said:?}"
        );
        let refused = other.import(&old).expect_err("refused").to_string();
        assert!(
            refused.contains("was cut") || refused.contains("was rewritten"),
            "{refused}"
        );
    }
    assert!(
        other
            .seen_otherwise(&Store::open_read_only(&a).expect("opens"))
            .expect("compared")
            .is_empty()
    );
}

/// Goal: a clock that went backward within a chain is told, by the check of the file and of the run.
#[test]
fn a_clock_that_went_backward_is_told() {
    let (_dir, _, store) = new_history();
    let at = |serial: &str, days: i64| {
        let off = days * 86_400_000_000;
        let mut record = run_record(serial);
        record.started_at_us += off;
        let mut end = end(Verdict::Passed);
        end.finished_at_us += off;
        recorded(&store, &record, &[], &[], &end).0
    };
    let (ahead, right) = (at("ATC-7", 300), at("ATC-7", 0));
    let told = |said: &[String]| {
        said.iter()
            .any(|said| said.contains("the clock went backward"))
    };
    let seen = store.verify_run(right).expect("verified");
    assert!(told(&seen.remarks), "{seen:?}");
    assert!(!told(&store.verify_run(ahead).expect("verified").remarks));
    assert_eq!(store.resolve_run("latest").expect("a run"), right);
    assert!(told(&store.check().expect("checked").remarks));
}
