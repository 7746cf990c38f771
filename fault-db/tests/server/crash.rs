//! The sync matrix: the laptop's program killed, the wire cut and the server killed, before and after each
//! commit; then the next sync takes it up. Goal: afterwards the server has every row once, and the file
//! knows it. Method: a wire that sees the commits pass, and a client that is a program of its own.

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;

use fault_db::StoreError;

use crate::common::{Deeds, refused};
use crate::counts::{self, Counts};
use crate::laptop::{Laptop, day, record, sync};
use crate::private::{Cluster, NO_HURRY, name_of, shared, signal};
use crate::proxy::{When, Wire};
use fuzzing::draw;

const FILE: &str = "PTU_TEST_KILLED_FILE";
const ADDRESS: &str = "PTU_TEST_KILLED_ADDRESS";

/// A history of three batches, and a second file to take the same history from again and again.
fn history() -> Laptop {
    let laptop = Laptop::new("matrix");
    let store = laptop.open();
    for n in 0..6 {
        let unit = format!("U-{}", n % 2);
        record(&store, &unit, day(n), &[101 + n, 107], true);
        // Events are entries of their own, so that runs and notes alternate.
        let fault = store.resolve_fault("latest").expect("a fault");
        for note in 0..190 {
            store.put_note(fault, "kim", &format!("note {note}"), day(n) + note);
        }
    }
    let run = store.resolve_run("latest").expect("a run");
    store.put_run_note(run, "kim", "a note", day(9));
    store.close().expect("its file closes");
    laptop
}

/// The program that is killed: this test run again by itself, with a file and an address.
#[test]
fn the_client_that_is_killed() {
    let (Some(file), Ok(address)) = (std::env::var_os(FILE), std::env::var(ADDRESS)) else {
        return;
    };
    sync(Path::new(&file), &address, "matrix", &mut |_| true).expect("a sync");
}

/// One line of the matrix, checked.
struct Case<'a> {
    cluster: &'a Cluster,
    history: &'a Laptop,
    whole: &'a Counts,
}

impl Case<'_> {
    fn address_by(&self, address: &str, wire: &Wire) -> String {
        address.replace(&self.cluster.port().to_string(), &wire.port.to_string())
    }

    /// Rows on the server after the trouble, and after the next sync.
    fn check(&self, name: &str, address: &str, file: &Laptop) {
        let rows = |counts: &Counts| {
            let tables = "run step fault_occurrence fault_event run_note trace".split(' ');
            let rows = tables.map(|table| counts.get(table).copied().unwrap_or_default());
            rows.collect::<Vec<_>>()
        };
        let mut client = self.cluster.client(name_of(address));
        let has_tables = client.query_one("SELECT to_regclass('trace') IS NOT NULL", &[]);
        let before = match has_tables.expect("an answer").get(0) {
            true => counts::of_server(&mut client),
            false => Counts::new(),
        };
        file.sync(address);
        let after = counts::of_server(&mut client);
        println!("{name:34} {:?} -> {:?}", rows(&before), rows(&after));
        assert_eq!(after, *self.whole, "{name}");
        let cursors = "SELECT min(sent) > 0 AND min(sent_traces) > 0 FROM laptop";
        let sent: bool = client.query_one(cursors, &[]).expect("cursors").get(0);
        assert!(sent, "{name}");
    }

    fn kill_client(&self, when: When) {
        let address = self.cluster.database();
        let file = self.history.copy();
        let process = Arc::new(std::sync::Mutex::new(None::<u32>));
        let victim = Arc::clone(&process);
        let wire = Wire::to(self.cluster.port(), when, move || {
            let victim = victim.lock().expect("a lock").expect("a process");
            signal("KILL", victim);
        });
        let exe = std::env::current_exe().expect("this program");
        let mut locked = process.lock().expect("a lock");
        let mut client = Command::new(exe)
            .args(["--exact", "crash::the_client_that_is_killed"])
            .env(FILE, file.path())
            .env(ADDRESS, self.address_by(&address, &wire))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("a client");
        *locked = Some(client.id());
        drop(locked);
        let ended = client.wait().expect("an end");
        wire.commits();
        assert_eq!(ended.code(), None, "it was killed: {when:?}");
        self.check(&format!("client killed, {when:?}"), &address, &file);
    }

    fn cut(&self, when: When) {
        let address = self.cluster.database();
        let file = self.history.copy();
        let wire = Wire::to(self.cluster.port(), when, || {});
        let cut = file.try_sync(&self.address_by(&address, &wire), &mut |_| true);
        refused!(cut, StoreError::ServerUnreachable { .. });
        wire.commits();
        self.check(&format!("wire cut, {when:?}"), &address, &file);
    }
}

/// Number of commits in a whole sync.
fn commits(history: &Laptop) -> (u32, Counts) {
    let cluster = shared();
    let address = cluster.database();
    let wire = Wire::to(cluster.port(), When::Never, || {});
    let by_wire = address.replace(&cluster.port().to_string(), &wire.port.to_string());
    history.copy().sync(&by_wire);
    let whole = counts::of_server(&mut cluster.client(name_of(&address)));
    assert_eq!(whole, counts::of_file(&history.path()));
    (wire.commits(), whole)
}

#[test]
fn a_client_killed_at_any_commit_or_a_connection_cut_anywhere_loses_and_duplicates_nothing() {
    let history = history();
    let (commits, whole) = commits(&history);
    assert!(
        commits >= 6,
        "introduction, three batches, traces, events: {commits}"
    );
    let case = Case {
        cluster: shared(),
        history: &history,
        whole: &whole,
    };
    println!(
        "rows on the server: run, step, occurrence, event, note, trace; then after the next sync"
    );
    for commit in draw::drawn(1..=commits, 3) {
        case.kill_client(When::BeforeCommit(commit));
        case.kill_client(When::AfterCommit(commit));
        case.cut(When::BeforeCommit(commit));
        case.cut(When::AfterCommit(commit));
    }
    for bytes in draw::drawn([1, 200, 40_000, 60_000, 120_000], 3) {
        case.cut(When::AfterBytes(bytes));
    }
}

#[test]
fn a_sync_continues_after_the_server_was_killed_at_any_commit() {
    let history = history();
    let (commits, whole) = commits(&history);
    let cluster = Arc::new(Cluster::start(&[NO_HURRY]));
    let case = Case {
        cluster: &cluster,
        history: &history,
        whole: &whole,
    };
    for commit in draw::drawn(2..=commits, 3) {
        for when in [When::BeforeCommit(commit), When::AfterCommit(commit)] {
            let address = cluster.database();
            let file = history.copy();
            let victim = Arc::clone(&cluster);
            let wire = Wire::to(cluster.port(), when, move || victim.kill());
            let away = file.try_sync(&case.address_by(&address, &wire), &mut |_| true);
            refused!(away, StoreError::ServerUnreachable { .. });
            wire.commits();
            refused!(file.try_sync(&address, &mut |_| true), _, "nothing listens");
            cluster.restart();
            case.check(&format!("server killed, {when:?}"), &address, &file);
        }
    }
}
