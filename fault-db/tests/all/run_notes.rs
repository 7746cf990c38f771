//! Notes on runs: in their order, merged once, untouched by pruning, found when damaged.

use crate::common::{
    T0_US, end, ids, kinds, new_history, open, problems, realistic_trace, refused, run_record,
    tells, with,
};
use fault_db::{
    Id, OpenOptions, PruneRule, RunNote, RunWriter, Store, StoreError, TracePlace, Verdict,
};
use rusqlite::Connection;
use tempfile::tempdir;

fn one_run(store: &Store) -> Id {
    let mut writer = RunWriter::begin(store, &run_record("ATC-7")).expect("begun");
    writer.trace(&[], &realistic_trace(60, 3)).expect("stored");
    writer.finish(&end(Verdict::Passed)).expect("finished");
    writer.id()
}

fn note(store: &Store, run: Id, text: &str, at_us: i64) {
    store.add_run_note(run, "kim", text, at_us).expect("noted");
}

fn notes(store: &Store, run: Id) -> Vec<RunNote> {
    store.run(run).expect("there").notes
}

#[test]
fn notes_stand_at_their_run_in_their_order_and_survive_pruning() {
    let (_dir, _, store) = new_history();
    let (run, other) = (one_run(&store), one_run(&store));
    note(&store, run, "second", T0_US + 2);
    note(&store, run, "first; \"김\"\n'--", T0_US + 1);
    let rule = with(|it: &mut PruneRule| it.older_than_us = Some(T0_US + 9));
    assert_eq!(store.prune(&rule).expect("pruned").traces, 2);
    let texts: Vec<_> = notes(&store, run).into_iter().map(|n| n.text).collect();
    assert_eq!(texts, ["first; \"김\"\n'--", "second"]);
    assert_eq!(notes(&store, other), []);
}

#[test]
fn merging_takes_notes_along_once_and_both_files_notes_stay() {
    let dir = tempdir().expect("a directory");
    let ours = open(&dir.path().join("a.db"));
    let options = OpenOptions::new(ids(2));
    let theirs = Store::open(&dir.path().join("b.db"), options).expect("opens");
    // Their run gets another number here.
    one_run(&theirs);
    let run = one_run(&ours);
    note(&ours, run, "ours", T0_US + 1);
    assert_eq!(theirs.merge_from(&ours).expect("merged").notes, 1);
    assert_eq!(theirs.merge_from(&ours).expect("merged").notes, 0);
    note(&theirs, run, "theirs", T0_US + 2);
    assert_eq!(ours.merge_from(&theirs).expect("merged").notes, 1);
    assert_eq!(notes(&ours, run), notes(&theirs, run));
    assert_eq!(notes(&ours, run).len(), 2);
    let exported = dir.path().join("c.db");
    let counts = ours.export(&exported, OpenOptions::new(ids(3)));
    assert_eq!(counts.expect("exported").notes, 2);
}

#[test]
fn a_note_on_no_run_is_refused_and_one_whose_run_is_lost_is_found() {
    let (_dir, path, store) = new_history();
    let run = one_run(&store);
    let nobody = Id::from_bytes([7; 16]);
    let noted = store.add_run_note(nobody, "kim", "x", T0_US);
    refused!(noted, StoreError::NotFound { .. });
    note(&store, run, "x", T0_US);
    let other = Connection::open(&path).expect("opens");
    let damage = "PRAGMA foreign_keys = OFF; UPDATE run_note SET run = 99";
    other.execute_batch(damage).expect("damaged");
    let found = problems(&store);
    assert_eq!(kinds(&found), ["foreign_key", "seal"]);
    assert!(tells(&found[0], "run_note"), "{found:?}");
}

/// Goal: what somebody saw in a trace is found there by others. Method: notes at two places, given in the wrong order, and one
/// on the run alone; the file's check, and another file that takes them along.
#[test]
fn a_note_at_a_place_in_a_trace_is_found_there_and_on_its_run() {
    let dir = tempdir().expect("a directory");
    let ours = open(&dir.path().join("a.db"));
    let run = one_run(&ours);
    let trace = ours.traces(run).expect("traces")[0].id;
    let place = |at_us| TracePlace { trace, at_us };
    for (at_us, text) in [(200_000, "then the brake"), (-350_000, "the wheel slips")] {
        ours.add_trace_note(place(at_us), "kim", text, T0_US)
            .expect("noted");
    }
    note(&ours, run, "on the run", T0_US + 1);
    assert!(ours.check().expect("checked").problems.is_empty());
    let theirs = Store::open(&dir.path().join("b.db"), OpenOptions::new(ids(2))).expect("opens");
    theirs.merge_from(&ours).expect("merged");
    for store in [&ours, &theirs] {
        let found = store.run(run).expect("read").notes.into_iter();
        let found = found.filter(|note| note.place.is_some());
        let mut found: Vec<_> = found.map(|note| (note.place, note.text)).collect();
        found.sort_by_key(|(place, _)| place.map(|place| place.at_us));
        let told = [
            (Some(place(-350_000)), "the wheel slips".to_owned()),
            (Some(place(200_000)), "then the brake".to_owned()),
        ];
        assert_eq!(found, told);
        assert_eq!(notes(store, run).len(), 3);
    }
    let nowhere = TracePlace {
        trace: run,
        at_us: 0,
    };
    let noted = ours.add_trace_note(nowhere, "kim", "x", T0_US);
    refused!(noted, StoreError::NotFound { .. });
}
