//! Runs that an embedded unit recorded, read over the wire, compared with a sound unit's.

use btu_rig::drive::{Drive, DrivePlan};
use fault_db::Store;

use super::*;
use crate::clock::open_options;
use crate::drive::{Case, Request, SectionChoice};
use crate::link::Pace;
use crate::stop::Stop;
use crate::test_support::scripts;
use crate::unit_log::{LogRead, Source, UnitReading, read_log};

const NOW_US: i64 = 1_000_000_000_000;

fn case(settings: &[&str]) -> Case {
    let directory = scripts();
    let request = Request {
        sections: Some(SectionChoice::One(61)),
        train: "line6".into(),
        unit_config: "sg100".into(),
        settings: settings
            .iter()
            .map(|text| text.parse().expect("a setting"))
            .collect(),
        seed: 1,
        ..Request::default()
    };
    request.cases(&directory).expect("a case").remove(0)
}

/// Drives a unit through its section and reads what it stored.
fn driven(case: &Case) -> LogRead {
    let mut bench = case.bench.fresh(case.seed);
    let plan = DrivePlan {
        tester: true,
        ..case.plan.clone()
    };
    let mut drive = Drive::new(plan);
    loop {
        bench.tick().expect("the embedded unit");
        let now = bench.now();
        if drive.step(now, &mut bench.rig).is_some() {
            break;
        }
    }
    let now = bench.now();
    let mut pace = Pace::Virtual;
    let stop = Stop::default();
    read_log(
        &mut bench.link,
        now,
        true,
        &mut pace,
        &stop,
        (&|| NOW_US, 500),
    )
    .expect("read")
}

fn only_run(read: &LogRead) -> RecordedRun {
    let stored = read.stored.as_ref().expect("stored memory");
    let runs = recorded_runs("SG-1", stored, Rest::Nothing);
    let [run] = &runs[..] else {
        panic!("{} runs", runs.len());
    };
    run.clone()
}

#[test]
fn a_sound_units_record_is_found_on_the_line_and_is_as_expected() {
    let case = case(&[]);
    let run = only_run(&driven(&case));
    assert!(!run.is_cut && !run.trace.gaps, "{}", run.summary());
    assert!(
        run.date.is_some(),
        "the unit was sent the time while it was read"
    );
    let line = &case.bench.line.content;
    assert_eq!(find_section(line, &run.trace).expect("found"), 61);
    let compared = compare(&run.trace, &case.plan.section, &case).expect("compared");
    assert!(
        compared.is_as_expected() && compared.late_m().is_none(),
        "{compared:?}"
    );
    let error_m = compared.stop.error_m.expect("at rest");
    assert!(error_m.abs() < 0.3, "{error_m}");
    let both = compared
        .run_time_s
        .zip(compared.twin_run_time_s)
        .expect("at rest");
    assert!((both.0 - both.1).abs() < 0.2, "{both:?}");
}

/// Goal: where a run parts, how it stops and how late it brakes is reported. Method: a unit that brakes by another
/// profile, held against the one it should have driven.
#[test]
fn a_unit_that_drives_another_profile_parts_from_the_sound_one() {
    let other = case(&["ato.controller=\"pss\""]);
    let run = only_run(&driven(&other));
    let sound = case(&[]);
    let compared = compare(&run.trace, &sound.plan.section, &sound).expect("compared");
    assert!(!compared.is_as_expected());
    let target = compared
        .partings
        .iter()
        .find(|parting| parting.signal == "target");
    let target = target.expect("its profile is another");
    assert!(
        target.against == "twin" && target.at_m < 10.0 && target.most_kmh > 20.0,
        "{target}"
    );
    assert!(
        compared
            .partings
            .windows(2)
            .all(|pair| pair[0].at_s <= pair[1].at_s)
    );
}

#[test]
fn pulling_a_record_again_adds_nothing_and_two_laptops_make_the_same_trace() {
    let read = driven(&case(&[]));
    let dir = tempfile::tempdir().expect("a directory");
    let open = |name: &str| Store::open(&dir.path().join(name), open_options()).expect("opened");
    let (a, b) = (open("a.db"), open("b.db"));
    let reading = |until_us| UnitReading {
        read: LogRead {
            mode: None,
            ..read.clone()
        },
        source: Source {
            endpoint: "serial:a".into(),
            serial: "SG-1".into(),
            config_name: "sg100".into(),
            line: "line8".into(),
            from_us: until_us - 1_000_000,
            until_us,
            ..Source::default()
        },
        clock: crate::clock::ClockState::Synchronised,
        warnings: Vec::new(),
    };
    let first = pull_reading(&a, &reading(2_000_000_000_000)).expect("stored");
    assert_eq!((first.new.len(), first.known), (1, 0));
    let again = pull_reading(&a, &reading(2_000_000_100_000)).expect("stored");
    assert_eq!((again.new.len(), again.known, again.run), (0, 1, None));
    let other = pull_reading(&b, &reading(2_000_500_000_000)).expect("stored");
    assert_eq!(other.new[0].id, first.new[0].id);
    for _ in 0..2 {
        a.merge_from(&b).expect("merged");
        b.merge_from(&a).expect("merged");
        for store in [&a, &b] {
            let report = store.check().expect("checked");
            assert!(report.problems.is_empty(), "{report:?}");
            assert_eq!(report.traces, 1);
        }
    }
    // A trace with another's name is that of the record: it can be held against what it should have been.
    let directory = scripts();
    let compared = CompareRequest::default().compare(&b, &directory, first.new[0].id);
    let compared = compared.expect("compared");
    assert_eq!(
        (compared.comparison.section, compared.line.as_str()),
        (61, "line8")
    );
    assert!(compared.comparison.is_as_expected(), "{compared:?}");
}
