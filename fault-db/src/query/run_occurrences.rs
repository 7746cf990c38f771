//! All fault occurrences of one run in order, as input of the diagnosis.

use crate::backend::{from_row, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;

/// An occurrence of a fault in a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunOccurrence {
    /// The fault.
    pub fault: Id,
    /// Number of the fault.
    pub code: i64,
    /// Name of the fault's code.
    pub code_name: String,
    /// Part that the fault points at.
    pub lru: String,
    /// Index of the step that was under way, if any.
    pub step_index: Option<u32>,
    /// Bench time of the occurrence.
    pub bench_us: i64,
    /// Trace that shows the occurrence.
    pub trace_id: Option<Id>,
    /// Finding in English.
    pub message: String,
    /// The findings behind `message` as data: JSON of the program.
    pub findings: Option<String>,
}

impl Store {
    /// The occurrences of faults in a run, in order.
    pub fn run_occurrences(&self, run: Id) -> Result<Vec<RunOccurrence>, StoreError> {
        self.select(
            "listing a run's faults",
            "SELECT f.code, f.code_name, f.lru, o.step_index, o.bench_us, t.id, f.id, o.message,
                        o.findings
                     FROM run r JOIN fault_occurrence o ON o.run = r.seq
                     JOIN fault f ON f.seq = o.fault LEFT JOIN trace t ON t.seq = o.trace
                     WHERE r.id = ?1 ORDER BY o.seq",
            &values![run],
            |row| {
                Ok(from_row!(row => RunOccurrence:
                    code, code_name, lru, step_index, bench_us, trace_id, fault, message,
                    findings
                ))
            },
        )
    }
}
