//! Many runs divided among machines: campaigns and drives in shards, put together again.

use crate::common::{Place, Said};

const SHARDS: usize = 3;

/// A small campaign, or a small Monte Carlo series of two cases.
const CAMPAIGN: &str =
    "campaign --harness none --faults eb_relay.slow --seeds 1 --held-out 1 --good 4 --json";
const DRIVE: &str = "drive --monte-carlo 6 --seed 40 --compare servo,pi";

fn said(place: &Place, command: &str, more: &str) -> Said {
    place.ptu(&format!("{command} {more}"))
}

/// Makes a shard with a scheduler's variable, as an array job does.
fn shard(place: &Place, command: &str, number: usize) -> String {
    let file = format!("shard-{number}.zst");
    let shard = format!("{command} --shard auto/{SHARDS} --runs {file}");
    let mut command = place.command(&shard);
    // Nodes of a cluster have no history.
    command.env("PTU_DB", "/nonexistent/history.db");
    let number = number.to_string();
    let made = command.env("SLURM_ARRAY_TASK_ID", number).output();
    Said::from(made.expect("ptu starts"))
        .exits(0)
        .prints(&[&file]);
    file
}

fn shards_are_one_process(place: &Place, command: &str) {
    let whole = said(place, command, "--runs whole.zst --jobs 2");
    assert!(matches!(whole.code, Some(0 | 1)), "{}", whole.all());
    let files: Vec<_> = (1..=SHARDS)
        .rev()
        .map(|number| shard(place, command, number))
        .collect();
    let missing = |files: &[String]| place.ptu(&format!("campaign missing {}", files.join(" ")));
    missing(&files).exits(0).prints(&["0 of"]);
    let last = [
        format!("shard {SHARDS}/{SHARDS}"),
        format!("--array={SHARDS}"),
    ];
    missing(&files[1..])
        .exits(1)
        .prints(&last.each_ref().map(String::as_str));
    let (twice, all) = (&files[1], files.join(" "));
    let merged = format!("campaign merge {twice} {all} --out merged.zst");
    place.ptu(&merged).exits(0);
    let bytes = |name: &str| std::fs::read(place.path(name)).expect("a file of runs");
    assert!(bytes("merged.zst") == bytes("whole.zst"));
    // Nothing is made again, and the result is that of one process.
    let again = said(place, command, "--runs merged.zst");
    assert_eq!((again.code, again.out), (whole.code, whole.out));
    assert!(bytes("merged.zst") == bytes("whole.zst"));
}

/// Goal: a campaign on many machines is a campaign. Method: shards, the last one first, one of them named twice, against
/// one process: bytes of the file, and the answer.
#[test]
fn a_campaign_in_shards_is_one_campaign() {
    shards_are_one_process(&Place::with_database(), CAMPAIGN);
}

#[test]
fn drives_in_shards_are_one_series() {
    shards_are_one_process(&Place::new(), DRIVE);
}
