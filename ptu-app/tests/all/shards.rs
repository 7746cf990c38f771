//! Many runs divided among machines: campaigns and drives in shards, put together again.

use std::process::{Child, Stdio};
use std::time::Duration;

use crate::common::{Place, Said};
use crate::server::owner_only::{name_of, shared};

const SHARDS: usize = 3;

/// A small campaign, or a small Monte Carlo series of two cases.
const CAMPAIGN: [&str; 12] = [
    "campaign",
    "--harness",
    "none",
    "--faults",
    "eb_relay.slow",
    "--seeds",
    "1",
    "--held-out",
    "1",
    "--good",
    "4",
    "--json",
];
const DRIVE: [&str; 7] = [
    "drive",
    "--monte-carlo",
    "6",
    "--seed",
    "40",
    "--compare",
    "servo,pi",
];

fn said(place: &Place, command: &[&str], more: &[&str]) -> Said {
    place.ptu(&[command, more].concat())
}

/// Makes a shard with a scheduler's variable, as an array job does.
fn shard(place: &Place, command: &[&str], number: usize) -> String {
    let file = format!("shard-{number}.zst");
    let auto = format!("auto/{SHARDS}");
    let mut command = place.command(&[command, &["--shard", &auto, "--runs", &file]].concat());
    // Nodes of a cluster have no history.
    command.env("PTU_DB", "/nonexistent/history.db");
    let number = number.to_string();
    let made = command.env("SLURM_ARRAY_TASK_ID", number).output();
    Said::from(made.expect("ptu starts"))
        .exits(0)
        .prints(&[&file]);
    file
}

fn shards_are_one_process(place: &Place, command: &[&str]) {
    let whole = said(place, command, &["--runs", "whole.zst", "--jobs", "2"]);
    assert!(matches!(whole.code, Some(0 | 1)), "{}", whole.all());
    let files: Vec<_> = (1..=SHARDS)
        .rev()
        .map(|number| shard(place, command, number))
        .collect();
    let names: Vec<_> = files.iter().map(String::as_str).collect();
    let missing = |files: &[&str]| place.ptu(&[&["campaign", "missing"], files].concat());
    missing(&names).exits(0).prints(&["0 of"]);
    let last = [
        format!("shard {SHARDS}/{SHARDS}"),
        format!("--array={SHARDS}"),
    ];
    missing(&names[1..])
        .exits(1)
        .prints(&last.each_ref().map(String::as_str));
    let merged = [
        &["campaign", "merge", names[1]],
        &names[..],
        &["--out", "merged.zst"],
    ]
    .concat();
    place.ptu(&merged).exits(0);
    let bytes = |name: &str| std::fs::read(place.path(name)).expect("a file of runs");
    assert!(bytes("merged.zst") == bytes("whole.zst"));
    // Nothing is made again, and the result is that of one process.
    let again = said(place, command, &["--runs", "merged.zst"]);
    assert_eq!((again.code, again.out), (whole.code, whole.out));
    assert!(bytes("merged.zst") == bytes("whole.zst"));
}

/// Goal: a campaign on many machines is a campaign. Method: shards, the last one first, one of them named twice, against
/// one process: bytes of the file, and the answer.
#[test]
fn a_campaign_in_shards_is_one_campaign() {
    shards_are_one_process(&Place::with_database(), &CAMPAIGN);
}

#[test]
fn drives_in_shards_are_one_series() {
    shards_are_one_process(&Place::new(), &DRIVE);
}

#[test]
fn what_cannot_be_a_shard_is_said_with_what_to_do() {
    let place = Place::new();
    said(&place, &CAMPAIGN, &["--shard", "3/2", "--runs", "a.zst"])
        .exits(2)
        .explains(&["no shard 3/2"]);
    said(&place, &CAMPAIGN, &["--shard", "auto", "--runs", "a.zst"])
        .exits(2)
        .explains(&["SLURM_ARRAY_TASK_ID", "write --shard 3/64"]);
    said(&place, &CAMPAIGN, &["--shard", "1/2"])
        .exits(2)
        .explains(&["--runs"]);
    place
        .ptu("drive --runs a.zst")
        .exits(2)
        .explains(&["go with --monte-carlo"]);
    // A file of drives does not belong to a campaign.
    let one = ["--shard", "1/12", "--runs"];
    said(&place, &DRIVE, &[&one[..], &["drives.zst"]].concat()).exits(0);
    said(&place, &CAMPAIGN, &[&one[..], &["drives.zst"]].concat())
        .exits(2)
        .explains(&["drives.zst", "by another program or with other scripts"]);
    said(&place, &CAMPAIGN, &[&one[..], &["suite.zst"]].concat()).exits(0);
    place
        .ptu("campaign merge suite.zst drives.zst --out m.zst")
        .exits(2)
        .explains(&["drives.zst: ", "unlike those of suite.zst", "leave one"]);
}

/// Goal: workers that are killed lose no run and change none. Method: 20 workers, four at a time, on one queue; each tenth is
/// killed while it has a run; the result is that of one process.
#[test]
fn a_queue_whose_workers_are_killed_gives_what_one_process_gives() {
    let place = Place::new();
    let command = [
        "drive",
        "--monte-carlo",
        "60",
        "--seed",
        "40",
        "--compare",
        "servo,pi",
    ];
    let whole = said(&place, &command, &["--runs", "whole.zst"]);
    let queue = shared().empty();
    let options = ["--queue", &queue, "--lease", "2", "--jobs", "1"];
    let worker = || -> Child {
        let mut worker = place.command(&[&command[..], &options].concat());
        let worker = worker.stdout(Stdio::null()).stderr(Stdio::null());
        worker.spawn().expect("started")
    };
    let mut client = shared().client(name_of(&queue));
    let mut count = |what: &str| {
        let rows = client.query(&format!("SELECT 1 FROM ptu_queue.run WHERE {what}"), &[]);
        // Before the first worker there is no table.
        rows.map_or(0, |rows| rows.len())
    };
    let lent = "record IS NULL AND lent_until > now()";
    for killed in 1..=2 {
        let before = count(lent);
        let mut worker = worker();
        while count(lent) <= before {
            let over = worker.try_wait().expect("asked");
            assert!(over.is_none(), "it left no run to be killed at");
            std::thread::sleep(Duration::from_millis(1));
        }
        worker.kill().expect("killed");
        worker.wait().expect("over");
        assert!(
            count("tries > 0 AND record IS NULL") > 0,
            "killed {killed} after its run"
        );
    }
    for _ in 0..4 {
        let mut four: Vec<_> = (0..4).map(|_| worker()).collect();
        for worker in &mut four {
            assert!(worker.wait().expect("over").success());
        }
    }
    assert_eq!(count("record IS NULL"), 0);
    assert!(count("tries > 1") > 0, "no run was lent twice");
    let last = said(
        &place,
        &command,
        &[&options[..], &["--runs", "queue.zst"]].concat(),
    );
    assert_eq!((last.code, last.out), (whole.code, whole.out));
    let bytes = |name: &str| std::fs::read(place.path(name)).expect("a file of runs");
    assert!(bytes("queue.zst") == bytes("whole.zst"));
}

/// Goal: a run that ends every worker ends the queue with its name, and does not go round for ever. Method: a run whose
/// workers all were lost, as the table says.
#[test]
fn a_run_that_never_comes_back_is_named() {
    let place = Place::new();
    let queue = shared().empty();
    let on_queue = ["--queue", &queue];
    said(&place, &DRIVE, &on_queue)
        .exits(0)
        .prints(&["12 of them from here"]);
    let mut client = shared().client(name_of(&queue));
    let lost =
        "UPDATE ptu_queue.run SET record = NULL, tries = 5, lent_until = now() WHERE number = 7";
    client.batch_execute(lost).expect("changed");
    said(&place, &DRIVE, &on_queue).exits(3).explains(&[
        "run 7 of the queue (section 61 pi seed 41)",
        "5 times",
        "--lease",
    ]);
    // Records that another program wrote are not taken for runs.
    let damaged = "UPDATE ptu_queue.run SET record = 'no record' WHERE record IS NULL";
    client.batch_execute(damaged).expect("changed");
    let whole = said(&place, &DRIVE, &["--runs", "whole.zst"]);
    let last = said(
        &place,
        &DRIVE,
        &[&on_queue[..], &["--runs", "queue.zst"]].concat(),
    );
    assert_eq!((last.code, last.out), (whole.code, whole.out));
}
