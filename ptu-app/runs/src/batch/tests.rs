use std::path::{Path, PathBuf};

use super::file::RunsFile;
use super::record::{Found, head_record, of_run};
use super::*;

fn head(scripts: &str, runs: usize) -> Head {
    let names = (0..runs).map(|number| format!("run {number}")).collect();
    let plan = Plan {
        what: format!("{runs} runs"),
        names,
        seeds: None,
    };
    Head::new(scripts, plan)
}

/// Result of the run with this number, whoever makes it.
fn result(number: usize) -> Vec<String> {
    vec![number.to_string(); number % 5]
}

/// Makes the runs of a head into a file, by several threads that finish in any order.
fn made(
    file: &Path,
    head: &Head,
    shard: Option<Shard>,
) -> Result<BatchResult<Vec<String>>, Failure> {
    let keep = Keep {
        file: Some(file.to_owned()),
        shard,
    };
    let stop = Stop::default();
    make(&keep, head.clone(), (3, &stop), &mut |_| {}, |number| {
        Some(result(number))
    })
}

/// Files of all shards of a head, in a folder.
fn shards(folder: &Path, head: &Head, of: u32) -> Vec<PathBuf> {
    let one = |number| {
        let file = folder.join(format!("shard-{number}-{of}"));
        let made = made(&file, head, Some(Shard { number, of })).expect("a shard");
        assert!(matches!(made, BatchResult::Part(_)));
        file
    };
    (1..=of).map(one).collect()
}

/// Goal: who made which runs on how many machines, and in which order their files are put together, changes no byte.
/// Method: 7 shards, forwards, backwards, in two steps, one of them twice, against one process.
#[test]
fn shards_in_any_order_are_the_file_of_one_process() {
    let folder = tempfile::tempdir().expect("a folder");
    let head = head("a", 40);
    let whole = folder.path().join("whole");
    let BatchResult::All(runs) = made(&whole, &head, None).expect("one process") else {
        panic!("not all runs")
    };
    assert_eq!(runs, (0..40).map(result).collect::<Vec<_>>());
    let whole = std::fs::read(whole).expect("its file");
    let mut files = shards(folder.path(), &head, 7);
    let merged = merge(&files).expect("merged");
    assert_eq!((merged.runs, merged.all), (40, 40));
    assert!(merged.bytes == whole, "forwards");
    files.reverse();
    files.push(files[3].clone());
    assert!(
        merge(&files).expect("merged").bytes == whole,
        "backwards, one twice"
    );
    let half = folder.path().join("half");
    std::fs::write(&half, merge(&files[..4]).expect("half").bytes).expect("written");
    let rest: Vec<_> = [&[half.clone(), half][..], &files[2..]].concat();
    assert!(merge(&rest).expect("merged").bytes == whole, "in two steps");
    let file = folder.path().join("merged");
    std::fs::write(&file, merged.bytes).expect("written");
    let BatchResult::All(again) = made(&file, &head, None).expect("read") else {
        panic!("not all runs")
    };
    assert_eq!(again, runs);
    assert!(
        std::fs::read(&file).expect("its file") == whole,
        "read again"
    );
}

/// Goal: a shard that was killed goes on and ends with the bytes of one that was not; what it lacks until then is reported.
#[test]
fn a_killed_shard_goes_on_and_what_it_lacks_is_listed() {
    let folder = tempfile::tempdir().expect("a folder");
    let head = head("a", 40);
    let files = shards(folder.path(), &head, 7);
    assert_eq!(missing(&files, None).expect("read").missing, 0);
    let third = std::fs::read(&files[2]).expect("its file");
    std::fs::write(&files[2], &third[..third.len() - 3]).expect("cut");
    let lacks = missing(&files[..6], None).expect("read");
    assert_eq!((lacks.missing, lacks.runs, lacks.shards), (6, 40, 7));
    let of: Vec<_> = (lacks.of_shards.iter())
        .map(|one| (one.shard, one.missing, one.runs))
        .collect();
    // Runs 2, 9, … 37 are the third shard's, six of them; 6, 13, … 34 the seventh's, five.
    assert_eq!(of, [(3, 1, 6), (7, 5, 5)]);
    assert!(lacks.damage[0].contains("shard-3-7: record"), "{lacks:?}");
    let refused = merge(&files).map(drop).expect_err("not whole").to_string();
    assert!(
        refused.contains("shard-3-7: record 7, the last"),
        "{refused}"
    );
    assert!(refused.contains("its own command once more"), "{refused}");
    made(&files[2], &head, Some(Shard { number: 3, of: 7 })).expect("goes on");
    assert!(std::fs::read(&files[2]).expect("its file") == third);
    assert_eq!(merge(&files).expect("merged").runs, 40);
}

#[test]
fn a_file_that_does_not_belong_to_the_others_is_named_with_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut files = shards(folder.path(), &head("a", 40), 2);
    let of = |name: &str, head: &Head| {
        let file = folder.path().join(name);
        made(&file, head, None).expect("made");
        file
    };
    let text = folder.path().join("notes.txt");
    std::fs::write(&text, "no such file").expect("written");
    let nothing = folder.path().join("nothing");
    std::fs::write(&nothing, "").expect("written");
    let mut newer = head("a", 40);
    newer.app_version = "99.0.0".into();
    let changed = folder.path().join("changed");
    let other_result = of_run("run 3".into(), &["other"]);
    let with_other = [head_record(&head("a", 40)), other_result].concat();
    std::fs::write(&changed, with_other).expect("written");
    for (alien, words) in [
        (
            of("more", &head("a", 41)),
            "its 41 runs are of another campaign (41 runs), unlike",
        ),
        (
            of("scripts", &head("b", 40)),
            "by another program or with other scripts, unlike",
        ),
        (of("newer", &newer), "made by version 99.0.0, not "),
        (text, "it does not begin as a file of runs"),
        (nothing, "it is empty"),
        (folder.path().join("none"), "cannot read"),
        (changed, "its run run 3 has another result than in"),
    ] {
        files.push(alien.clone());
        let refused = merge(&files).map(drop).expect_err("refused").to_string();
        assert!(refused.contains(words), "{refused}");
        assert!(refused.contains(&alien.display().to_string()), "{refused}");
        files.pop();
    }
}

#[test]
fn a_run_is_kept_for_its_name_alone_and_for_its_scripts_alone() {
    let folder = tempfile::tempdir().expect("a folder for the test");
    let file = folder.path().join("runs");
    let head = head("a", 9);
    let open = |head: &Head| RunsFile::open::<Vec<String>>(&file, head);
    let (_, appended) = open(&head).expect("no file yet");
    for number in 1..9 {
        assert!(appended.append(&of_run(head.plan.name(number), &result(number))));
    }
    let twice = open(&head).map(drop).expect_err("two at once");
    assert!(twice.to_string().contains("another campaign"), "{twice}");
    drop(appended);
    // Another plan of the same scripts finds the runs that it has in common with this one.
    let (mut read, appended) = open(&self::head("a", 12)).expect("read");
    assert!(!read.contains_key("run 0") && !read.contains_key("run 10"));
    for number in 1..9 {
        assert_eq!(read.remove(&head.plan.name(number)), Some(result(number)));
    }
    drop(appended);
    let other = open(&self::head("b", 9)).map(drop);
    assert!(
        other
            .expect_err("others")
            .to_string()
            .contains("other scripts")
    );
    std::fs::write(&file, "no such file").expect("written");
    assert!(open(&head).is_err());
    let left = std::fs::read(&file).expect("its bytes");
    assert_eq!(left, b"no such file", "another file stays as it is");
}

/// Goal: a kill and a damaged bit cost runs, and never change one. Method: a file of a few runs, cut at each
/// length, and with each of its bits the other way.
#[test]
fn a_damaged_file_gives_the_runs_put_in_or_fewer_and_names_the_record() {
    let head = head("a", 4);
    let of_run = |number: usize| of_run(head.plan.name(number), &result(number));
    let first = head_record(&head);
    let records: Vec<Vec<u8>> = std::iter::once(first.clone())
        .chain((0..4).map(of_run))
        .collect();
    let whole = records.concat();
    let is_right = |found: &Found<Vec<String>>| {
        let is_kept = |number: &usize| {
            let run = found.runs.get(&head.plan.name(*number));
            run.is_some_and(|(run, _)| *run == result(*number))
        };
        (0..4).filter(is_kept).count() == found.runs.len()
    };
    let ends: Vec<_> = records
        .iter()
        .scan(0, |end, record| {
            *end += record.len();
            Some(*end)
        })
        .collect();
    for length in first.len()..whole.len() {
        let complete = ends.iter().filter(|end| **end <= length).count();
        let found = Found::read(&whole[..length]).expect("a file that was cut is gone on with");
        assert!(is_right(&found));
        assert_eq!(found.runs.len(), complete - 1, "cut at {length}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("cut");
    for length in 0..first.len() {
        std::fs::write(&file, &whole[..length]).expect("written");
        drop(RunsFile::open::<Vec<String>>(&file, &head).expect("begun again"));
        assert!(
            std::fs::read(&file).expect("its bytes") == first,
            "cut at {length}"
        );
    }
    for bit in 0..whole.len() * 8 {
        let mut damaged = whole.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        let number = 1 + ends
            .iter()
            .position(|end| bit / 8 < *end)
            .expect("a record");
        match Found::read(&damaged) {
            Err(why) => assert!(number == 1, "bit {bit} of record {number}: {why}"),
            Ok(found) => {
                assert!(number > 1 && is_right(&found), "bit {bit}");
                assert_eq!(found.runs.len(), 3, "bit {bit} of record {number}");
                let told = &found.told[0];
                assert!(told.starts_with(&format!("record {number}")), "{told}");
            }
        }
    }
}
