//! What a caller hands in to be stored, in plain types. Times ending in `at_us` are UTC.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::text_enum::text_enum;

text_enum! {
    /// How a step, a measurement or a whole run came out.
    Verdict {
        /// Every expectation held.
        Passed = "passed",
        /// An expectation did not hold.
        Failed = "failed",
        /// It could not be tested.
        Error = "error",
        /// Not run, by choice or condition.
        Skipped = "skipped",
        /// Stopped by the operator.
        Aborted = "aborted",
    }
}

/// The unit under test, as a run finds it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitRecord {
    /// Serial number; names the unit for ever.
    pub serial: String,
    /// Kind of unit.
    pub kind: String,
    /// Name of the unit configuration.
    pub config_name: String,
    /// Software version of each of its parts.
    pub sw_versions: BTreeMap<String, String>,
}

/// A procedure file that a run uses.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ScriptRecord {
    /// Path as the operator would name it.
    pub path: String,
    /// SHA-256 of its text, in hex.
    pub sha256: String,
}

/// A run at its beginning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunRecord {
    /// The unit under test.
    pub unit: UnitRecord,
    /// Line data in use.
    pub line: String,
    /// The train the unit is in, as the tester names it; empty if nobody said.
    pub train: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Who is testing.
    pub operator: String,
    /// Where the unit is: `sim`, `serial:…`, `tcp:…`.
    pub source: String,
    /// When it began.
    pub started_at_us: i64,
    /// Version of the program.
    pub app_version: String,
    /// SHA-256 over all scripts, in hex.
    pub scripts_sha256: String,
    /// SHA-256 of the unit configuration, in hex.
    pub unit_config_sha256: String,
    /// Faults injected on purpose, if any.
    pub injected: Option<String>,
    /// Names the writing process, such that a reader can tell whether it still lives.
    pub owner: String,
    /// The procedure files used.
    pub scripts: Vec<ScriptRecord>,
}

/// A run at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunEnd {
    /// How it came out.
    pub verdict: Verdict,
    /// When it ended.
    pub finished_at_us: i64,
    /// Time that passed on the bench.
    pub bench_time_us: i64,
    /// Time that passed for the operator.
    pub wall_time_us: i64,
}

/// A step, once it is over.
#[derive(Clone, Debug, PartialEq)]
pub struct StepRecord {
    /// Place in the run; must rise from step to step.
    pub index: u32,
    /// The procedure it belongs to.
    pub procedure: String,
    /// Its name.
    pub name: String,
    /// How it came out.
    pub verdict: Verdict,
    /// Bench time at its start.
    pub started_bench_us: i64,
    /// Bench time it took.
    pub bench_time_us: i64,
    /// Why, in words; empty when there is nothing to say.
    pub message: String,
    /// Line of the script it comes from.
    pub script_line: Option<u32>,
    /// What it measured.
    pub measurements: Vec<MeasurementRecord>,
}

/// A measured value with its limits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasurementRecord {
    /// Its name.
    pub name: String,
    /// The value; none if nothing could be measured. NaN is stored as none.
    pub value: Option<f64>,
    /// Unit of value and limits.
    pub unit: String,
    /// Lowest allowed value.
    pub low: Option<f64>,
    /// Highest allowed value.
    pub high: Option<f64>,
    /// How it came out.
    pub verdict: Verdict,
}

/// A fault, seen once.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultRecord {
    /// Stable number of the fault.
    pub code: i64,
    /// Its name.
    pub code_name: String,
    /// Replaceable part it points at; empty if unknown.
    pub lru: String,
    /// How bad it is, in the caller's words.
    pub severity: String,
    /// When.
    pub at_us: i64,
    /// When, on the bench's clock.
    pub bench_us: i64,
    /// Step under way, if any; it need not be recorded yet.
    pub step_index: Option<u32>,
    /// What was seen, in words.
    pub message: String,
    /// All signals at that moment.
    pub freeze: Vec<FreezeSample>,
}

/// One signal of a freeze frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FreezeSample {
    /// Name of the signal.
    pub name: String,
    /// Its value; none if it had none.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: String,
    /// The value's word, for an enum or a bit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
}

/// A part's name as it is compared: people write it as they like.
pub(crate) fn part_name(part: &str) -> String {
    part.trim().to_lowercase()
}

/// A repair made for a fault.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RepairRecord {
    /// The part changed or worked on.
    pub part: String,
    /// Serial number of the part taken out.
    pub serial_old: Option<String>,
    /// Serial number of the part put in.
    pub serial_new: Option<String>,
    /// What was done.
    pub note: String,
}
