//! One hour of 40 signals: quantities that wander with noise on them, choices and bits that change now and
//! then, some of them in every row.

use std::collections::BTreeMap;
use std::path::Path;

use fault_db::{
    Channel, ChannelKind, FaultRecord, RunEnd, RunRecord, RunWriter, Store, TraceData, UnitRecord,
    Verdict,
};
use protocol::signal::{Kind, Signal};
use ptu_runs::clock;

const SIGNALS: usize = 40;
const ROWS: usize = 72_000;
const PERIOD_US: i64 = 50_000;
const TRIGGER: u32 = 54_000;

/// The first ones a unit reports, and what it is given.
pub fn signals() -> impl Iterator<Item = Signal> {
    let signals = Signal::ALL.iter().copied();
    let unit = signals.clone().skip_while(|signal| *signal != Signal::Eb);
    let given = signals.take_while(|signal| *signal != Signal::Eb);
    unit.chain(given).take(SIGNALS)
}

pub fn trace() -> TraceData {
    let channel = |signal: Signal| {
        let definition = signal.definition();
        Channel {
            name: definition.name.into(),
            unit: definition.unit.into(),
            kind: match definition.kind {
                Kind::Number { lsb } => ChannelKind::Number { lsb },
                Kind::Bit => ChannelKind::Bit,
                Kind::Enum(labels) => ChannelKind::Enum {
                    labels: (0..).zip(labels.iter().map(|l| (*l).to_owned())).collect(),
                },
            },
        }
    };
    TraceData {
        t0_us: clock::now_us() - ROWS as i64 * PERIOD_US,
        period_us: PERIOD_US,
        trigger_row: Some(TRIGGER),
        gaps: true,
        channels: signals().map(channel).collect(),
        columns: signals()
            .zip(1..)
            .map(|(signal, seed)| column(signal, seed))
            .collect(),
        ..TraceData::default()
    }
}

/// Writes a database with a run that has this trace.
pub fn write(file: &Path) {
    let store = Store::open(file, clock::open_options()).expect("a database");
    let record = RunRecord {
        unit: UnitRecord {
            serial: "HOUR-1".into(),
            kind: "atc".into(),
            config_name: "sg100".into(),
            sw_versions: BTreeMap::new(),
        },
        line: "line8".into(),
        seed: 1,
        source: "sim".into(),
        started_at_us: clock::now_us(),
        app_version: env!("CARGO_PKG_VERSION").into(),
        ..RunRecord::default()
    };
    let mut writer = RunWriter::begin(&store, &record).expect("a run");
    let fault = |row: i64| FaultRecord {
        code: 9001,
        code_name: "eb_unrequested".into(),
        lru: "eb_relay".into(),
        severity: "major".into(),
        at_us: clock::now_us(),
        bench_us: row * PERIOD_US,
        ..FaultRecord::default()
    };
    let rows = [9_000, 30_000, i64::from(TRIGGER)];
    let occurrences: Vec<_> = rows
        .into_iter()
        .map(|row| writer.fault(&fault(row)).expect("a fault").occurrence)
        .collect();
    writer.trace(&occurrences, &trace()).expect("a trace");
    writer
        .finish(&RunEnd {
            verdict: Verdict::Failed,
            finished_at_us: clock::now_us(),
            bench_time_us: ROWS as i64 * PERIOD_US,
            wall_time_us: 0,
        })
        .expect("an end");
    drop(writer);
    store.close().expect("closed");
}

fn column(signal: Signal, seed: u64) -> Vec<f64> {
    let definition = signal.definition();
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mut random = move || {
        // A linear congruential generator is enough to look like noise.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 40) as f64 / (1u64 << 24) as f64
    };
    let (low, high) = (definition.low, definition.high.min(definition.low + 1e5));
    let mut value = 0.0;
    let next = |row: usize| {
        match definition.kind {
            _ if row < 200 => value = f64::NAN,
            Kind::Number { lsb } => {
                let wave = (row as f64 / 3000.0 / seed as f64).sin() * 0.4 + 0.5;
                let noisy = low + (high - low) * (wave + (random() - 0.5) * 0.02);
                value = (noisy / lsb).round() * lsb;
            }
            // Some change in nearly every row, most of them every few seconds.
            Kind::Bit | Kind::Enum(_) => {
                let often = if seed.is_multiple_of(7) { 0.6 } else { 0.01 };
                if value.is_nan() || random() < often {
                    value = (random() * (high + 1.0)).floor().min(high);
                }
            }
        }
        value
    };
    (0..ROWS).map(next).collect()
}
