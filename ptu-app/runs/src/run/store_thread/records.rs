//! Records of a run: each is written to the database, and held so that it can be written again elsewhere.

use fault_db::{
    FaultRecord, Id, RecordingRecord, RunEnd, RunWriter, StepRecord, StoreError, TraceData,
};

/// Values of traces of a run that are held until its end (32 MB), to write the run again if its file is lost.
const MOST_TRACE_VALUES: usize = 4_000_000;
/// Steps that are held (about 90 MB); a longer run is kept only as far as its open file can be copied.
pub const MOST_STEPS: usize = 100_000;

/// What is recorded of a run, in order.
pub enum Entry {
    Step(StepRecord),
    /// A fault, which is recorded at once; faults are numbered from 0 through the run.
    Fault(FaultRecord),
    /// A trace and the numbers of the faults it shows.
    Trace(Vec<usize>, TraceData),
    /// Stimuli of the procedure whose traces were recorded since the last of these.
    Recording(RecordingRecord),
    /// A line to print once all before it is in the file.
    Say(String),
    Finish(RunEnd),
}

/// Prints a line; must not block.
pub type LinePrinter = Box<dyn FnMut(String) + Send>;

/// Lines that are printed once the records they report are in the file.
#[derive(Default)]
pub struct Lines {
    pub line_printer: Option<LinePrinter>,
    pub waiting: Vec<String>,
}

impl Lines {
    /// Prints the waiting lines: their records are in the file.
    pub fn stored(&mut self) {
        for line in self.waiting.drain(..) {
            if let Some(line_printer) = &mut self.line_printer {
                line_printer(line);
            }
        }
    }
}

/// Identifiers of recorded rows that later entries refer to.
#[derive(Default)]
pub struct RecordedIds {
    pub occurrences: Vec<Id>,
    /// Number of ids recorded in another file.
    pub before: usize,
    traces: Vec<Id>,
    /// Lines to print on the run.
    pub lines: Lines,
    /// All that was recorded, in order.
    pub records: Vec<Entry>,
    steps: usize,
    trace_values: usize,
    /// Traces that are too much to be held.
    pub left_out: usize,
}

impl RecordedIds {
    /// Holds an entry until the end of the run, to write it again if the file is lost.
    pub fn hold(&mut self, entry: Entry) {
        match &entry {
            Entry::Say(_) => return,
            Entry::Step(_) => self.steps += 1,
            Entry::Trace(_, trace) => {
                self.trace_values += trace.rows() * trace.columns.len();
                if self.trace_values > MOST_TRACE_VALUES {
                    self.left_out += 1;
                    return;
                }
            }
            // This recording belongs to traces that were left out.
            Entry::Recording(_) if self.left_out > 0 => return,
            _ => {}
        }
        if self.is_too_long() {
            self.records = Vec::new();
        } else {
            self.records.push(entry);
        }
    }

    /// Whether more was recorded than is held.
    pub fn is_too_long(&self) -> bool {
        self.steps > MOST_STEPS
    }

    /// Holds all that comes still, to the end.
    pub fn hold_all(&mut self, entries: impl Iterator<Item = Entry>) {
        for entry in entries {
            match entry {
                Entry::Say(line) => self.lines.waiting.push(line),
                entry => self.hold(entry),
            }
        }
    }
}

/// Records one entry; `again` = the first try failed: a step that was not written then waits with the writer.
pub fn keep(
    writer: &mut RunWriter<'_>,
    kept: &mut RecordedIds,
    entry: &Entry,
    again: bool,
) -> Result<(), StoreError> {
    match entry {
        Entry::Step(_) if again => writer.flush(),
        Entry::Step(step) => writer.step(step.clone()),
        Entry::Fault(fault) => {
            kept.occurrences.push(writer.fault(fault)?.occurrence);
            Ok(())
        }
        Entry::Trace(faults, trace) => {
            let here = faults.iter().filter(|i| **i >= kept.before);
            let shown: Vec<_> = here
                .filter_map(|i| kept.occurrences.get(*i).copied())
                .collect();
            kept.traces.push(writer.trace(&shown, trace)?);
            Ok(())
        }
        Entry::Recording(recording) => {
            writer.recording(recording, &kept.traces)?;
            kept.traces.clear();
            Ok(())
        }
        Entry::Say(line) => {
            kept.lines.waiting.push(line.clone());
            Ok(())
        }
        Entry::Finish(end) => writer.finish(end),
    }
}
