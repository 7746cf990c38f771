//! Laptops that all come back to the depot in the same evening: each syncs in a process of its own, some of these
//! are killed in the middle, and so is the server.

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

mod compare;

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader};
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard};
use std::thread;
use std::time::{Duration, Instant};

use fault_db::{FaultState, StoreError, SyncProgress};

use crate::common::{Deeds, Random, refused, repair_of};
use crate::laptop::{Laptop, as_owner, connect, day, open_faults, record, sync};
use crate::private::{Cluster, NO_HURRY, name_of, shared};
use compare::Same;

const FILE: &str = "PTU_TEST_LAPTOP_FILE";
const ADDRESS: &str = "PTU_TEST_LAPTOP_ADDRESS";
const NAME: &str = "PTU_TEST_LAPTOP_NAME";
/// Before each line in which a process says how far its sync is.
const SYNC: &str = "sync: ";
/// Beginning of a failure's line if the server took no more connections, or kept the laptop waiting for too long.
const BUSY: &str = "busy";

/// Laptops in the check.
const LAPTOPS: u64 = 8;
/// Runs of each of them, with two faults and two traces each.
const RUNS: i64 = 6;
/// Batches that each of them sends: one of rows, one of traces.
const BATCHES: usize = 2;
/// One in so many laptops is killed in the middle of a sync.
const ONE_KILLED_IN: usize = 10;
/// Lines of a process before one of which it is killed: begun, rows sent, traces sent.
const STAGES: u64 = 3;
/// A process is killed so long after such a line, at most, ms.
const LATEST_KILL_MS: u64 = 60;
/// Number of times the server is killed and started again.
const RESTARTS: usize = 2;
/// Shortest time for which a laptop is away.
const AWAY: Duration = Duration::from_secs(1);
/// A technician tries again after so long, at least, and at most twice as long, ms: when the server was away,
const MOMENT_MS: u64 = 1_000;
/// and when it was busy. All laptops share one machine with the server here, and each try costs time of it.
const LATER_MS: u64 = 8_000;
/// Limit of the whole campaign, which would not end if the server did not come back.
const PATIENCE: Duration = Duration::from_secs(900);
/// 99 of 100 completed syncs take no longer than this.
const P99_GOAL: f64 = 10.0;

/// One sync, in a process of its own: this test program again, with a file and an address.
#[test]
fn the_laptop_that_syncs() {
    let (Some(file), Ok(address), Ok(name)) = (
        std::env::var_os(FILE),
        std::env::var(ADDRESS),
        std::env::var(NAME),
    ) else {
        return;
    };
    println!("{SYNC}begun");
    let mut go_on = |progress: SyncProgress| {
        println!("{SYNC}{:?}", progress.phase);
        true
    };
    match sync(Path::new(&file), &address, &name, &mut go_on) {
        Ok(()) => println!("{SYNC}completed"),
        // The message says to try again, which is what this laptop will do.
        Err(error) if error.to_string().contains("try again") => {
            println!("{SYNC}failed {}", in_short(&error));
        }
        Err(error) => println!("{SYNC}stopped {error}"),
    }
}

/// Work during which the error came, and the message of server or network.
fn in_short(error: &StoreError) -> String {
    match error {
        StoreError::ServerUnreachable { doing, reason, .. } => format!("away, {doing}: {reason}"),
        StoreError::ServerBusy { doing, reason, .. } => format!("{BUSY}, {doing}: {reason}"),
        other => other.to_string(),
    }
}

/// Counts of the evening.
#[derive(Default)]
struct Tally {
    begun: u32,
    /// Batches of rows or traces that reached the server.
    batches: usize,
    /// Seconds of each completed sync, its process included.
    completed: Vec<f64>,
    killed: u32,
    /// Numbers of failures by the message that the laptop got.
    failed: BTreeMap<String, u32>,
}

impl Tally {
    fn failures(&self) -> u32 {
        self.failed.values().sum()
    }
}

/// End of a sync's process.
enum End {
    Completed,
    Killed,
    Failed(String),
}

/// When a process is killed.
#[derive(Clone, Copy)]
struct Kill {
    stage: usize,
    after: Duration,
}

/// Where the laptops come back to.
struct Depot {
    address: String,
    laptops: usize,
    begun: Instant,
    tally: Mutex<Tally>,
}

impl Depot {
    fn tally(&self) -> MutexGuard<'_, Tally> {
        self.tally.lock().expect("nobody else panicked here")
    }

    /// A laptop syncs, and tries again, until all is sent. One that is to be killed goes on to record and sync until
    /// it was.
    fn evening(&self, laptop: &Laptop, number: usize) {
        let mut random = Random::new(fuzzing::seed() * 1_000_003 + number as u64);
        let mut is_to_be_killed = number.is_multiple_of(ONE_KILLED_IN);
        loop {
            let waited = self.begun.elapsed();
            assert!(waited < PATIENCE, "{}: no end of trying", laptop.name);
            let kill = is_to_be_killed.then(|| Kill {
                stage: (random.next() % STAGES) as usize,
                after: Duration::from_millis(random.next() % LATEST_KILL_MS),
            });
            self.tally().begun += 1;
            let begun = Instant::now();
            let mut moment_ms = MOMENT_MS;
            match self.sync(laptop, kill) {
                End::Completed => {
                    self.tally().completed.push(begun.elapsed().as_secs_f64());
                    if !is_to_be_killed {
                        return;
                    }
                    laptop.run("U-0", day(RUNS), &[107], true);
                }
                End::Killed => {
                    self.tally().killed += 1;
                    is_to_be_killed = false;
                }
                End::Failed(told) => {
                    if told.starts_with(BUSY) {
                        moment_ms = LATER_MS;
                    }
                    *self.tally().failed.entry(told).or_default() += 1;
                }
            }
            moment_ms += random.next() % moment_ms;
            thread::sleep(Duration::from_millis(moment_ms));
        }
    }

    /// One sync in a process of its own.
    fn sync(&self, laptop: &Laptop, kill: Option<Kill>) -> End {
        let exe = std::env::current_exe().expect("this program");
        let mut process = Command::new(exe)
            .args(["--exact", "many_laptops::the_laptop_that_syncs"])
            .arg("--nocapture")
            .env(FILE, laptop.path())
            .env(ADDRESS, &self.address)
            .env(NAME, laptop.name)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("a process");
        let output = BufReader::new(process.stdout.take().expect("its output"));
        let lines = output.lines().map_while(Result::ok);
        let said = lines.filter_map(|line| Some(line.split_once(SYNC)?.1.to_owned()));
        let mut last = String::new();
        for (stage, line) in said.enumerate() {
            if let Some(kill) = kill.filter(|kill| kill.stage == stage) {
                thread::sleep(kill.after);
                process.kill().expect("killed");
            }
            self.tally().batches += usize::from(line.starts_with("Sending"));
            last = line;
        }
        let ended = process.wait().expect("an end");
        match last.split_once(' ').unwrap_or((&last, "")) {
            ("completed", _) => End::Completed,
            ("failed", told) => End::Failed(told.to_owned()),
            _ if kill.is_some() && ended.signal().is_some() => End::Killed,
            _ => panic!("{}: {ended}, after {last:?}", laptop.name),
        }
    }

    /// Kills the server and starts it again, each time when one more share of all batches has reached it: most laptops
    /// are in the middle then.
    fn restart_the_server(&self, cluster: &Cluster) {
        for share in 1..=RESTARTS {
            let enough = BATCHES * self.laptops * share / (RESTARTS + 1);
            self.wait_until(|tally| tally.batches >= enough);
            cluster.kill();
            let before = self.tally().failures();
            thread::sleep(AWAY);
            // Somebody has noticed, unless there is nobody left.
            self.wait_until(|tally| {
                tally.failures() > before || tally.completed.len() >= self.laptops
            });
            cluster.restart();
        }
    }

    fn wait_until(&self, happened: impl Fn(&Tally) -> bool) {
        while !happened(&self.tally()) {
            assert!(self.begun.elapsed() < PATIENCE, "the laptops do not sync");
            thread::sleep(Duration::from_millis(5));
        }
    }
}

/// Goal: whenever laptops and server die, all rows are on the server once, and everybody ends with the same states.
/// Method: laptops that share units sync at the same moment, each in a process of its own; one in ten is killed in the
/// middle, and the server twice. A laptop that is told to try again does; at the end each syncs twice more. Then the
/// rows and states of all files are compared with the server's.
#[test]
#[ignore = "long suite: a campaign of laptops"]
fn many_laptops_sync_while_some_of_them_and_the_server_are_killed() {
    // Times are told of a server as it is delivered.
    let is_timed = fuzzing::amount(1) > 1;
    let cluster = Cluster::start(if is_timed { &[] } else { &[NO_HURRY] });
    let laptops = laptops_with_work(fuzzing::amount(LAPTOPS));
    let depot = Depot {
        address: cluster.database(),
        laptops: laptops.len(),
        begun: Instant::now(),
        tally: Mutex::default(),
    };
    let laptops: Vec<Laptop> = thread::scope(|scope| {
        let depot = &depot;
        let evening = |(number, laptop)| {
            scope.spawn(move || {
                depot.evening(&laptop, number);
                laptop
            })
        };
        let threads: Vec<_> = laptops.into_iter().enumerate().map(evening).collect();
        depot.restart_the_server(&cluster);
        let laptops = threads.into_iter().map(|thread| thread.join());
        laptops.map(|laptop| laptop.expect("no panic")).collect()
    });
    let seconds = depot.begun.elapsed().as_secs_f64();
    let mut client = cluster.client(name_of(&depot.address));
    let same = compare::everything(&depot.address, &laptops, &mut client);
    let tally = depot.tally();
    let p99 = print(&tally, laptops.len(), seconds, &same);
    let to_be_killed = laptops.len().div_ceil(ONE_KILLED_IN);
    assert_eq!(tally.killed as usize, to_be_killed);
    assert!(tally.failures() > 0, "nobody noticed that the server died");
    assert!(same.joined > 0, "no two laptops saw the same fault");
    assert!(!is_timed || p99 <= P99_GOAL, "{p99:.1} s");
}

/// Laptops with runs of units that several of them tested, and with what people said about the faults.
fn laptops_with_work(number: u64) -> Vec<Laptop> {
    let number = i64::try_from(number).expect("few laptops");
    let units = number / 2;
    let work = move |n: i64| {
        let laptop = Laptop::new(format!("pc-{n:04}").leak());
        let store = laptop.open();
        for run in 0..RUNS {
            // Two laptops know different numbers of occurrences of the fault that they share.
            let back = RUNS - 1 - run;
            let unit = format!("U-{}", (n + back * back / 2) % units);
            let at_us = day(run) + n * 60_000_000;
            record(&store, &unit, at_us, &[101 + run % 3, 107], true);
        }
        let at_us = day(RUNS) + n * 60_000_000;
        let run = store.resolve_run("latest").expect("a run");
        store.put_run_note(run, "kim", "brakes looked at", at_us);
        let faults = open_faults(&store);
        store.put_note(faults[1], "kim", "seen before", at_us);
        let repair = repair_of("eb_relay", "", &format!("SN-{n}"), "");
        let state = match n % 3 {
            0 => store.record_repair(faults[0], &repair, "lee", at_us),
            1 => store.acknowledge(faults[0], "kim", "on it", at_us),
            _ => store.set_state(faults[0], FaultState::Closed, "park", "not found", at_us),
        };
        state.expect("a state");
        store.close().expect("its file closes");
        laptop
    };
    let threads: Vec<_> = (0..number)
        .map(|n| thread::spawn(move || work(n)))
        .collect();
    let laptops = threads.into_iter().map(|thread| thread.join());
    laptops.map(|laptop| laptop.expect("no panic")).collect()
}

/// Prints what happened; the 99th of 100 seconds.
fn print(tally: &Tally, laptops: usize, seconds: f64, same: &Same) -> f64 {
    let mut all = tally.completed.clone();
    all.sort_by(f64::total_cmp);
    let percentile = |percent: usize| all[(all.len() * percent).div_ceil(100) - 1];
    let (p50, p99, most) = (percentile(50), percentile(99), percentile(100));
    let failures = tally.failures() as usize;
    for (what, number) in [
        ("laptops", laptops),
        ("server killed and started again", RESTARTS),
        ("syncs begun", tally.begun as usize),
        ("  completed", all.len()),
        ("  killed", tally.killed as usize),
        ("  failed, to be tried again", failures),
    ] {
        println!("{what:42} {number:8}");
    }
    for (told, times) in &tally.failed {
        println!("    {told:75} {times:6}");
    }
    for (what, number) in [
        ("rows on the server, each of them once", same.rows),
        ("faults, with the same state everywhere", same.faults),
        ("  of them on several laptops", same.joined),
        ("  of them in conflict", same.in_conflict),
    ] {
        println!("{what:42} {number:8}");
    }
    println!("seconds of a completed sync: p50 {p50:.2}, p99 {p99:.2}, most {most:.2}");
    println!("seconds until all had synced: {seconds:.1}");
    p99
}

/// Goal: a technician whose laptop finds no free connection on the server is told to try again later.
/// Method: a database that takes one connection, which somebody else has.
#[test]
fn a_laptop_that_finds_no_free_connection_is_told_to_try_again() {
    let address = shared().database();
    let name = name_of(&address);
    as_owner(
        &address,
        &format!("ALTER DATABASE {name} CONNECTION LIMIT 1"),
    );
    let first = connect(&address).expect("the only connection");
    refused!(
        connect(&address),
        StoreError::ServerBusy { .. },
        "try again later"
    );
    drop(first);
}
