//! Reading the log of embedded units, and of links that fail while it is read.

use btu_rig::rig::{LinkFailure, LinkTrouble, PortFailure};
use protocol::event::Event;
use protocol::link::{End, Link};
use protocol::message::{IoOutput, LogEnd, LogEntry, Message, Status};

use super::*;
use crate::link::Delayed;
use crate::run::Session;
use crate::run::bench_setup::{SWITCHED_OFF, SimUnit};
use crate::test_support::setup;

/// A bench with an embedded unit, these faults injected.
pub fn bench(faults: &[&str]) -> Session<Delayed<SimUnit>> {
    let setup = setup(faults);
    let mut session = setup.sim_session("field", &Stop::default());
    session.judge_bring_up(SWITCHED_OFF + Duration::from_ms(10_000), |_| false);
    session
}

fn read<L: UnitLink>(link: &mut L, from: Instant) -> Result<LogRead, BrokenOff> {
    let mut pace = Pace::Virtual;
    read_log(
        link,
        from,
        false,
        &mut pace,
        &Stop::default(),
        (&|| NOW_US, 500),
    )
}

const NOW_US: i64 = 1_000_000_000_000;

fn codes(read: &LogRead) -> Vec<Option<Event>> {
    let entries = read.entries.iter();
    entries
        .map(|entry| Event::from_code(entry.event.code))
        .collect()
}

/// Goal: reading leaves the unit as it was. Method: a unit that its bench left ten seconds ago is
/// read twice.
#[test]
fn a_log_is_read_to_its_end_and_reading_adds_nothing_to_it() {
    let mut bench = bench(&[]);
    let mut now = bench.now();
    let link = &mut bench.bench.link;
    for _ in 0..1_000 {
        now += SCAN;
        link.exchange(now, &[], &mut Vec::new())
            .expect("the embedded unit");
    }
    let first = read(link, now).expect("a log");
    assert_eq!(first.broken_off, None);
    assert_eq!(first.overwritten, 0);
    let lost = [Event::InputsLost, Event::TcmsLost, Event::TwcLost];
    for event in lost {
        assert!(codes(&first).contains(&Some(event)), "{:?}", codes(&first));
    }
    assert!(!first.status.contains(StatusBits::ARMED));
    let age_s = (NOW_US - first.entries[0].at_us.expect("a date")) / 1_000_000;
    assert_eq!(age_s, 21, "10 s with the bench, 10 s left, 1 s held back");
    let second = read(link, now + Duration::from_ms(20_000)).expect("a log");
    assert_eq!(codes(&second), codes(&first));
}

/// A unit that answers as the test says: what a real one does only after days.
struct ScriptedUnit {
    link: Link,
    entries: Vec<LogEntry>,
    uptime_ms: u32,
    serial: [u8; 3],
    asked_from: Option<u32>,
    /// An event and its time, ms.
    happens: Option<(u64, ScriptedEvent)>,
    /// Entries it sends in each scan once it was asked, without end.
    endless: u32,
}

#[derive(Clone, Copy, PartialEq)]
enum ScriptedEvent {
    CableOff,
    Restart,
    OtherUnit,
}

impl ScriptedUnit {
    /// An older unit, without stored memory, with these entries in its log.
    fn new(entries: impl IntoIterator<Item = (u32, u16, u32)>) -> Self {
        let entries = entries.into_iter().map(|(index, code, at_ms)| LogEntry {
            index,
            code,
            at_ms,
            ..LogEntry::default()
        });
        Self {
            link: Link::new(End::Unit),
            entries: entries.collect(),
            uptime_ms: 1_000_000,
            serial: *b"U-1",
            asked_from: None,
            happens: None,
            endless: 0,
        }
    }

    fn next_index(&self) -> u32 {
        self.entries.last().map_or(0, |entry| entry.index + 1)
    }
}

impl UnitLink for ScriptedUnit {
    fn exchange(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble> {
        match self
            .happens
            .filter(|(at_ms, _)| now >= Instant::from_ms(*at_ms))
        {
            Some((_, ScriptedEvent::CableOff)) => {
                return Err(LinkTrouble::Broken(LinkFailure {
                    link: "tcp:told".into(),
                    why: PortFailure::Closed,
                }));
            }
            Some((_, ScriptedEvent::Restart)) => {
                self.happens = None;
                self.uptime_ms = 100;
                self.entries = Self::new([(0, 100, 0), (1, 222, 50)]).entries;
            }
            Some((_, ScriptedEvent::OtherUnit)) => self.serial = *b"U-2",
            None => {}
        }
        self.link.push(to_unit);
        while let Some(received) = self.link.poll(now) {
            match received.message {
                Message::Identify(_) => {
                    let mut identity = Identity {
                        uptime_ms: self.uptime_ms,
                        ..Identity::default()
                    };
                    identity.serial[..3].copy_from_slice(&self.serial);
                    self.link.send(now, &identity.into(), from_unit);
                }
                Message::ReadLog(asked) => self.asked_from = Some(asked.from_index),
                _ => {}
            }
        }
        if let Some(from) = self.asked_from.filter(|_| self.endless > 0) {
            for index in from..from + self.endless {
                let entry = LogEntry {
                    index,
                    code: 221,
                    ..LogEntry::default()
                };
                self.link.send(now, &entry.into(), from_unit);
            }
            self.asked_from = Some(from + self.endless);
        }
        if !now.as_us().is_multiple_of(50_000) {
            return Ok(());
        }
        let events = match self.endless {
            0 => self.next_index(),
            _ => self.asked_from.unwrap_or(1) + 1_000,
        };
        let status = Status {
            events,
            ..Status::default()
        };
        self.link.send(now, &status.into(), from_unit);
        self.link.send(now, &IoOutput::default().into(), from_unit);
        if let Some(from) = self.asked_from.filter(|_| self.endless == 0) {
            let wanted: Vec<_> = self.entries.iter().filter(|e| e.index >= from).collect();
            for entry in wanted.iter().take(2) {
                self.link.send(now, &(**entry).into(), from_unit);
                self.asked_from = Some(entry.index + 1);
            }
            if wanted.len() <= 2 {
                self.asked_from = None;
                let end = LogEnd {
                    next_index: events,
                    oldest_index: self.entries.first().map_or(0, |entry| entry.index),
                };
                self.link.send(now, &end.into(), from_unit);
            }
        }
        Ok(())
    }
}

#[test]
fn lost_entries_are_counted_and_unknown_codes_are_kept() {
    let mut unit = ScriptedUnit::new((40..90).map(|index| (index, 999, index * 1000)));
    let log = read(&mut unit, Instant::ZERO).expect("a log");
    assert_eq!(log.overwritten, 40);
    assert_eq!(log.entries.len(), 50);
    assert!(log.entries.iter().all(|entry| entry.event.code == 999));
    assert_eq!(log.entries[0].at_us, Some(NOW_US - 960_000_000));
}

#[test]
fn entries_read_before_the_cable_was_unplugged_are_kept() {
    let mut unit = ScriptedUnit::new((0..90).map(|index| (index, 221, index * 1000)));
    unit.happens = Some((3_300, ScriptedEvent::CableOff));
    let log = read(&mut unit, Instant::ZERO).expect("a log");
    let why = log.broken_off.expect("broken off").to_string();
    assert!(why.contains("closed at the other end"), "{why}");
    let read_so_far = log.entries.len();
    assert!((10..60).contains(&read_so_far), "{read_so_far}");
    assert!(log.entries.iter().all(|entry| entry.at_us.is_some()));
}

/// Each entry is dated by the clock of its own power-up.
#[test]
fn a_unit_that_starts_again_while_it_is_read_has_two_clocks() {
    let mut unit = ScriptedUnit::new((0..90).map(|index| (index, 221, 900_000 + index)));
    unit.happens = Some((3_300, ScriptedEvent::Restart));
    let log = read(&mut unit, Instant::ZERO).expect("a log");
    assert_eq!(log.restarts, 1);
    let last = log.entries.last().expect("entries");
    assert_eq!((last.event.code, last.event.index), (222, 1));
    assert_eq!(last.at_us, Some(NOW_US - 50_000));
    let first = log.entries[0];
    assert_eq!(
        (first.event.code, first.at_us),
        (221, Some(NOW_US - 100_000_000))
    );
}

/// Goal: what is kept of a log is bounded, whatever the unit sends, and the rest is counted. Method: units
/// that log and send one entry a scan, and a hundred.
#[test]
fn an_endless_log_is_kept_up_to_the_capacity_of_a_unit() {
    for endless in [1, 100] {
        let mut unit = ScriptedUnit::new([(0, 100, 0)]);
        unit.endless = endless;
        let log = read(&mut unit, Instant::ZERO).expect("a log");
        assert!(log.broken_off.is_some());
        let (kept, more) = (log.entries.len(), log.not_kept);
        assert!((256..=256 + 60 * 40).contains(&kept), "{endless}: {kept}");
        assert!(more >= 256, "{endless}: {more}");
    }
}

#[test]
fn another_unit_in_the_middle_of_a_log_ends_its_reading() {
    let mut unit = ScriptedUnit::new((0..190).map(|index| (index, 221, 1)));
    unit.happens = Some((3_300, ScriptedEvent::OtherUnit));
    let log = read(&mut unit, Instant::ZERO).expect("a log");
    let why = log.broken_off.expect("broken off").to_string();
    assert!(why.contains("was \"U-1\" and is \"U-2\""), "{why}");
}

#[test]
fn a_unit_that_does_not_answer_is_reported_with_the_reason() {
    struct SilentUnit;
    impl UnitLink for SilentUnit {
        fn exchange(&mut self, _: Instant, _: &[u8], _: &mut Vec<u8>) -> Result<(), LinkTrouble> {
            Ok(())
        }
    }
    let why = read(&mut SilentUnit, Instant::ZERO)
        .expect_err("no log")
        .to_string();
    assert!(why.contains("unit silent"), "{why}");
}

/// Goal: what the unit logged in every power-up is read, dated where a tester sent the time. Method: a unit whose
/// supply dips, and one that the time was sent to in between.
#[test]
fn the_log_of_all_power_ups_is_read() {
    let mut bench = bench(&["power_supply.dips"]);
    let mut now = bench.now();
    let link = &mut bench.bench.link;
    let log = (0..20).find_map(|_| {
        for _ in 0..6_000 {
            now += SCAN;
            link.exchange(now, &[], &mut Vec::new())
                .expect("the embedded unit");
        }
        let from = now;
        now += Duration::from_ms(60_000);
        read(link, from).ok().filter(|log| log.broken_off.is_none())
    });
    let log = log.expect("read between two dips");
    let stored = log.stored.expect("stored memory");
    assert!(stored.power_up > 2, "{}", stored.power_up);
    let power_ups: Vec<_> = (log.entries.iter())
        .filter(|entry| entry.event.code == Event::PowerUp.definition().code)
        .map(|entry| entry.stored.expect("stored").power_up)
        .collect();
    assert_eq!(power_ups, (1..=stored.power_up).collect::<Vec<_>>());
    let first = &log.entries[0];
    assert_eq!(
        (first.at_us, first.event.at_ms),
        (None, 0),
        "no time was sent then"
    );
    assert!(first.stored.expect("stored").not_after_us.is_some());
    assert!(
        log.entries
            .last()
            .is_some_and(|entry| entry.at_us.is_some())
    );
}
