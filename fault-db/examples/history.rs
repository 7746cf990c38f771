//! Writes a made-up history of a metro's fleet over three years, for `benches/questions.rs`:
//!
//! ```text
//! cargo run --release -p fault-db --example history -- FILE [--faults 1000000] [--runs 100000]
//! ```
//!
//! 150 units of four lines fail, some kinds and units far more often than others; people take note of faults, repair and
//! close them, and a part that was repaired fails again. All of it goes through the calls the program itself uses.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "what a benchmark or an example is for"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::path::PathBuf;

use common::{Random, T0_US, end, fault, ids, measurement, run_record, step};
use fault_db::{
    FaultRecord, FaultState, Id, OpenOptions, RepairRecord, RunRecord, RunWriter, Store,
    StoreError, Synchronous, Verdict,
};

const UNITS: u64 = 150;
const SPAN_US: u64 = 3 * 365 * 86_400_000_000;
/// Runs committed at once.
const BATCH: usize = 40;

/// Kinds of faults, the most frequent first: code, part, severity.
const KINDS: [(i64, &str, &str); 20] = [
    (400, "twc_cpu", "minor"),
    (301, "marker_antenna", "minor"),
    (603, "ato_cpu", "minor"),
    (803, "inverter", "minor"),
    (302, "marker_antenna", "minor"),
    (201, "atp_receiver", "minor"),
    (306, "marker_antenna", "minor"),
    (224, "speed_sensor_1", "major"),
    (602, "ato_cpu", "major"),
    (112, "rs485_link", "minor"),
    (225, "speed_sensor_2", "major"),
    (500, "rs485_link", "major"),
    (601, "ato_cpu", "major"),
    (220, "unknown", "critical"),
    (106, "power_supply", "major"),
    (804, "brake_cylinder", "major"),
    (240, "io_board", "critical"),
    (303, "tra", "major"),
    (231, "eb_relay", "critical"),
    (9000, "eb_relay", "major"),
];

/// Measurements of a run: procedure, name, value as good as new.
const CHECKS: [(&str, &str, f64); 6] = [
    ("atp/power_up", "release_time", 1.08),
    ("atp/limit_speed", "decoding_time", 0.72),
    ("atp/overspeed", "eb_reaction", 0.42),
    ("door/interlocks", "door_closing_time", 2.9),
    ("twc/exchange", "answer_time", 0.18),
    ("tcms/link", "loss_time", 1.02),
];

const NOTES: [&str; 6] = [
    "seen only when cold, not on the bench",
    "connector X12 was loose, reseated",
    "waits for a spare part",
    "부품 교체, 접점 소손 확인",
    "교체 후 조정 완료",
    "지난달과 같은 증상, 계속 관찰",
];

struct Options {
    file: PathBuf,
    faults: usize,
    runs: usize,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut options = Options {
        file: PathBuf::new(),
        faults: 1_000_000,
        runs: 100_000,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut number = || words.next().unwrap_or_default().parse::<usize>();
        match word.as_str() {
            "--faults" => options.faults = number()?,
            "--runs" => options.runs = number()?,
            _ => options.file = word.into(),
        }
    }
    let open = OpenOptions::new(ids(1)).synchronous(Synchronous::Normal);
    let store = Store::open(&options.file, open)?;
    write(&store, &options)?;
    Ok(store.close()?)
}

fn write(store: &Store, options: &Options) -> Result<(), StoreError> {
    let mut random = Random::new(1);
    let (mut runs, mut faults) = (0, 0);
    while runs < options.runs {
        store.transaction(|| {
            for _ in 0..BATCH.min(options.runs - runs) {
                let mean = (options.faults - faults) / (options.runs - runs);
                let seen = match options.runs - runs {
                    1 => options.faults - faults,
                    _ => (random.next() % (2 * mean as u64 + 1)) as usize,
                };
                let at_us = T0_US + (SPAN_US as f64 * runs as f64 / options.runs as f64) as i64;
                run(store, at_us, seen, &mut random)?;
                (runs, faults) = (runs + 1, faults + seen);
            }
            Ok(())
        })?;
        if runs % 10_000 == 0 {
            eprintln!("{runs} runs, {faults} occurrences");
        }
    }
    Ok(())
}

/// A number below `count`, small ones far more often.
fn uneven(count: u64, random: &mut Random) -> usize {
    let (a, b) = (random.next() % count, random.next() % count);
    (a * b / count) as usize
}

fn run(store: &Store, at_us: i64, seen: usize, random: &mut Random) -> Result<(), StoreError> {
    let unit = uneven(UNITS, random);
    let line = unit % 4;
    let mut writer = RunWriter::begin(
        store,
        &RunRecord {
            line: ["line2", "line5", "line6", "line8"][line].to_owned(),
            train: format!("{line}{:02}", unit / 8),
            started_at_us: at_us,
            ..run_record(&format!("ATC-{}", 1001 + unit))
        },
    )?;
    for (index, (procedure, name, value)) in (0..).zip(CHECKS) {
        let mut done = step(index);
        done.procedure = procedure.to_owned();
        done.measurements = vec![measurement(name, value + random.noise() / 50.0)];
        writer.step(done)?;
    }
    let mut opened = Vec::new();
    for _ in 0..seen {
        let (code, lru, severity) = KINDS[uneven(KINDS.len() as u64, random)];
        let stored = writer.fault(&FaultRecord {
            lru: lru.to_owned(),
            severity: severity.to_owned(),
            bench_us: 0,
            step_index: (!random.one_in(3)).then_some((random.next() % 6) as u32),
            ..fault(code, at_us + (random.next() % 120_000_000) as i64)
        })?;
        if stored.is_new || stored.reopened {
            opened.push(stored.fault);
        }
    }
    let verdict = match opened.is_empty() {
        true => Verdict::Passed,
        false => Verdict::Failed,
    };
    writer.finish(&end(verdict))?;
    for fault in opened {
        handle(store, fault, at_us, random)?;
    }
    Ok(())
}

/// Acts of people on a fault, in the days after the run: some are noted, some repaired, most closed.
fn handle(store: &Store, fault: Id, at_us: i64, random: &mut Random) -> Result<(), StoreError> {
    let note = NOTES[(random.next() % NOTES.len() as u64) as usize];
    let mut later_us = at_us;
    let mut later = || {
        later_us += 3_600_000_000 + (random.next() % 86_400_000_000) as i64;
        later_us
    };
    store.add_note(fault, "kim", note, later())?;
    match later() % 8 {
        0 => {}
        1..4 => {
            let repair = RepairRecord {
                part: "eb_relay".to_owned(),
                note: note.to_owned(),
                ..RepairRecord::default()
            };
            store.record_repair(fault, &repair, "lee", later())?;
            for state in [FaultState::Verified, FaultState::Closed] {
                store.set_state(fault, state, "lee", "", later())?;
            }
        }
        _ => {
            store.set_state(fault, FaultState::Closed, "lee", note, later())?;
        }
    }
    Ok(())
}
