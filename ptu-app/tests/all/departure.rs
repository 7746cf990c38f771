//! A departure test of a unit at a port: here its run is written by hand, as none of a simulated unit is valid.

use std::sync::Arc;

use fault_db::{
    RunEnd, RunRecord, RunWriter, ScriptRecord, StepRecord, Store, UnitRecord, Verdict,
};
use ptu_runs::clock::{now_us, open_options};
use ptu_runs::keys::KeyFile;

use crate::common::Place;
use crate::common::made_plans::contents;
use crate::forged::{signed, verify, with_key};

/// A signed run of a departure test with one step.
fn record(place: &Place, verdict: Verdict) {
    let store = Store::open(&place.path("history.db"), open_options()).expect("opens");
    let key = KeyFile::read(&place.path("kim.key")).expect("read");
    store.sign_with(Some(Arc::new(key.open("sesame-7").expect("opens"))));
    let evidence = ptu_runs::run::Evidence::now(contents(), Vec::new(), Default::default(), 1);
    let record = RunRecord {
        unit: UnitRecord {
            serial: "U-1".into(),
            kind: "atc".into(),
            config_name: "sg100".into(),
            ..UnitRecord::default()
        },
        source: "tcp:192.0.2.7:7000".into(),
        evidence: Some(evidence.text()),
        started_at_us: now_us(),
        scripts: vec![ScriptRecord {
            path: "departure/departure.star".into(),
            sha256: String::new(),
        }],
        ..RunRecord::default()
    };
    let mut run = RunWriter::begin(&store, &record).expect("begun");
    let step = StepRecord::passed(0, "departure/departure", "ATO is ready");
    run.step(StepRecord { verdict, ..step }).expect("stored");
    let end = RunEnd {
        verdict,
        finished_at_us: now_us(),
        bench_time_us: 1,
        wall_time_us: 1,
    };
    run.finish(&end).expect("finished");
    drop(run);
    store.close().expect("closed");
}

/// Goal: one that passed whole and is signed is valid for a day, as run, sheet and files say, for its unit and until a later
/// one failed.
#[test]
fn a_signed_one_of_a_real_unit_is_valid_until_a_later_one_fails() {
    let place = with_key();
    record(&place, Verdict::Passed);
    for (file, says) in [
        ("good.html", "Departure test, valid until"),
        ("good.csv", "departure_valid_until"),
        ("good.junit.xml", "departure_valid_until\" value=\"20"),
    ] {
        signed(&place, &format!("report latest --out {file}")).exits(0);
        assert!(place.read(file).contains(says), "{file}");
    }
    let shown = place.json("runs show latest --json");
    assert_eq!(shown["departure"]["valid"], true, "{shown}");
    let valid = "departure test of unit U-1, valid until 20";
    verify(&place, "latest").exits(0).prints(&[valid]);
    verify(&place, "good.html").exits(0).prints(&[valid]);
    let with = |more: &str| place.ptu(&format!("verify good.html --keys depot.keys {more}"));
    with("--unit U-2")
        .exits(1)
        .prints(&["it is of unit U-1, not of U-2"]);
    with("--db none.db")
        .exits(0)
        .prints(&[valid, "later departure tests were not looked for"]);
    record(&place, Verdict::Failed);
    verify(&place, "latest")
        .exits(1)
        .prints(&["\"ATO is ready\" failed"]);
    verify(&place, "good.html")
        .exits(1)
        .prints(&["the later departure test of 20"]);
}
