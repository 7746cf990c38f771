//! Faults, repairs and runs counted by month, and how often a fault was seen.

use crate::common::{Place, Said, number, text};
use crate::questions::within_a_day;
use chrono::NaiveDate;
use fault_db::{
    FaultRecord, FaultState, Id, MeasurementRecord, RepairRecord, RunEnd, RunRecord, RunWriter,
    StepRecord, Store, UnitRecord, Verdict,
};
use serde_json::Value;

/// Noon of a day of 2025, UTC.
pub fn noon_us(month: u32, day: u32) -> i64 {
    let date = NaiveDate::from_ymd_opt(2025, month, day).expect("a day");
    let noon = date.and_hms_opt(12, 0, 0).expect("noon");
    noon.and_utc().timestamp_micros()
}

/// A run that measured something, and found a fault if there is one.
pub fn record(store: &Store, at_us: i64, fault: Option<&str>) -> Option<Id> {
    record_in(store, "", at_us, fault)
}

/// Records a run of the unit in a train, with a fault if there is one.
fn record_in(store: &Store, train: &str, at_us: i64, fault: Option<&str>) -> Option<Id> {
    let record = RunRecord {
        unit: UnitRecord {
            serial: format!("U-1{train}"),
            kind: "ATC".into(),
            config_name: "default".into(),
            sw_versions: std::collections::BTreeMap::new(),
        },
        line: "line8".into(),
        train: train.to_owned(),
        seed: 1,
        source: "sim".into(),
        started_at_us: at_us,
        app_version: "1".into(),
        ..RunRecord::default()
    };
    let mut writer = RunWriter::begin(store, &record).expect("begun");
    let measured = MeasurementRecord {
        name: "eb_reaction".into(),
        value: Some(0.4),
        unit: "s".into(),
        low: None,
        high: Some(0.5),
        limit_source: None,
        verdict: Verdict::Passed,
    };
    let step = StepRecord {
        measurements: vec![measured],
        ..StepRecord::passed(0, "atp/overspeed", "step")
    };
    writer.step(step).expect("kept");
    let id = fault.map(|lru| {
        let record = FaultRecord {
            code: 9000,
            code_name: "check_failed".into(),
            lru: lru.into(),
            severity: "major".into(),
            at_us,
            bench_us: 0,
            step_index: Some(0),
            ..FaultRecord::default()
        };
        writer.fault(&record).expect("stored").fault
    });
    let verdict = match fault {
        Some(_) => Verdict::Failed,
        None => Verdict::Passed,
    };
    let end = RunEnd {
        verdict,
        finished_at_us: at_us,
        bench_time_us: 1,
        wall_time_us: 1,
    };
    writer.finish(&end).expect("finished");
    id
}

/// The history of a place, to write to.
pub fn store(place: &Place) -> Store {
    let options = ptu_runs::clock::open_options();
    Store::open(&place.path("history.db"), options).expect("a history")
}

/// The answer where local time is so (POSIX: `EST5` is five hours behind UTC).
fn in_zone(place: &Place, zone: &str, arguments: &[&str]) -> Said {
    place.ptu_where(("TZ", zone), arguments).exits(0)
}

/// Goal: what is done to a fault counts in the month it is done, after the last occurrence, too. Method: a unit
/// is known from 15 February on, has its only fault on 5 March, is repaired on the 10th, and the fault is
/// closed on 2 April.
#[test]
fn months_count_all_that_was_done_in_them() {
    within_a_day(count_all_that_was_done_in_them);
}

fn count_all_that_was_done_in_them() {
    let place = Place::new();
    let history = store(&place);
    record(&history, noon_us(2, 15), None);
    let fault = record(&history, noon_us(3, 5), Some("eb_relay")).expect("a fault");
    let repair = RepairRecord {
        part: "eb_relay".into(),
        ..RepairRecord::default()
    };
    history
        .record_repair(fault, &repair, "kim", noon_us(3, 10))
        .expect("repaired");
    let act = |state, day| {
        let at_us = noon_us(4, day);
        history
            .set_state(fault, state, "kim", "", at_us)
            .expect("may")
    };
    act(FaultState::Verified, 1);
    act(FaultState::Closed, 2);
    drop(history);

    let stats = |by: &str, more: &[&str]| -> Vec<Value> {
        let arguments = [&["faults", "stats", "--json", "--by", by], more].concat();
        let said = in_zone(&place, "UTC0", &arguments);
        serde_json::from_str(&said.out).expect("a list")
    };
    let months = stats("month", &[]);
    let counts: Vec<_> = months
        .iter()
        .take(4)
        .map(|month| {
            let counts = ["faults", "repairs", "closed"].map(|key| number(&month[key]));
            (text(&month["key"]), counts)
        })
        .collect();
    assert_eq!(
        counts,
        [
            ("2025-02", [0.0, 0.0, 0.0]),
            ("2025-03", [1.0, 1.0, 0.0]),
            ("2025-04", [0.0, 0.0, 1.0]),
            ("2025-05", [0.0, 0.0, 0.0]),
        ]
    );
    let march = &months[1];
    let last = in_zone(
        &place,
        "UTC0",
        &["faults", "stats", "--by", "month", "--limit", "1"],
    );
    let earlier = format!("… {} earlier months; see --limit\n", months.len() - 1);
    assert!(last.out.starts_with(&earlier), "{}", last.out);
    let this = text(&months.last().expect("months")["key"]);
    assert!(last.out.contains(&format!("\n{this} ")), "{}", last.out);
    assert_eq!(number(&march["mtbf_days"]), 31.0, "the whole of March");
    assert_eq!(number(&march["mttr_hours"]), 5.0 * 24.0);
    let all = &stats("part", &[])[0];
    for key in ["faults", "repairs", "closed", "occurrences"] {
        let sum: f64 = months.iter().map(|month| number(&month[key])).sum();
        assert_eq!(sum, number(&all[key]), "{key}");
    }

    let same = |by: &str, span: &str| {
        let mut rows = stats(by, &["--when", span]);
        for row in &mut rows {
            row["key"] = Value::Null;
            row["name"] = Value::Null;
        }
        rows
    };
    for span in ["2025-02", "2025-03", "2025-03-08..2025-03-20", "2025-04"] {
        assert_eq!(same("month", span), same("code", span), "{span}");
    }
    // No month is made up before the history or after today.
    for span in ["2999-01", "1990-01", "2999-01..", "..1990"] {
        assert!(stats("month", &["--when", span]).is_empty(), "{span}");
    }
    assert_eq!(stats("month", &["--when", "1800..2999"]), months);
}

#[test]
fn a_history_without_faults_has_no_months_of_them() {
    let place = Place::new();
    let history = store(&place);
    let by_month = ["faults", "stats", "--by", "month"];
    let said = |why: &str| {
        let said = place.ptu(&by_month).exits(0).out;
        assert_eq!(said, "no faults recorded\n", "{why}");
    };
    said("empty");
    record(&history, noon_us(2, 15), None);
    said("a run that passed");
}

/// Goal: what is counted by days of UTC has months of UTC. Method: west of Greenwich, 1 March there begins on
/// the last evening of February.
#[test]
fn months_of_a_fleet_are_named_as_they_are_counted() {
    let place = Place::new();
    record(&store(&place), noon_us(3, 1), None);
    for zone in ["EST5", "UTC0", "NZST-12"] {
        let said = in_zone(&place, zone, &["faults", "trend", "eb_reaction"]).out;
        assert!(
            said.contains("2025-03") && !said.contains("2025-02"),
            "{zone}: {said}"
        );
    }
}

#[test]
fn a_fault_is_said_to_be_seen_once_or_so_many_times() {
    let place = Place::new();
    let history = store(&place);
    for (day, said) in [(5, "  seen once, 2025-03-0"), (6, "  seen 2 times, ")] {
        let fault = record(&history, noon_us(3, day), Some("eb_relay")).expect("a fault");
        let shown = place.ptu(&["faults", "show", &fault.to_string()]).exits(0);
        assert!(shown.out.contains(said), "{}", shown.out);
    }
}

/// Goal: a month in which trains ran twice as far is not said to be twice as bad, and no distance counts that has no faults
/// beside it. Method: two trains with two faults in March, odometer readings of one of them, which ran 31 × 100 km.
#[test]
fn faults_are_told_for_each_10_000_km_of_the_trains_whose_distance_is_known() {
    within_a_day(told_for_each_10_000_km);
}

fn told_for_each_10_000_km() {
    let place = Place::new();
    let history = store(&place);
    for (train, part) in [("612", "eb_relay"), ("613", "tra")] {
        record_in(&history, train, noon_us(2, 15), None);
        record_in(&history, train, noon_us(3, 5), Some(part));
    }
    drop(history);
    let readings = "train,date,km\n612,2025-03-01,1000\n612,2025-04-01,4100\n999,2025-03-01,1\n999,2025-04-01,90001\n";
    let file = place.write("odometers.csv", readings);
    let stats = ["faults", "stats", "--by", "month", "--distances", &file];
    let told = in_zone(&place, "UTC0", &[&stats[..], &["--json"]].concat()).out;
    let told: Value = serde_json::from_str(&told).expect("a list");
    let of = |month: &str| {
        let rows = told.as_array().expect("rows").iter();
        let mut rows = rows.filter(|row| row["key"] == month);
        rows.next().expect("the month").clone()
    };
    let march = of("2025-03");
    assert_eq!(number(&march["faults"]), 2.0, "of both trains");
    assert_eq!(number(&march["distance_faults"]), 1.0, "of train 612");
    assert_eq!(number(&march["distance_trains"]), 1.0, "999 was never here");
    assert!(
        (number(&march["distance_km"]) - 3100.0).abs() < 1e-6,
        "{march}"
    );
    assert!(
        (number(&march["per_10000_km"]) - 10_000.0 / 3100.0).abs() < 1e-6,
        "{march}"
    );
    let february = of("2025-02");
    assert_eq!(february["per_10000_km"], Value::Null);
    assert_eq!(number(&february["distance_km"]), 0.0);
    let table = in_zone(&place, "UTC0", &stats).out;
    assert!(table.contains("3100") && table.contains("3.23"), "{table}");
    assert!(table.contains("PER 10000 KM: faults first seen"), "{table}");

    // What is wrong is told by its place, and nothing is computed of the rest.
    place.write("odometers.csv", &readings.replace("4100", "410O"));
    let refused = place.ptu(&stats).exits(2);
    refused.explains(&["odometers.csv", "line 3", "column 3", "km", "410O"]);
    let by_cause = ["faults", "stats", "--distances", &file];
    place.ptu(&by_cause).exits(2).explains(&["--by month"]);
    place
        .ptu(&[&stats[..], &["--serial-no", "U-1"]].concat())
        .exits(2);
}
