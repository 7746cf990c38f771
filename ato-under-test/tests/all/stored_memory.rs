//! Promises of the unit's stored memory: to a tester, over power-ups, and to one of version 1.

use ato_under_test::flash::{BlockDevice, RamFlash};
use ato_under_test::{Port, Unit};
use protocol::injection::{Effect, Place};
use protocol::link::{End, Link};
use protocol::message::{
    Answer, KeepAlive, Message, ReadStored, SetClock, StoreKind, StoredClock, StoredEnd,
    StoredEntry,
};
use protocol::{Instant, SCAN};

use crate::common::{Bench, config, fault, line};

const UTC_MS: u64 = 1_767_225_600_000;

/// A tester alone on a unit.
struct Laptop {
    unit: Unit,
    link: Link,
    now: Instant,
    heard: Vec<Message>,
    bytes: usize,
}

impl Laptop {
    fn new(flash: Box<dyn BlockDevice>) -> Self {
        let setup = ato_under_test::Setup {
            serial: "SG-0042".into(),
            config: config(),
            config_crc: 1,
            line: line(),
            tdb_crc: 2,
            seed: 7,
            faults: Vec::new(),
        };
        Self {
            unit: Unit::with_flash(setup, flash),
            link: Link::new(End::Bench),
            now: Instant::ZERO,
            heard: Vec::new(),
            bytes: 0,
        }
    }

    fn run(&mut self, scans: u32, request: Option<Message>) {
        let mut request = request;
        for scan in 0..scans {
            let mut to_unit = Vec::new();
            if scan % 20 == 0 {
                let alive = KeepAlive { session: 0 };
                self.link.send(self.now, &alive.into(), &mut to_unit);
            }
            if let Some(request) = request.take() {
                self.link.send(self.now, &request, &mut to_unit);
            }
            self.unit.receive(&to_unit);
            let mut from_unit = Vec::new();
            self.unit.step(self.now, &mut from_unit);
            self.link.push(&from_unit);
            while let Some(received) = self.link.poll(self.now) {
                self.heard.push(received.message);
            }
            self.bytes += from_unit.len();
            self.now += SCAN;
        }
    }

    fn stored(&mut self, per_cycle: u8) -> (Vec<StoredEntry>, Vec<StoredClock>, StoredEnd) {
        self.heard.clear();
        let request = ReadStored {
            store: StoreKind::Events,
            from_sequence: 0,
            per_cycle,
        };
        self.run(300, Some(request.into()));
        let (mut entries, mut clocks, mut ends) = (Vec::new(), Vec::new(), Vec::new());
        for message in &self.heard {
            match message {
                Message::StoredEntry(entry) => entries.push(*entry),
                Message::StoredClock(clock) => clocks.push(*clock),
                Message::StoredEnd(end) => ends.push(*end),
                _ => {}
            }
        }
        let [end] = ends[..] else { panic!("{ends:?}") };
        (entries, clocks, end)
    }

    fn power_cycle(self) -> Self {
        Self::new(self.unit.power_off())
    }
}

fn answers(heard: &[Message]) -> Vec<Answer> {
    let answers = heard.iter().filter_map(|message| match message {
        Message::StimulusAnswer(answer) => Some(answer.answer),
        _ => None,
    });
    answers.collect()
}

#[test]
fn a_log_and_the_time_told_survive_power_off() {
    let mut laptop = Laptop::new(Box::new(RamFlash::default()));
    laptop.run(300, None);
    let told = SetClock {
        utc_ms: UTC_MS,
        uncertainty_ms: 40,
    };
    laptop.run(20, Some(told.into()));
    assert_eq!(answers(&laptop.heard), [Answer::Accepted]);
    let (first, ..) = laptop.stored(3);
    assert!(!first.is_empty());
    let mut laptop = laptop.power_cycle();
    laptop.run(300, None);
    let (entries, clocks, end) = laptop.stored(3);
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
    bench.send(ReadStored {
        store: StoreKind::Events,
        from_sequence: 0,
        per_cycle: 4,
    });
    bench.run(0.9);
    let power_ups = bench.answers.iter().filter_map(|message| match message {
        Message::StoredEntry(entry) if entry.code == 100 => Some(entry.power_up),
        _ => None,
    });
    let power_ups: Vec<_> = power_ups.collect();
    assert!(power_ups.len() > 3, "{power_ups:?}");
    let expected = 1..=power_ups.len() as u32;
    assert_eq!(power_ups, expected.collect::<Vec<_>>());
}

/// The greatest pace keeps within the line's budget, with everything else that the unit sends.
#[test]
fn reading_at_the_greatest_pace_fits_on_the_line() {
    let mut laptop = Laptop::new(Box::new(RamFlash::default()));
    for _ in 0..24 {
        laptop.run(10, None);
        laptop = laptop.power_cycle();
    }
    laptop.run(10, None);
    laptop.heard.clear();
    laptop.bytes = 0;
    let request = ReadStored {
        store: StoreKind::Events,
        from_sequence: 0,
        per_cycle: 255,
    };
    laptop.run(25, Some(request.into()));
    let entries = laptop
        .heard
        .iter()
        .filter(|message| matches!(message, Message::StoredEntry(_)));
    assert_eq!(entries.count(), 20, "four a cycle");
    let in_cycle = laptop.bytes / 5;
    assert!(in_cycle < 430, "{in_cycle} bytes in 50 ms");
}

/// Goal: a laptop alone leaves the line of its port room: at most 40 % of 115 200 baud. Method: bytes at the
/// maintenance port while a log is read at the pace that it asks for there.
#[test]
fn reading_at_the_maintenance_port_takes_less_than_two_fifths_of_the_line() {
    let mut laptop = Laptop::new(Box::new(RamFlash::default()));
    for _ in 0..200 {
        laptop.run(10, None);
        laptop = laptop.power_cycle();
    }
    let mut link = Link::new(End::Bench);
    let (mut sent, mut bytes, mut entries) = (0, 0, 0);
    let scans = 300;
    for scan in 0..scans {
        let mut to_unit = Vec::new();
        if scan % 20 == 0 {
            link.send(laptop.now, &KeepAlive { session: 0 }.into(), &mut to_unit);
        }
        if scan == 0 {
            let request = ReadStored {
                store: StoreKind::Events,
                from_sequence: 0,
                per_cycle: 3,
            };
            link.send(laptop.now, &request.into(), &mut to_unit);
        }
        sent += to_unit.len();
        laptop.unit.receive_at(Port::Maintenance, &to_unit);
        laptop.unit.step(laptop.now, &mut Vec::new());
        let mut from_unit = Vec::new();
        laptop.unit.take_maintenance(&mut from_unit);
        bytes += from_unit.len();
        link.push(&from_unit);
        while let Some(received) = link.poll(laptop.now) {
            entries += usize::from(matches!(received.message, Message::StoredEntry(_)));
        }
        laptop.now += SCAN;
    }
    let (from_unit, to_unit) = (bytes * 100 / scans, sent * 100 / scans);
    assert!(entries > 170, "{entries} entries in 3 s");
    assert!(
        from_unit < 4_608 && to_unit < 4_608,
        "{from_unit} and {to_unit} bytes/s"
    );
}

#[test]
fn nothing_of_the_store_is_sent_to_a_tester_that_does_not_ask() {
    let mut laptop = Laptop::new(Box::new(RamFlash::default()));
    laptop.run(500, None);
    let codes = laptop.heard.iter().map(|message| message.spec().code);
    assert!(codes.clone().all(|code| !(0xA4..=0xAF).contains(&code)));
    assert!(codes.count() > 0);
}
