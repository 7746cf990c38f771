//! Rows that a sync brings to the server, and rows that it leaves.

use fault_db::{FaultFilter, RunFilter, RunWriter, StoreError};

use crate::common::{self, Deeds, change, refused};
use crate::counts;
use crate::laptop::{Laptop, as_owner, day, only_fault, read_only};
use crate::private::{name_of, shared};

#[test]
fn everything_recorded_reaches_the_server_and_a_second_sync_changes_nothing() {
    let address = shared().database();
    let laptop = Laptop::new("one");
    for n in 0..5 {
        laptop.run("U-1", day(n), &[101, 102 + n % 2], true);
    }
    let first = laptop.sync(&address);
    assert_eq!((first.runs, first.traces, first.waiting), (5, 10, 0));
    let mut client = shared().client(name_of(&address));
    let on_server = counts::of_server(&mut client);
    assert_eq!(on_server, counts::of_file(&laptop.path()));
    let content = counts::content(&mut client);

    let second = laptop.sync(&address);
    assert_eq!((second.runs, second.events, second.traces), (0, 0, 0));
    assert_eq!((second.events_received, second.already_there), (0, 0));
    assert_eq!(counts::of_server(&mut client), on_server);
    assert_eq!(counts::content(&mut client), content);
}

/// A server that came back from a backup, and a file that did: what is missing is sent again, and what
/// is there stays.
#[test]
fn a_cursor_too_far_ahead_on_one_side_loses_nothing() {
    let address = shared().database();
    let laptop = Laptop::new("restored");
    laptop.run("U-1", day(0), &[101], true);
    laptop.sync(&address);
    let mut client = shared().client(name_of(&address));
    let content = counts::content(&mut client);

    as_owner(
        &address,
        "UPDATE laptop SET sent = 0, sent_traces = 0, received = 0",
    );
    let again = laptop.sync(&address);
    assert_eq!((again.runs, again.events, again.traces), (0, 0, 0));
    assert!(again.already_there > 0);
    assert_eq!(counts::content(&mut client), content);

    laptop
        .alter("DELETE FROM sync_server; DELETE FROM fault_event; UPDATE fault SET state = 'open'");
    laptop.sync(&address);
    let events = only_fault(&laptop.open()).events;
    assert_eq!(events.len(), 1, "what the file had lost came back");
    assert_eq!(counts::content(&mut client), content);
}

#[test]
fn an_interrupted_run_is_sent_as_it_is() {
    let address = shared().database();
    let laptop = Laptop::new("dead");
    let store = laptop.open();
    let mut under_way = Vec::new();
    for is_alive in [false, true] {
        let record = common::run_record("U-1");
        let mut writer = RunWriter::begin(&store, &record).expect("a run");
        writer.step(common::step(0)).expect("a step");
        let stored = writer.fault(&common::fault(101, day(0))).expect("a fault");
        let trace = common::realistic_trace(40, 1);
        writer.trace(&[stored.occurrence], &trace).expect("a trace");
        under_way.extend(is_alive.then_some(writer));
    }
    let first = laptop.sync(&address);
    assert_eq!((first.runs, first.traces), (1, 1));
    let server = read_only(&address).expect("a server");
    let runs = server.runs(&RunFilter::default()).expect("runs");
    assert_eq!(
        (runs.len(), runs[0].verdict, runs[0].recorded.planned),
        (1, None, 1)
    );
    assert_eq!(laptop.sync(&address).runs, 0);

    // The writer was not dead after all.
    drop(under_way);
    let run = runs[0].id;
    laptop.alter(&format!(
        "UPDATE run SET verdict = 'passed', finished_at_us = 5, bench_time_us = 5, wall_time_us = 5
         WHERE lower(hex(id)) = replace('{run}', '-', '')"
    ));
    drop(store);
    let second = laptop.sync(&address);
    assert_eq!(second.runs, 1, "the other one");
    let ended = server.run(run).expect("the run");
    assert_eq!(ended.run.verdict, Some(fault_db::Verdict::Passed));
}

#[test]
fn a_run_that_differs_on_the_server_is_reported_and_not_changed() {
    let address = shared().database();
    let laptop = Laptop::new("altered");
    let altered = laptop.run("U-1", day(0), &[], false);
    laptop.sync(&address);
    let mut client = shared().client(name_of(&address));
    let content = counts::content(&mut client);
    laptop.alter(
        "UPDATE seal SET digest = zeroblob(32); DELETE FROM sync_server;
         UPDATE run SET operator = 'somebody'",
    );
    laptop.run("U-1", day(1), &[], false);
    let told = laptop.sync(&address);
    let different: Vec<_> = told.different.iter().map(|d| (d.what, d.id)).collect();
    assert_eq!(different, [("run", altered)]);
    assert_eq!(told.runs, 1, "the rest goes on");
    assert_ne!(counts::content(&mut client), content);
    let server = read_only(&address).expect("a server");
    assert_eq!(server.run(altered).expect("the run").run.operator, "kim");
}

/// Goal: of two laptops that record into copies of one file the second is refused, and goes on under a name of
/// its own; nothing of either is lost.
#[test]
fn a_forked_copy_gets_an_id_of_its_own() {
    let address = shared().database();
    let (one, copy) = (Laptop::new("one"), Laptop::new("copy"));
    one.run("U-1", day(0), &[], false);
    std::fs::copy(one.path(), copy.path()).expect("a copy");
    one.run("U-1", day(1), &[], false);
    let forked = copy.run("U-1", day(2), &[], false);
    one.sync(&address);
    let forked_sync = copy.try_sync(&address, &mut |_| true);
    refused!(
        forked_sync,
        StoreError::ForkedCopy { after: 2, .. },
        "--as-copy"
    );
    copy.as_copy.set(true);
    let told = copy.sync(&address);
    assert_eq!((told.runs, told.different), (1, vec![]));
    copy.as_copy.set(false);
    copy.run("U-1", day(3), &[], false);
    let told = copy.sync(&address);
    assert_eq!((told.runs, told.different), (1, vec![]));
    one.run("U-1", day(4), &[], false);
    assert_eq!(one.sync(&address).runs, 1);
    one.is_whole();
    copy.is_whole();
    let server = read_only(&address).expect("a server");
    let seal = server.run(forked).expect("the run").seal;
    let copied = copy.open().run(forked).expect("the run").seal;
    assert_eq!(seal.expect("sealed").digest, copied.expect("sealed").digest);
}

/// Goal: a backup that was laid back is told from a file that was rewritten, and either from the file itself.
#[test]
fn a_file_is_compared_with_the_chain_the_server_knows() {
    let address = shared().database();
    let (laptop, backup) = (Laptop::new("laptop"), Laptop::new("backup"));
    laptop.run("U-1", day(0), &[], false);
    std::fs::copy(laptop.path(), backup.path()).expect("a backup");
    let run = laptop.run("U-1", day(1), &[101], false);
    laptop.sync(&address);
    let older = backup.try_sync(&address, &mut |_| true);
    refused!(
        older,
        StoreError::EarlierCopy {
            here: 2,
            there: 4,
            ..
        }
    );
    backup.as_copy.set(true);
    backup.run("U-1", day(2), &[], false);
    let told = backup.sync(&address);
    assert_eq!((told.runs, told.different), (1, vec![]));
    backup.is_whole();
    // A verdict changed, and its chain made anew throughout.
    change(
        &laptop.path(),
        &format!(
            "UPDATE run SET verdict = 'passed' WHERE verdict = 'failed';
             UPDATE seal SET digest = x'07', hash = x'08' WHERE what = 'run' AND lower(hex(id)) = replace('{run}', '-', '')"
        ),
    );
    for as_copy in [false, true] {
        laptop.as_copy.set(as_copy);
        let made_up = laptop.try_sync(&address, &mut |_| true);
        refused!(made_up, StoreError::Rewritten { after: 3, id, .. } if *id == run);
    }
}

/// Traces that are not what was stored, or whose list of channels is not: they stay behind, all else goes both ways.
#[test]
fn damaged_traces_are_not_sent_and_block_nothing() {
    for (damage, sent) in [
        (
            "UPDATE trace SET data = zeroblob(length(data)) WHERE seq = 1",
            1,
        ),
        ("UPDATE channel_set SET json = replace(json, 'a', 'b')", 0),
    ] {
        let address = shared().database();
        let (laptop, other) = (Laptop::new("damaged"), Laptop::new("other"));
        laptop.run("U-1", day(0), &[101, 102], true);
        laptop.alter(damage);
        other.run("U-1", day(1), &[101], false);
        other.sync(&address);
        let told = laptop.sync(&address);
        assert_eq!(
            (told.traces, told.damaged_traces.len()),
            (sent, 2 - sent as usize)
        );
        assert_eq!((told.runs, told.events_received, told.waiting), (1, 1, 0));
    }
}

/// A version without an outbox recorded it: the first sync sends it all the same.
#[test]
fn rows_recorded_before_the_outbox_existed_are_sent_too() {
    let address = shared().database();
    let laptop = Laptop::new("old");
    laptop.run("U-1", day(0), &[101], true);
    laptop.alter("DELETE FROM outbox");
    let told = laptop.sync(&address);
    assert_eq!((told.runs, told.traces, told.events), (1, 1, 1));
}

#[test]
fn traces_can_be_sent_later_and_a_stopped_sync_is_continued() {
    let address = shared().database();
    let laptop = Laptop::new("stopped");
    for n in 0..3 {
        laptop.run("U-1", day(n), &[101], true);
    }
    let stopped = laptop.try_sync(&address, &mut |_| false);
    let stopped = stopped.expect("a sync that is stopped");
    assert!(stopped.stopped);
    assert_eq!((stopped.runs, stopped.traces, stopped.waiting), (3, 0, 3));
    let rest = laptop.sync(&address);
    assert_eq!((rest.runs, rest.traces, rest.waiting), (0, 3, 0));
}

/// Laptops that come back to the depot in the evening sync at once: no fault is made twice.
#[test]
fn laptops_that_sync_at_the_same_moment_wait_for_each_other() {
    let address = shared().database();
    let names = ["a", "b", "c", "d", "e"];
    let threads = names.map(|name| {
        let address = address.clone();
        std::thread::spawn(move || {
            let laptop = Laptop::new(name);
            for n in 0..4 {
                laptop.run(&format!("U-{}", n % 2), day(n), &[101, 102], true);
                laptop.sync(&address);
            }
            laptop
        })
    });
    let laptops = threads.map(|thread| thread.join().expect("no panic"));
    let server = read_only(&address).expect("a server");
    let faults = server.faults(&FaultFilter::default()).expect("faults");
    let seen: Vec<_> = faults.iter().map(|fault| fault.occurrences).collect();
    assert_eq!(
        seen, [10; 4],
        "two codes on two units, seen by five laptops"
    );
    for laptop in &laptops {
        laptop.sync(&address);
        laptop.is_whole();
    }
    let mut client = shared().client(name_of(&address));
    let content = counts::content(&mut client);
    for laptop in &laptops {
        let again = laptop.sync(&address);
        assert_eq!((again.events, again.events_received), (0, 0));
    }
    assert_eq!(counts::content(&mut client), content);
}

/// PostgreSQL keeps no zero letter in a text; everything else goes as it is.
#[test]
fn texts_of_any_language_arrive() {
    let address = shared().database();
    let laptop = Laptop::new("words");
    let run = laptop.run("부품-1", day(0), &[], false);
    let text = "K3 릴레이 교체 🚆 'quoted' \\ \"double\" \u{0}zero";
    laptop.open().put_run_note(run, "김", text, day(0));
    assert_eq!(laptop.sync(&address).notes, 1);
    let server = read_only(&address).expect("a server");
    let notes = server.run(run).expect("the run").notes;
    assert_eq!(notes[0].text, text.replace('\0', "\u{fffd}"));
    assert_eq!(notes[0].who, "김");
}
