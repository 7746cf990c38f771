//! Programs that are killed, at any of their writes and at any time: nothing is lost that they told.

use std::os::unix::process::ExitStatusExt as _;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use fuzzing::{amount, seed};
use protocol::Random;
use rustix::process::Signal;

use super::histories::{Base, Victim, victims};
use super::system_calls::{CALLS, Deed, strace, traced};
use crate::common::{Place, Said, list, record_bad_unit};
use crate::server::owner_only::shared;

/// A program is run so often undisturbed to know how long it takes at least.
const TIMED: u32 = 3;

/// Counts of kills of one program.
#[derive(Default)]
struct Kills {
    at_writes: u32,
    at_times: u32,
    over: u32,
}

/// Goal: whenever a program is killed, the history opens, passes its checks, and holds all that the program told. Method:
/// killed at one write after the other, and as often at random times.
#[test]
#[ignore = "long suite: a campaign of kills"]
fn a_program_that_is_killed_loses_nothing_that_it_told() {
    let base = Base::new();
    let mut random = Random::new(seed());
    let victims = victims(&base);
    let of_each = amount(16) / victims.len() as u64;
    println!("program    at a write  at a time  over before");
    for victim in &victims {
        let mut kills = Kills::default();
        let (writes, time) = (writes(victim, &base), shortest(victim, &base));
        for kill in 0..of_each {
            let place = base.copy();
            let program = victim.command(&place);
            let is_at_write = kill % 2 == 0;
            let output = if is_at_write {
                let turn = (kill / 2) as usize * (writes / of_each.div_ceil(2) as usize).max(1);
                killed_at(1 + turn % writes, &program)
            } else {
                killed_after(time.mul_f64(random.unit()), program)
            };
            match output.status.signal() {
                None => kills.over += 1,
                Some(_) if is_at_write => kills.at_writes += 1,
                Some(_) => kills.at_times += 1,
            }
            let said = Said::from(output);
            let found = victim.judge(&place.path(""), &said.out, &said.err);
            assert!(
                found.is_empty(),
                "{}: {found:#?}\ntold: {}",
                victim.name,
                said.all()
            );
        }
        let Kills {
            at_writes,
            at_times,
            over,
        } = kills;
        println!(
            "{:10} {at_writes:>10} {at_times:>10} {over:>12}",
            victim.name
        );
        assert!(at_writes > 0, "{}", victim.name);
    }
}

/// Least time that the program takes undisturbed.
fn shortest(victim: &Victim, base: &Base) -> Duration {
    let times = (0..TIMED).map(|_| {
        let place = base.copy();
        let began = Instant::now();
        victim.command(&place).output().expect("ptu starts");
        began.elapsed()
    });
    times.min().unwrap_or_default()
}

/// Number of writes that the program makes to its files.
fn writes(victim: &Victim, base: &Base) -> usize {
    let place = base.copy();
    let (_, deeds) = traced(&victim.command(&place), &base.path(""));
    let is_write = |deed: &&Deed| matches!(deed, Deed::Write { .. }) && deed.is_in(&place.path(""));
    deeds.iter().filter(is_write).count().max(1)
}

/// Kills a program at its `n`th call of one kind, counted in each thread; `strace` ends by the same signal.
fn killed_at(n: usize, program: &Command) -> Output {
    let inject = format!("inject={CALLS}:signal=KILL:when={n}");
    strace(&["-q", "-o", "/dev/null", "-e", &inject], program)
        .output()
        .expect("strace (Debian package strace) runs")
}

fn killed_after(time: Duration, mut program: Command) -> Output {
    let piped = program.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = piped.spawn().expect("ptu starts");
    sleep(time);
    let _ = child.kill();
    child.wait_with_output().expect("its end")
}

/// Goal: a sync that is killed at any time is taken up by the next: all rows are on the server once. Method: killed at random
/// times, then synced.
#[test]
#[ignore = "long suite: a campaign of kills"]
fn a_sync_that_is_killed_is_taken_up() {
    let server = shared().database();
    let place = Place::new();
    let mut random = Random::new(seed());
    record_bad_unit(&place);
    let sync = ["db", "sync", &server, "--json"];
    let began = Instant::now();
    place.json(&sync);
    let time = began.elapsed();
    let (mut killed, mut over, mut notes) = (0, 0, 0);
    for _ in 0..amount(2) {
        place.ptu("runs note latest 'one more' --who Kim").exits(0);
        let output = killed_after(time.mul_f64(0.7 * random.unit()), place.command(&sync));
        match output.status.signal() {
            Some(signal) if signal == Signal::KILL.as_raw() => killed += 1,
            _ => over += 1,
        }
        let synced = place.json(&sync);
        assert_eq!(synced["waiting"], 0, "{synced}");
        let shown = "runs show latest --json";
        let here = place.json(shown);
        let there = place.json(&format!("{shown} --db {server}"));
        assert_eq!(here, there, "in the file and on the server");
        notes += 1;
        assert_eq!(list(&here["notes"]).len(), notes);
    }
    println!("sync: {killed} killed, {over} over before");
}
