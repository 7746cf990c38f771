//! Runs that no bench made: what was read of a unit's log, and of its own record of runs.

use btu_rig::procedure::UnitEvent;
use fault_db::{Channel, ChannelKind, Id, Store, TraceData};
use protocol::event::Event;
use ptu_runs::clock;
use ptu_runs::record::{RecordedRun, pull};
use ptu_runs::unit_log::{Entry, Source, import};

use super::made_plans::Chance;
use super::made_runs::PARTS;

/// Events whose suspects are `PARTS`, in the order of `PARTS`.
static EVENTS: [Event; 4] = [
    Event::EbRelayWelded,
    Event::TraFailed,
    Event::TwcStationInvalid,
    Event::TachoDead1,
];

/// Where and of which unit something was read; perhaps not to its end.
fn source(seed: u64, broken_off: bool) -> Source {
    let now = clock::now_us();
    Source {
        endpoint: "tcp:unit".into(),
        serial: format!("M-{seed}"),
        config_name: "sg100".into(),
        unit_config_sha256: String::new(),
        line: "line8".into(),
        operator: "김 <b>".into(),
        train: String::new(),
        from_us: now - 1_000_000,
        until_us: now,
        broken_off,
    }
}

/// A run that was read, and what it holds.
pub struct Read {
    pub id: Id,
    pub verdict: &'static str,
    /// Parts of its faults.
    pub parts: Vec<&'static str>,
    /// Steps of the run: one for each run of the unit's record.
    pub steps: usize,
}

/// Stores a run that was read of a unit: of its log, or of its own record of runs.
pub fn read_of_a_unit(store: &Store, seed: u64, is_log: bool, chance: &mut Chance) -> Read {
    let (broken_off, count) = (chance.one_in(3), 1 + chance.below(EVENTS.len()));
    let source = source(seed, broken_off);
    let (id, judged) = if is_log {
        let entries = (1..).zip(&EVENTS[..count]).map(entry);
        let made = import(store, &source, &entries.collect::<Vec<_>>()).expect("stored");
        (made.run, "failed")
    } else {
        let runs = (0..count).map(|number| run(seed, number)).collect();
        let made = pull(store, &source, runs).expect("stored");
        (made.run, "skipped")
    };
    Read {
        id: id.expect("new"),
        verdict: [judged, "error"][usize::from(broken_off)],
        parts: PARTS[..if is_log { count } else { 0 }].to_vec(),
        steps: if is_log { 0 } else { count },
    }
}

fn entry((index, event): (u32, &Event)) -> Entry {
    Entry {
        event: UnitEvent::at_stand(index, *event, 1_000 * index),
        at_us: Some(clock::now_us()),
        is_sure: true,
        stored: None,
    }
}

fn run(seed: u64, number: usize) -> RecordedRun {
    RecordedRun {
        id: Id::of_content("made", &[&seed.to_be_bytes(), &number.to_be_bytes()]),
        power_up: 1,
        run: number as u16,
        at_ms: 1_000,
        date: None,
        trace: TraceData {
            t0_us: clock::now_us(),
            period_us: 50_000,
            channels: vec![Channel {
                name: "speed".into(),
                unit: "km/h".into(),
                kind: ChannelKind::Number { lsb: 0.1 },
            }],
            columns: vec![vec![0.0, 0.1]],
            ..TraceData::default()
        },
        is_cut: false,
    }
}
