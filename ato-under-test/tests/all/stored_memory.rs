//! Promises of the unit's stored memory: to a tester, over power-ups, and to one of version 1.

use ato_under_test::flash::RamFlash;
use protocol::injection::{Effect, Place};
use protocol::message::{
    Answer, KeepAlive, ReadStored, SetClock, StoreKind, StoredClock, StoredEnd, StoredEntry,
};

use crate::common::{Bench, all, fault};
use crate::maintenance::answer_to;
use crate::maintenance_port::Laptop;

const UTC_MS: u64 = 1_767_225_600_000;

/// A unit with an erased flash, and a tester alone there.
fn fresh() -> Bench {
    Bench::alone(Box::new(RamFlash::default()))
}

fn read_events(per_cycle: u8) -> ReadStored {
    ReadStored {
        store: StoreKind::Events,
        from_sequence: 0,
        per_cycle,
    }
}

/// All stored events, times told and the end of a store that is read to it.
fn stored(bench: &mut Bench) -> (Vec<StoredEntry>, Vec<StoredClock>, StoredEnd) {
    bench.answers.clear();
    bench.send(read_events(3));
    bench.run(3.0);
    let ends = all(&bench.answers);
    let [end] = ends[..] else { panic!("{ends:?}") };
    (all(&bench.answers), all(&bench.answers), end)
}

#[test]
fn a_log_and_the_time_told_survive_power_off() {
    let mut bench = fresh();
    bench.run(3.0);
    let told = SetClock {
        utc_ms: UTC_MS,
        uncertainty_ms: 40,
    };
    assert_eq!(answer_to(&mut bench, told), Answer::Accepted);
    let (first, ..) = stored(&mut bench);
    assert!(!first.is_empty());
    let mut bench = bench.power_cycle();
    bench.run(3.0);
    let (entries, clocks, end) = stored(&mut bench);
    assert_eq!(entries[..first.len()], first);
    assert!(entries.iter().any(|entry| entry.power_up == 2));
    assert_eq!((end.power_up, end.works, end.oldest_sequence), (2, 1, 0));
    let clock = clocks[0];
    assert_eq!(
        (clock.power_up, clock.utc_ms, clock.uncertainty_ms),
        (1, UTC_MS, 40)
    );
    let mut numbers: Vec<_> = entries.iter().map(|entry| entry.sequence).collect();
    numbers.extend(clocks.iter().map(|clock| clock.sequence));
    numbers.sort_unstable();
    assert_eq!(numbers, (0..end.next_sequence).collect::<Vec<_>>());
}

#[test]
fn a_supply_dip_is_a_power_up_and_what_was_logged_before_it_is_kept() {
    let dips = fault(Place::PowerSupply, Effect::Noise { per_s: 0.3 });
    let mut bench = Bench::new(&[dips]);
    bench.run(30.0);
    bench.answers.clear();
    bench.send(read_events(4));
    bench.run(0.9);
    let entries: Vec<StoredEntry> = all(&bench.answers);
    let power_ups = entries.iter().filter(|entry| entry.code == 100);
    let power_ups: Vec<_> = power_ups.map(|entry| entry.power_up).collect();
    assert!(power_ups.len() > 3, "{power_ups:?}");
    let expected = 1..=power_ups.len() as u32;
    assert_eq!(power_ups, expected.collect::<Vec<_>>());
}

/// The greatest pace keeps within the line's budget, with everything else that the unit sends.
#[test]
fn reading_at_the_greatest_pace_fits_on_the_line() {
    let mut bench = powered_up_often(24);
    bench.answers.clear();
    bench.send(read_events(255));
    let scan = |_| {
        bench.scan();
        bench.sent.len()
    };
    let bytes: usize = (0..25).map(scan).sum();
    let entries = all::<StoredEntry>(&bench.answers);
    assert_eq!(entries.len(), 20, "four a cycle");
    let in_cycle = bytes / 5;
    assert!(in_cycle < 430, "{in_cycle} bytes in 50 ms");
}

/// A unit with the events of so many short power-ups in its store, and of one that goes on.
fn powered_up_often(times: u32) -> Bench {
    let mut bench = fresh();
    for _ in 0..times {
        bench.run(0.1);
        bench = bench.power_cycle();
    }
    bench.run(0.1);
    bench
}

/// Goal: a laptop alone leaves the line of its port room: at most 40 % of 115 200 baud. Method: bytes at the
/// maintenance port while a log is read at the pace that it asks for there.
#[test]
fn reading_at_the_maintenance_port_takes_less_than_two_fifths_of_the_line() {
    let mut bench = powered_up_often(200);
    bench.keep_alive = false;
    let mut laptop = Laptop::new();
    let mut sent = laptop.send(&mut bench, read_events(3));
    let (scans, mut bytes) = (300, 0);
    for scan in 0..scans {
        if scan % 20 == 0 {
            sent += laptop.send(&mut bench, KeepAlive { session: 0 });
        }
        bytes += laptop.scan(&mut bench);
    }
    let entries = all::<StoredEntry>(&laptop.heard).len();
    let (from_unit, to_unit) = (bytes * 100 / scans, sent * 100 / scans);
    assert!(entries > 170, "{entries} entries in 3 s");
    assert!(
        from_unit < 4_608 && to_unit < 4_608,
        "{from_unit} and {to_unit} bytes/s"
    );
}

#[test]
fn nothing_of_the_store_is_sent_to_a_tester_that_does_not_ask() {
    let mut bench = fresh();
    bench.run(5.0);
    let mut codes = bench.answers.iter().map(|message| message.spec().code);
    assert!(codes.all(|code| !(0xA4..=0xAF).contains(&code)));
    assert!(bench.status.events > 0, "it is told of the state");
}
