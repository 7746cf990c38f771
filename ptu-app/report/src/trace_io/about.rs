//! The description of a trace that every file format keeps beside the samples.

use fault_db::{Channel, TraceHead};
use serde::{Deserialize, Serialize};

use crate::trace_notes::TraceNote;
use ptu_runs::clock::rfc3339;

/// Name of the description in files that have named metadata.
pub const NAME: &str = "ptu.trace";

/// Unit, time and signals of a trace, or of the part of a trace that a file holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TraceInfo {
    pub trace_id: String,
    /// The run in which the trace was recorded.
    pub run_id: String,
    pub unit_serial: String,
    /// UTC of the first row, for people.
    pub t0: String,
    /// UTC of the first row, microseconds since 1970.
    pub t0_us: i64,
    /// Bench time of the first row, microseconds.
    pub t0_bench_us: i64,
    /// Time from row to row, microseconds.
    pub period_us: i64,
    pub rows: usize,
    /// Row of the trigger, which has the time 0; the trigger may be before or after all rows of a part.
    pub trigger_row: Option<i64>,
    /// The trace was cut short: it ends before its window.
    pub partial: bool,
    /// Some samples are missing.
    pub gaps: bool,
    /// Name, unit and kind of each signal; kinds with smallest step or words.
    pub channels: Vec<Channel>,
    /// Notes at places in the trace; a file of an earlier version has none.
    #[serde(default)]
    pub notes: Vec<TraceNote>,
}

impl TraceInfo {
    /// Description of a part of a trace: `rows` rows from `first` on.
    pub fn part(head: &TraceHead, channels: Vec<Channel>, first: usize, rows: usize) -> Self {
        let later_us = (first as i64).saturating_mul(head.period_us);
        let t0_us = head.t0_us.saturating_add(later_us);
        Self {
            trace_id: head.id.to_string(),
            run_id: head.run_id.to_string(),
            unit_serial: head.unit_serial.clone(),
            t0: rfc3339(t0_us),
            t0_us,
            t0_bench_us: head.t0_bench_us.saturating_add(later_us),
            period_us: head.period_us,
            rows,
            trigger_row: head.trigger_row.map(|row| i64::from(row) - first as i64),
            partial: head.partial,
            gaps: head.gaps,
            channels,
            notes: Vec::new(),
        }
    }

    /// Time of a row from the trigger, or from the first row where there is none; microseconds.
    pub fn time_us(&self, row: usize) -> i64 {
        (row as i64 - self.trigger_row.unwrap_or(0)).saturating_mul(self.period_us)
    }

    /// The description as one line of JSON.
    pub fn json(&self) -> String {
        // Texts, whole numbers and finite steps: there is nothing JSON cannot say.
        serde_json::to_string(self).unwrap_or_default()
    }
}
