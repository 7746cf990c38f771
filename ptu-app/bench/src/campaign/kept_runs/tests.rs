use protocol::injection::FaultMode;

use super::super::{Purpose, Request, samples};
use super::*;
use crate::test_support::scripts;

fn drawn(modes: &[FaultMode], units: u32) -> Vec<Sample> {
    let asked = Request {
        faults: None,
        seeds: 1,
        held_out: 1,
        good: 2,
        leave_out: None,
        pairs: 40,
        common: 0,
        other_spells: true,
        units,
        jobs: 1,
        kept: None,
    };
    samples(&modes.iter().collect::<Vec<_>>(), &[], &asked)
}

fn run(number: usize) -> SuiteRun {
    SuiteRun {
        not_passed: vec![number.to_string()],
        ..SuiteRun::default()
    }
}

fn basis() -> Basis {
    Basis {
        sha256: "a".into(),
        ..Basis::default()
    }
}

#[test]
fn a_run_is_kept_for_its_sample_alone_and_for_its_scripts_alone() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let file = folder.path().join("runs");
    let modes = scripts().faults().expect("fault modes").faults;
    let all = drawn(&modes, 0);
    let kept = KeptRuns::open(&file, &basis()).expect("no file yet");
    let appended = kept.file().expect("its file");
    for (number, sample) in all.iter().enumerate().skip(1) {
        assert!(appended.append(sample, &run(number)));
    }
    let twice = KeptRuns::open(&file, &basis())
        .map(drop)
        .expect_err("two at once");
    assert!(twice.message.contains("another campaign"), "{twice}");
    drop(kept);
    let mut read = KeptRuns::open(&file, &basis()).expect("read");
    assert!(drawn(&modes, 1).iter().all(|other| !read.has(other)));
    assert_eq!(read.take(&all[0]), None);
    for (number, sample) in all.iter().enumerate().skip(1) {
        assert_eq!(read.take(sample), Some(run(number)), "{sample:?}");
    }
    drop(read);
    let other = KeptRuns::open(&file, &Basis::default()).map(drop);
    assert!(other.expect_err("others").message.contains("other scripts"));
    std::fs::write(&file, "no such file").expect("written");
    assert!(KeptRuns::open(&file, &basis()).is_err());
    let left = std::fs::read(&file).expect("its bytes");
    assert_eq!(left, b"no such file", "another file stays as it is");
}

/// Goal: a kill and a damaged bit cost runs, and never change one. Method: a file of a few runs, cut at each
/// length, and with each of its bits the other way.
#[test]
fn a_damaged_file_gives_the_runs_put_in_or_fewer_and_names_the_record() {
    let modes = scripts().faults().expect("fault modes").faults;
    let all = drawn(&modes, 0);
    let records: Vec<Vec<u8>> = std::iter::once(record(&basis()))
        .chain((0..4).map(|number| {
            let sample = key(&all[number]);
            record(&KeptRun {
                sample,
                run: run(number),
            })
        }))
        .collect();
    let whole = records.concat();
    let is_right = |found: &Found| {
        let is_kept = |number| found.runs.get(&key(&all[number])) == Some(&run(number));
        (0..4).filter(|number| is_kept(*number)).count() == found.runs.len()
    };
    for length in 0..whole.len() {
        let ends = records.iter().scan(0, |end, record| {
            *end += record.len();
            Some(*end)
        });
        let complete = ends.filter(|end| *end <= length).count();
        let found = Found::read(&whole[..length], &basis());
        let found = found.expect("a file that was cut is gone on with");
        assert!(is_right(&found));
        assert_eq!(
            found.runs.len(),
            complete.saturating_sub(1),
            "cut at {length}"
        );
    }
    for bit in 0..whole.len() * 8 {
        let mut damaged = whole.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        let place = bit / 8;
        let mut ends = records.iter().scan(0, |end, record| {
            *end += record.len();
            Some(*end)
        });
        let number = 1 + ends.position(|end| place < end).expect("a record");
        match Found::read(&damaged, &basis()) {
            Err(why) => assert!(number == 1, "bit {bit} of record {number}: {why}"),
            Ok(found) => {
                assert!(number > 1 && is_right(&found), "bit {bit}");
                assert_eq!(found.runs.len(), 3, "bit {bit} of record {number}");
                assert!(
                    found.told[0].starts_with(&format!("record {number}")),
                    "{:?}",
                    found.told
                );
            }
        }
    }
}

#[test]
fn two_faults_of_a_unit_are_of_different_parts_and_assess_only() {
    let modes = scripts().faults().expect("fault modes").faults;
    let drawn = drawn(&modes, 0);
    let pairs: Vec<_> = drawn.iter().filter(|s| s.faults.len() == 2).collect();
    assert_eq!(pairs.len(), 40);
    for pair in pairs {
        assert_eq!(pair.purpose, Purpose::Assessment);
        assert_ne!(pair.faults[0].lru, pair.faults[1].lru);
    }
}
