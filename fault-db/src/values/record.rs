//! The records a caller hands in to be stored. Times ending in `at_us` are UTC.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::id::Id;
use crate::values::text_enum::text_enum;

/// Beginning of the `source` of a run that is an imported log.
pub const LOG_SOURCE: &str = "log of ";

text_enum! {
    /// Verdict of a step, a measurement or a whole run, as a column holds it. This crate knows no other crate, so the
    /// caller converts its own verdict.
    Verdict {
        /// Every expectation held.
        Passed = "passed",
        /// An expectation did not hold.
        Failed = "failed",
        /// The unit could not be tested.
        Error = "error",
        /// Not run, by choice or condition.
        Skipped = "skipped",
        /// An adaptive run found no fault: all steps passed, but they were not enough to accept the unit.
        Inconclusive = "inconclusive",
        /// Stopped by the operator.
        Aborted = "aborted",
    }
}

text_enum! {
    /// Kind of a record among the steps of a run.
    StepKind {
        /// The result of a step, or of one repetition of it.
        Step = "step",
        /// A try at a step that could not be tested; another try follows.
        Attempt = "attempt",
        /// A step that was run again only to reach the state it leaves, and that ended otherwise than before.
        Again = "again",
        /// Failure outside steps; the name says where.
        Outside = "outside",
    }
}

/// The unit under test, as a run finds it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnitRecord {
    /// Serial number; identifies the unit permanently.
    pub serial: String,
    /// Kind of unit.
    pub kind: String,
    /// Name of the unit configuration.
    pub config_name: String,
    /// Software version of each part of the unit.
    pub sw_versions: BTreeMap<String, String>,
}

/// A procedure file that a run uses.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ScriptRecord {
    /// Path as the operator would name it.
    pub path: String,
    /// SHA-256 of the file's text, in hex.
    pub sha256: String,
}

/// A run at its beginning.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunRecord {
    /// The unit under test.
    pub unit: UnitRecord,
    /// Line data in use.
    pub line: String,
    /// The train the unit is in, as the tester names it; empty if not given.
    pub train: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Name of the tester.
    pub operator: String,
    /// Where the unit is: `sim`, `serial:…`, `tcp:…`.
    pub source: String,
    /// Connection to the unit: `harness`, or `ptu` for the maintenance port alone; `None` if no tester led the run.
    pub connection: Option<String>,
    /// Symptom reported with the unit: a name of `symptoms.toml`.
    pub symptom: Option<String>,
    /// What the bench, its clock and its instruments were: JSON that the caller defines.
    pub evidence: Option<String>,
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
    /// Identifies the writing process, so that a reader can tell whether it still runs.
    pub owner: String,
    /// The procedure files used.
    pub scripts: Vec<ScriptRecord>,
    /// The earlier run whose unfinished procedures this run runs.
    pub continues: Option<Id>,
}

/// A run at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunEnd {
    /// The run's verdict.
    pub verdict: Verdict,
    /// When it ended.
    pub finished_at_us: i64,
    /// Duration on the bench's clock.
    pub bench_time_us: i64,
    /// Duration on the wall clock.
    pub wall_time_us: i64,
}

/// A finished step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepRecord {
    /// Index of the step in the run; rises from step to step.
    pub index: u32,
    /// The step's procedure.
    pub procedure: String,
    /// Kind of the step.
    pub kind: StepKind,
    /// Index of the step in its procedure, from 0; `None` for a failure outside steps.
    pub place: Option<u32>,
    /// Name that the procedure gives the step, or the place outside steps.
    pub name: String,
    /// Number of the repetition, from 1.
    pub turn: u32,
    /// Number of repetitions that were asked for.
    pub turns: u32,
    /// The step's verdict.
    pub verdict: Verdict,
    /// Bench time at the start of the step.
    pub started_bench_us: i64,
    /// Bench time that the step took.
    pub bench_time_us: i64,
    /// The reason of the verdict, in English; empty if there is nothing to say.
    pub message: String,
    /// The reason as data, from which texts in other languages are made: JSON that the caller defines.
    pub findings: Option<String>,
    /// Line of the script that defines the step.
    pub script_line: Option<u32>,
    /// Source of the limits in the step's expectations, in the caller's words.
    pub limit_source: Option<String>,
    /// Measurements of the step.
    pub measurements: Vec<MeasurementRecord>,
}

impl StepRecord {
    /// A step that passed at once and measured nothing, at this place of the run and of its procedure.
    pub fn passed(index: u32, procedure: impl Into<String>, name: impl Into<String>) -> Self {
        Self {
            index,
            procedure: procedure.into(),
            kind: StepKind::Step,
            place: Some(index),
            name: name.into(),
            turn: 1,
            turns: 1,
            verdict: Verdict::Passed,
            started_bench_us: 0,
            bench_time_us: 0,
            message: String::new(),
            findings: None,
            script_line: None,
            limit_source: None,
            measurements: Vec::new(),
        }
    }
}

/// A measured value with its limits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasurementRecord {
    /// Name within its step, as `eb_reaction`.
    pub name: String,
    /// The value; `None` if nothing could be measured. NaN is stored as NULL.
    pub value: Option<f64>,
    /// Unit of value and limits.
    pub unit: String,
    /// Lowest allowed value.
    pub low: Option<f64>,
    /// Highest allowed value.
    pub high: Option<f64>,
    /// Source of the limits, in the caller's words.
    pub limit_source: Option<String>,
    /// Verdict of the measurement.
    pub verdict: Verdict,
}

/// One occurrence of a fault.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaultRecord {
    /// Stable number of the fault.
    pub code: i64,
    /// Name of the fault, as `eb_relay_open`.
    pub code_name: String,
    /// Part that the fault points at, or the caller's word for no part. Unit, code and this part identify a fault.
    pub lru: String,
    /// Severity, a word of the caller: a database may hold words of another program.
    pub severity: String,
    /// Time of the occurrence.
    pub at_us: i64,
    /// Time of the occurrence on the bench's clock.
    pub bench_us: i64,
    /// Index of the step under way, if any; the step need not be recorded yet.
    pub step_index: Option<u32>,
    /// Description, in English.
    pub message: String,
    /// The description as data: JSON that the caller defines.
    pub findings: Option<String>,
    /// All signals at that moment.
    pub freeze: Vec<FreezeSample>,
}

/// One signal of a freeze frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FreezeSample {
    /// Name of the signal.
    pub name: String,
    /// Value of the signal; `None` if there was none.
    pub value: Option<f64>,
    /// Unit of the value.
    pub unit: String,
    /// The word for the value, for an enum or a bit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
}

/// A part's name for comparison: trimmed, in lower case.
pub(crate) fn part_name(part: &str) -> String {
    part.trim().to_lowercase()
}

/// The kind of an event whose body is a [`RepairRecord`].
pub(crate) const REPAIR: &str = "repair";

/// The kinds of events whose body is a [`CauseRecord`]: `cause` of a person, `diagnosed` of a run's diagnosis. The SQL
/// of `graph_sql` prefers a person's `cause`, as the first of both in alphabetical order.
pub(crate) const CAUSE: &str = "cause";
pub(crate) const DIAGNOSED: &str = "diagnosed";

/// The part that a fault comes from, as a person or the diagnosis of a run says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CauseRecord {
    /// The part that is the cause; empty if the fault is no consequence of another part and stands alone.
    pub part: String,
    /// Id of the run whose diagnosis found the cause; `None` if a person named it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run: Option<String>,
    /// Probability of the cause in that diagnosis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// Reason of the attribution.
    pub note: String,
}

/// A repair made for a fault.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RepairRecord {
    /// The part replaced or worked on.
    pub part: String,
    /// Serial number of the part taken out.
    pub serial_old: Option<String>,
    /// Serial number of the part put in.
    pub serial_new: Option<String>,
    /// Work that was done.
    pub note: String,
}
