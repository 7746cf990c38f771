//! Stored memory of a unit over power-ups.

use protocol::event::Event;

use super::*;

fn events(memory: &Memory, from: u32) -> (Vec<StoredEntry>, Vec<StoredClock>) {
    let (mut next, mut replies) = (from, Vec::new());
    while !memory.read(StoreKind::Events, &mut next, 4, &mut replies) {}
    let mut entries = Vec::new();
    let mut clocks = Vec::new();
    for reply in replies {
        match reply {
            Message::StoredEntry(entry) => entries.push(entry),
            Message::StoredClock(clock) => clocks.push(clock),
            other => panic!("{other:?}"),
        }
    }
    (entries, clocks)
}

fn told(utc_ms: u64) -> SetClock {
    SetClock {
        utc_ms,
        uncertainty_ms: 250,
    }
}

#[test]
fn power_ups_are_counted_and_their_events_are_kept_with_the_time_told() {
    let mut device: Box<dyn BlockDevice> = Box::new(RamFlash::default());
    for power_up in 1..=3 {
        let mut memory = Memory::power_up(device);
        let (mut log, record) = (EventLog::default(), RunRecord::default());
        log.push(Instant::ZERO, Event::PowerUp, 0);
        log.push(Instant::from_ms(700), Event::TachoDead1, power_up);
        assert!(!memory.step(&log, &record));
        if power_up == 2 {
            let now = Instant::from_ms(1_000);
            memory
                .set_clock(now, told(1_700_000_000_000))
                .expect("stored");
            let never = memory.set_clock(now, told(1_000));
            assert_eq!(never, Err(SetClockError::OutOfRange));
        }
        device = memory.take_device();
    }
    let memory = Memory::power_up(device);
    let (entries, clocks) = events(&memory, 0);
    let found: Vec<_> = entries
        .iter()
        .map(|e| (e.power_up, e.index, e.at_ms))
        .collect();
    let power_ups = (1..=3).flat_map(|count| [(count, 0, 0), (count, 1, 700)]);
    assert_eq!(found, power_ups.collect::<Vec<_>>());
    let [clock] = clocks[..] else {
        panic!("{clocks:?}")
    };
    assert_eq!(
        (clock.power_up, clock.at_ms, clock.uncertainty_ms),
        (2, 1_000, 250)
    );
    let end = memory.end(StoreKind::Events);
    assert_eq!((end.next_sequence, end.power_up, end.works), (7, 4, 1));
}

/// A day of driving: rows overwrite rows, and the events of years stay.
#[test]
fn a_long_service_does_not_push_the_events_out() {
    let mut memory = Memory::power_up(Box::new(RamFlash::default()));
    let (mut log, mut record) = (EventLog::default(), RunRecord::default());
    log.push(Instant::ZERO, Event::PowerUp, 0);
    let rows = 24_000;
    for i in 0..rows {
        let ato_state = match i {
            0 => protocol::message::AtoState::Start,
            _ => protocol::message::AtoState::Run,
        };
        let cycle = RunRow {
            speed_cms: 1_000,
            ato_state,
            ..RunRow::default()
        };
        record.step(Instant::from_ms(50 * i), true, (cycle, 0));
        memory.step(&log, &record);
    }
    assert_eq!(events(&memory, 0).0.len(), 1);
    let end = memory.end(StoreKind::Runs);
    assert_eq!(u64::from(end.next_sequence), rows);
    let kept = end.next_sequence - end.oldest_sequence;
    assert!(kept as usize >= crate::kernel::RUN_ROWS * 3, "{kept}");
}

/// Goal: the time is found however many events follow. Method: more than the ring holds.
#[test]
fn the_time_told_survives_the_block_that_it_was_told_in() {
    let mut memory = Memory::power_up(Box::new(RamFlash::default()));
    let mut log = EventLog::default();
    let record = RunRecord::default();
    memory
        .set_clock(Instant::ZERO, told(1_700_000_000_000))
        .expect("stored");
    for i in 0..9_000 {
        log.push(Instant::from_ms(i), Event::TwcLost, 0);
        memory.step(&log, &record);
    }
    let (entries, clocks) = events(&memory, 0);
    assert!(entries.len() > 6_000, "{}", entries.len());
    assert!(clocks.iter().all(|clock| clock.utc_ms == 1_700_000_000_000));
    assert!(!clocks.is_empty());
}

#[test]
fn a_device_that_fails_is_reported_once_and_read_no_more() {
    let mut flash = RamFlash::default();
    flash.fail_after(Some(100));
    let mut memory = Memory::power_up(Box::new(flash));
    let (mut log, record) = (EventLog::default(), RunRecord::default());
    for _ in 0..8 {
        log.push(Instant::ZERO, Event::TwcLost, 0);
    }
    let failures: Vec<_> = (0..3).map(|_| memory.step(&log, &record)).collect();
    assert_eq!(failures, [true, false, false]);
    assert_eq!(memory.end(StoreKind::Events).works, 0);
    let now = Instant::ZERO;
    assert_eq!(
        memory.set_clock(now, told(1_700_000_000_000)),
        Err(SetClockError::Failed)
    );
    assert!(events(&memory, 0).0.is_empty());
}

/// Goal: times that say little do not keep out one that says more. Method: as many as are stored, and the best one last.
#[test]
fn a_better_time_is_stored_however_many_bad_ones_came_before() {
    let mut memory = Memory::power_up(Box::new(RamFlash::default()));
    let mut tell = |utc_ms, uncertainty_ms| {
        let told = SetClock {
            utc_ms,
            uncertainty_ms,
        };
        memory.set_clock(Instant::ZERO, told)
    };
    let (bad, good) = (1_600_000_000_000, 1_700_000_000_000);
    for _ in 0..32 {
        tell(bad, u16::MAX).expect("stored");
    }
    assert_eq!(tell(bad, u16::MAX), Err(SetClockError::OutOfRange));
    tell(good, 500).expect("the better one");
    assert_eq!(
        tell(good, 400),
        Err(SetClockError::OutOfRange),
        "hardly better"
    );
    tell(good, 100).expect("much better");
    let more = (0..=u16::MAX).rev().filter(|ms| tell(good, *ms).is_ok());
    assert!(more.count() < 17, "bounded");
    // The first and the last millisecond of the years that there are.
    let mut fresh = Memory::power_up(Box::new(RamFlash::default()));
    for (utc_ms, is_good) in [
        (946_684_799_999, false),
        (946_684_800_000, true),
        (4_102_444_800_000, true),
        (4_133_980_799_999, true),
        (4_133_980_800_000, false),
    ] {
        assert_eq!(
            fresh.set_clock(Instant::ZERO, told(utc_ms)).is_ok(),
            is_good,
            "{utc_ms}"
        );
    }
}
