//! Records and realistic signals for tests and benches.
#![allow(dead_code)] // each test file uses its part

use std::borrow::Borrow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fault_db::{
    CaseFault, CauseRecord, Channel, ChannelKind, FaultFilter, FaultRecord, FaultState,
    FreezeSample, Id, IdSource, MeasurementRecord, OpenOptions, Problem, RepairRecord, RunEnd,
    RunRecord, RunWriter, ScriptRecord, StatKey, StepRecord, Store, Synchronous, TraceData,
    UnitRecord, Verdict,
};

/// 2026-03-01 00:00:00 UTC.
pub const T0_US: i64 = 1_772_323_200_000_000;

/// The rows of a table: cells with ` | ` between them, remarks behind `#`.
pub fn rows<const N: usize>(table: &str) -> impl Iterator<Item = [&str; N]> {
    let rows = table.lines().filter(|row| !row.starts_with('#'));
    rows.map(|row| {
        let cells: Vec<_> = row.split(" | ").map(str::trim_end).collect();
        cells.try_into().expect("each cell of the row")
    })
}

/// A small generator with a seed, so that a failure repeats (xorshift64*).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// A number in -1 … 1, most often near 0.
    pub fn noise(&mut self) -> f64 {
        let uniform = |bits: u64| (bits >> 11) as f64 / (1u64 << 53) as f64;
        uniform(self.next()) + uniform(self.next()) - 1.0
    }

    pub fn one_in(&mut self, n: u64) -> bool {
        self.next().is_multiple_of(n)
    }
}

/// Ids that differ between sources of different seeds.
pub fn ids(seed: u64) -> IdSource {
    let mut random = Random::new(seed);
    let mut unix_ms = T0_US as u64 / 1000;
    IdSource::new(move || {
        unix_ms += 1;
        let mut bytes = [0; 10];
        bytes[..8].copy_from_slice(&random.next().to_be_bytes());
        bytes[8..].copy_from_slice(&random.next().to_be_bytes()[..2]);
        (unix_ms, bytes)
    })
}

pub fn open(path: &Path) -> Store {
    Store::open(path, OpenOptions::new(ids(1))).expect("a new or known file opens")
}

/// A file with ids of its own, written without waiting for the disk.
pub fn open_as(path: &Path, seed: u64) -> Store {
    let options = OpenOptions::new(ids(seed)).synchronous(Synchronous::Normal);
    Store::open(path, options).expect("opens")
}

/// Records a whole run; its id and the ids of the faults it saw.
#[track_caller]
pub fn recorded(
    store: &Store,
    record: &RunRecord,
    steps: &[StepRecord],
    faults: &[FaultRecord],
    end: &RunEnd,
) -> (Id, Vec<Id>) {
    let mut writer = RunWriter::begin(store, record).expect("begun");
    for step in steps {
        writer.step(step.clone()).expect("kept");
    }
    let seen = faults
        .iter()
        .map(|fault| writer.fault(fault).expect("stored").fault);
    let seen = seen.collect();
    writer.finish(end).expect("finished");
    (writer.id(), seen)
}

/// Records a run that failed.
#[track_caller]
pub fn failed_run(
    store: &Store,
    record: &RunRecord,
    steps: &[StepRecord],
    faults: &[FaultRecord],
) -> (Id, Vec<Id>) {
    recorded(store, record, steps, faults, &end(Verdict::Failed))
}

/// Confirms the repairs for which at least so many runs passed, the last of them this one.
#[track_caller]
pub fn confirm_passed(store: &Store, run: Id, least: usize) {
    let to_prove = store.repairs_to_prove(run).expect("read").into_iter();
    let proven = to_prove.filter(|repair| repair.passed.len() >= least);
    let proven: Vec<_> = proven
        .map(|repair| (repair.fault, "by the test".to_owned()))
        .collect();
    store.confirm_repairs(run, &proven).expect("stored");
}

/// The error of what is refused: it is of this kind, and its message has these words.
#[allow(unused_macros, reason = "each test file uses its part")]
macro_rules! refused {
    ($result:expr, $kind:pat $(if $also:expr)? $(, $words:expr)* $(,)?) => {{
        let of = stringify!($result);
        let error = $result.err().unwrap_or_else(|| panic!("{of}: no refusal"));
        let said = error.to_string();
        assert!(matches!(&error, $kind $(if $also)?), "{of}: {said}");
        $(assert!(said.contains($words), "{of}: {said}");)*
        error
    }};
}
#[allow(unused_imports, reason = "each test file uses its part")]
pub(crate) use refused;

/// The problems that a check of the store finds.
#[track_caller]
pub fn problems(store: &Store) -> Vec<Problem> {
    store.check().expect("checked").problems
}

/// The state of a fault.
#[track_caller]
pub fn state(store: &Store, fault: Id) -> FaultState {
    store.fault(fault).expect("known").fault.state
}

/// The kinds of these problems.
pub fn kinds(problems: &[Problem]) -> Vec<&'static str> {
    problems
        .iter()
        .map(|problem| problem.kind.as_str())
        .collect()
}

/// Whether the text of a problem has these words.
pub fn tells(problem: &Problem, words: &str) -> bool {
    problem.detail.to_string().contains(words)
}

/// A new file in a folder of its own, which goes with the first of the three.
pub fn new_history() -> (tempfile::TempDir, PathBuf, Store) {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("a.db");
    let store = open(&path);
    (dir, path, store)
}

/// The default but for this change.
pub fn with<T: Default>(change: impl FnOnce(&mut T)) -> T {
    let mut made = T::default();
    change(&mut made);
    made
}

/// A filter of faults that is empty but for this change.
pub fn filter(change: impl FnOnce(&mut FaultFilter)) -> FaultFilter {
    with(change)
}

/// Permitted acts of people in a test.
pub trait Deeds: Borrow<Store> {
    #[track_caller]
    fn put_state(&self, fault: Id, to: FaultState, who: &str, note: &str, at_us: i64) {
        let done = self.borrow().set_state(fault, to, who, note, at_us);
        done.expect("a state");
    }

    #[track_caller]
    fn put_acknowledged(&self, fault: Id, who: &str, note: &str, at_us: i64) {
        self.put_state(fault, FaultState::Acknowledged, who, note, at_us);
    }

    #[track_caller]
    fn put_repair(&self, fault: Id, repair: &RepairRecord, who: &str, at_us: i64) {
        let done = self.borrow().record_repair(fault, repair, who, at_us);
        done.expect("a repair");
    }

    /// Stores a repair of all faults of the case: the named fault and the rest.
    #[track_caller]
    fn put_case_repair(
        &self,
        fault: Id,
        repair: &RepairRecord,
        who: &str,
        at_us: i64,
    ) -> (CaseFault, Vec<CaseFault>) {
        let done = self.borrow().repair_case(fault, repair, who, at_us);
        done.expect("a repair")
    }

    #[track_caller]
    fn put_diagnosed(&self, faults: &[Id], cause: &CauseRecord, at_us: i64) -> Vec<Id> {
        let done = self.borrow().attribute_diagnosed(faults, cause, at_us);
        done.expect("attributed")
    }

    #[track_caller]
    fn put_note(&self, fault: Id, who: &str, note: &str, at_us: i64) {
        let done = self.borrow().add_note(fault, who, note, at_us);
        done.expect("a note");
    }

    #[track_caller]
    fn put_run_note(&self, run: Id, who: &str, text: &str, at_us: i64) {
        let done = self.borrow().add_run_note(run, who, text, at_us);
        done.expect("a note");
    }
}

impl Deeds for Store {}

/// A run that stores a trace.
pub trait Traces {
    fn put_trace(&mut self, occurrences: &[Id], trace: &TraceData) -> Id;
}

impl Traces for RunWriter<'_> {
    #[track_caller]
    fn put_trace(&mut self, occurrences: &[Id], trace: &TraceData) -> Id {
        self.trace(occurrences, trace).expect("a trace")
    }
}

/// All that faults are counted by.
pub const STAT_KEYS: [StatKey; 6] = [
    StatKey::Code,
    StatKey::Lru,
    StatKey::Cause,
    StatKey::Unit,
    StatKey::Line,
    StatKey::All,
];

pub fn run_record(serial: &str) -> RunRecord {
    RunRecord {
        unit: UnitRecord {
            serial: serial.to_owned(),
            kind: "ATC".to_owned(),
            config_name: "default".to_owned(),
            sw_versions: BTreeMap::from([("atp".to_owned(), "1.2.0".to_owned())]),
        },
        line: "line-1".to_owned(),
        seed: u64::MAX - 3,
        operator: "kim".to_owned(),
        source: "sim".to_owned(),
        started_at_us: T0_US,
        app_version: "0.1.0".to_owned(),
        scripts_sha256: "ab".repeat(32),
        unit_config_sha256: "cd".repeat(32),
        owner: "pid 1 started 2".to_owned(),
        scripts: vec![ScriptRecord {
            path: "scripts/atp/speed.star".to_owned(),
            sha256: "ef".repeat(32),
        }],
        ..RunRecord::default()
    }
}

pub fn step(index: u32) -> StepRecord {
    StepRecord {
        started_bench_us: i64::from(index) * 50_000,
        bench_time_us: 50_000,
        script_line: Some(12),
        ..StepRecord::passed(index, "atp.overspeed", format!("step {index}"))
    }
}

/// A step that measured the reaction time of the emergency brake.
pub fn measured_step(index: u32) -> StepRecord {
    StepRecord {
        measurements: vec![measurement("eb_reaction", 0.42)],
        ..step(index)
    }
}

pub fn measurement(name: &str, value: f64) -> MeasurementRecord {
    MeasurementRecord {
        name: name.to_owned(),
        value: Some(value),
        unit: "s".to_owned(),
        low: None,
        high: Some(0.5),
        limit_source: Some("default: of the test".to_owned()),
        verdict: Verdict::Passed,
    }
}

pub fn fault(code: i64, at_us: i64) -> FaultRecord {
    FaultRecord {
        code,
        code_name: format!("FAULT_{code}"),
        lru: "ATP-RX".to_owned(),
        severity: "major".to_owned(),
        at_us,
        bench_us: at_us - T0_US,
        step_index: Some(3),
        findings: None,
        message: "speed code lost".to_owned(),
        freeze: vec![
            FreezeSample {
                name: "speed".to_owned(),
                value: Some(68.1),
                unit: "km/h".to_owned(),
                label: None,
            },
            FreezeSample {
                name: "eb".to_owned(),
                value: Some(1.0),
                unit: String::new(),
                label: Some("applied".to_owned()),
            },
            FreezeSample {
                name: "distance".to_owned(),
                value: None,
                unit: "m".to_owned(),
                label: None,
            },
        ],
    }
}

/// A repair of a part: its serial numbers before and after, and a note; what is empty is not said.
pub fn repair_of(part: &str, old: &str, new: &str, note: &str) -> RepairRecord {
    let serial = |text: &str| (!text.is_empty()).then(|| text.to_owned());
    RepairRecord {
        part: part.to_owned(),
        serial_old: serial(old),
        serial_new: serial(new),
        note: note.to_owned(),
    }
}

pub fn end(verdict: Verdict) -> RunEnd {
    RunEnd {
        verdict,
        finished_at_us: T0_US + 5_000_000,
        bench_time_us: 60_000_000,
        wall_time_us: 5_000_000,
    }
}

fn number(name: &str, unit: &str, lsb: f64) -> Channel {
    Channel {
        name: name.to_owned(),
        unit: unit.to_owned(),
        kind: ChannelKind::Number { lsb },
    }
}

/// 40 channels of a train that brakes from 68 km/h, 50 ms a row: 12 numbers (noisy measurements
/// quantised by their lsb, and values that change seldom), 8 enums, 20 bits.
pub fn realistic_trace(rows: usize, seed: u64) -> TraceData {
    let mut random = Random::new(seed);
    let mut channels = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let quantised = |value: f64, lsb: f64| (value / lsb).round() * lsb;
    let speed = |row: usize| {
        let t_s = row as f64 * 0.05;
        if t_s < 10.0 {
            60.0 + 0.8 * t_s
        } else {
            (68.0 - 3.5 * (t_s - 10.0)).max(0.0)
        }
    };
    let positions: Vec<f64> = (0..rows)
        .scan(0.0, |position, row| {
            let before = *position;
            *position += speed(row) / 72.0;
            Some(before)
        })
        .collect();
    let mut noisy = |name: &str, unit: &str, lsb: f64, noise_lsb: f64, f: &dyn Fn(usize) -> f64| {
        channels.push(number(name, unit, lsb));
        let sample = |row| quantised(f(row) + random.noise() * noise_lsb * lsb, lsb);
        columns.push((0..rows).map(sample).collect());
    };
    noisy("speed", "km/h", 0.1, 0.8, &speed);
    noisy("speed_2", "km/h", 0.1, 0.8, &speed);
    noisy("tacho_pulses_1", "1", 1.0, 0.6, &|row| speed(row) * 0.35);
    noisy("tacho_pulses_2", "1", 1.0, 0.6, &|row| speed(row) * 0.35);
    noisy("position", "m", 0.01, 0.0, &|row| positions[row]);
    noisy("acceleration", "m/s2", 0.01, 1.5, &|row| {
        if row < 200 { 0.22 } else { -0.97 }
    });
    noisy("code_level", "dBm", 0.5, 0.8, &|_| -32.0);
    noisy("speed_limit", "km/h", 1.0, 0.0, &|row| {
        if row < 195 { 73.0 } else { 40.0 }
    });
    noisy("target_speed", "km/h", 0.1, 0.0, &|row| {
        if row < 195 { 68.0 } else { 35.0 }
    });
    noisy("effort", "1", 1.0, 3.0, &|row| {
        if row < 200 { 180.0 } else { -640.0 }
    });
    noisy("supply", "V", 0.1, 0.6, &|_| 110.2);
    noisy("temperature", "degC", 0.5, 0.1, &|_| 41.0);
    for (count, levels, kind) in [
        (
            8,
            5,
            ChannelKind::Enum {
                labels: (0..5).map(|n| (n, format!("state {n}"))).collect(),
            },
        ),
        (20, 2, ChannelKind::Bit),
    ] {
        for n in 0..count {
            let name = format!("{}_{n}", if levels == 2 { "bit" } else { "enum" });
            channels.push(Channel {
                name,
                unit: String::new(),
                kind: kind.clone(),
            });
            let mut value = random.next() % levels;
            let column = (0..rows).map(|_| {
                if random.one_in(120 + 40 * n) {
                    value = (value + 1) % levels;
                }
                value as f64
            });
            columns.push(column.collect());
        }
    }
    TraceData {
        t0_bench_us: 12_000_000,
        t0_us: T0_US,
        period_us: 50_000,
        trigger_row: Some((rows / 3) as u32),
        channels,
        columns,
        ..TraceData::default()
    }
}

/// Changes a file by hand, past its triggers, which stay as they are.
pub fn change(path: &Path, sql: &str) {
    let conn = rusqlite::Connection::open(path).expect("opens");
    let triggers: Vec<(String, String)> = {
        let all = "SELECT name, sql FROM sqlite_schema WHERE type = 'trigger'";
        let mut select = conn.prepare(all).expect("triggers");
        let rows = select.query_map([], |row| Ok((row.get(0)?, row.get(1)?)));
        let rows = rows.expect("triggers").collect::<Result<_, _>>();
        rows.expect("triggers")
    };
    let drop = triggers
        .iter()
        .map(|(name, _)| format!("DROP TRIGGER {name};"));
    let all = format!(
        "PRAGMA foreign_keys = OFF; BEGIN; {} {sql}",
        drop.collect::<String>()
    );
    conn.execute_batch(&all)
        .unwrap_or_else(|error| panic!("{sql}: {error}"));
    for (_, sql) in triggers {
        // Not on what is no table any more.
        let _ = conn.execute_batch(&sql);
    }
    conn.execute_batch("COMMIT").expect("changed");
}
