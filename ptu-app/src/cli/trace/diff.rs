//! `ptu trace diff`: two traces side by side.

use ptu_report::words::{Words, fill};
use std::fmt::Write as _;
use std::path::Path;

use clap::Args;
use fault_db::{Id, Store, TraceData};
use serde_json::json;

use super::explained::{compared, deviations_json, deviations_text};
use super::plot::lanes;
use crate::cli::{Json, ScriptsOption, answered};
use ptu_report::trace_io::{Columns, TimeUnit, beside, is_importable};
use ptu_runs::failure::{Asked, Exit, Failure};
use ptu_runs::replay::{Comparison, Original, Rule, compare, good_twin, rule_between};
use ptu_runs::stdio;

/// Say where two traces differ, aligned at their triggers: which signals, when first, by how much
///
/// Numbers differ if they are more than one step of their signal apart, words and bits if they are not the same. If
/// one of the traces comes from a unit on a port, they differ only beyond what its clock explains (two rows, and a
/// tolerance for each unit of measure). The number of log entries (`events`) is not compared; on a port neither are
/// efforts, accelerations and counts of frames.
///
/// B may be a .csv, .parquet or .mcap file: an export, or another program's table with a column of times or messages in
/// JSON. Times in seconds count from the trigger; dates and the times of messages are UTC. A file of another time is
/// laid with its beginning at the beginning of the trace. Each row of the trace is compared with the last sample before
/// it.
///
/// Exit codes: 0 no signal differs, 1 one does.
///
/// Examples:
///   ptu trace diff 59c2ce97 latest
///   ptu trace diff latest twin --signal speed,speed1,speed2,eb
///   ptu trace diff latest oscilloscope.csv --shift -0.35
///   ptu trace diff latest oscilloscope.csv --map CH1=eb --time x-axis --time-unit ms
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct DiffArguments {
    /// Trace A: an id, its beginning or end (at least 4 digits), or `latest`
    #[arg(value_name = "A")]
    came: String,
    /// Trace B; or `twin`: a sound unit with the same stimuli; or a .csv, .parquet or .mcap file
    #[arg(value_name = "B")]
    expected: String,
    /// Only these signals
    #[arg(long = "signal", value_name = "NAME[,NAME]", value_delimiter = ',')]
    signals: Vec<String>,
    /// Shift a file's samples to this many seconds later; negative: earlier
    #[arg(long, value_name = "SECONDS", default_value = "0", hide_default_value = true,
        allow_hyphen_values = true, value_parser = shift_argument)]
    shift: f64,
    /// Compare column NAME of a file with SIGNAL of the trace
    #[arg(long = "map", value_name = "NAME=SIGNAL", value_parser = map_argument)]
    names: Vec<(String, String)>,
    /// The column of a file that has the times
    #[arg(long, value_name = "NAME")]
    time: Option<String>,
    /// The unit of a file's times: s, ms, us or ns [default: as the column's name says, else s]
    #[arg(long, value_name = "UNIT")]
    time_unit: Option<TimeUnit>,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl DiffArguments {
    pub fn run(self, store: &Store) -> Result<Exit, Failure> {
        let a = store.resolve_trace(&self.came)?;
        let came = store.trace(a)?;
        let file = Path::new(&self.expected);
        let sides = if is_importable(file) {
            self.with_file(store, a, came, file)?
        } else if file.extension().is_some() {
            return Err(Failure::usage(Asked::NoComparable(
                file.display().to_string(),
            )));
        } else if self.shift != 0.0 {
            return Err(Failure::usage(Asked::ShiftOfFile));
        } else if !self.names.is_empty() || self.time.is_some() || self.time_unit.is_some() {
            return Err(Failure::usage(Asked::ColumnsOfFile));
        } else if self.expected == "twin" {
            let original = Original::read(store, a)?;
            let (twin, rule) = good_twin(&original, &self.scripts.find()?)?;
            ComparedTraces::new("twin".to_owned(), came, twin, rule)
        } else {
            let b = store.resolve_trace(&self.expected)?;
            let rule = rule_between(store, a, b)?;
            ComparedTraces::new(b.to_string(), came, store.trace(b)?, rule)
        };
        let mut comparison = compare(&sides.came, &sides.expected, &sides.rule, &self.signals)?;
        if let Some(window_s) = sides.window_s {
            comparison.window_s = window_s;
        }
        let is_asked = |name: &String| self.signals.is_empty() || self.signals.contains(name);
        let unknown = sides.unknown.iter().filter(|name| is_asked(name));
        comparison.missing.extend(unknown.cloned());
        let document = || {
            json!({
                "a": a.to_string(), "b": sides.name,
                "from_s": comparison.window_s.0, "to_s": comparison.window_s.1,
                "missing_in_a": comparison.missing, "missing_in_b": comparison.missing_expected,
                "deviations": deviations_json(&comparison),
            })
        };
        let differs = !comparison.deviations.is_empty();
        let told = (self.json).answer(document, || text(a, &sides, &comparison));
        answered(told, if differs { Exit::Failed } else { Exit::Passed })
    }

    fn with_file(
        &self,
        store: &Store,
        a: Id,
        came: TraceData,
        file: &Path,
    ) -> Result<ComparedTraces, Failure> {
        let shift_us = (self.shift * 1e6) as i64;
        let asked = Columns {
            names: self.names.clone(),
            time: self.time.clone(),
            unit: self.time_unit,
        };
        let (aligned, rule) = beside(store, (a, came), file, shift_us, &asked)?;
        if aligned.laid_at_begin {
            let said = Words::shown().terminal.other_time;
            stdio::note(&fill(said, &[("file", &self.expected)]));
        }
        Ok(ComparedTraces {
            name: self.expected.clone(),
            came: aligned.trace,
            expected: aligned.imported,
            rule,
            unknown: aligned.unknown,
            window_s: Some(aligned.window_s),
        })
    }
}

/// Two traces to compare.
struct ComparedTraces {
    /// Name of trace B: its id, `twin` or the file.
    name: String,
    came: TraceData,
    expected: TraceData,
    rule: Rule,
    /// Signals of the file that trace A does not have.
    unknown: Vec<String>,
    /// Compared span, s from the trigger, if B is a file; else the rows give the span.
    window_s: Option<(f64, f64)>,
}

impl ComparedTraces {
    fn new(name: String, came: TraceData, expected: TraceData, rule: Rule) -> Self {
        Self {
            name,
            came,
            expected,
            rule,
            unknown: Vec::new(),
            window_s: None,
        }
    }
}

fn map_argument(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=');
    let parts = parts.filter(|(name, signal)| !name.is_empty() && !signal.is_empty());
    let (name, signal) = parts.ok_or_else(|| format!("\"{text}\" is not NAME=SIGNAL"))?;
    Ok((name.to_owned(), signal.to_owned()))
}

fn shift_argument(text: &str) -> Result<f64, String> {
    // At most a year earlier or later.
    let seconds = text.parse::<f64>().ok();
    let seconds = seconds.filter(|seconds| seconds.abs() < 3.2e7);
    seconds.ok_or_else(|| format!("\"{text}\" is no number of seconds"))
}

fn text(a: Id, sides: &ComparedTraces, found: &Comparison) -> String {
    let words = Words::shown();
    let ComparedTraces {
        name: b,
        came,
        expected,
        ..
    } = sides;
    let mut text = format!("A {a}\nB {b}\n{}\n", compared(found.window_s, words));
    for (missing, of) in [(&found.missing, "A"), (&found.missing_expected, "B")] {
        if !missing.is_empty() {
            let of = [("of", &of as _), ("names", &missing.join(", ") as _)];
            let _ = writeln!(text, "{}", fill(words.traces.not_in, &of));
        }
    }
    if found.deviations.is_empty() {
        text.push_str(words.traces.no_deviation);
        return text;
    }
    text.push_str(&deviations_text(found, "A", "B"));
    let names: Vec<_> = found.deviations.iter().map(|d| d.signal.as_str()).collect();
    let _ = write!(text, "\n{}", lanes(came, expected, &names));
    text
}
