//! The writer: one thread owns the database and takes what is to be recorded, in order.

use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use fault_db::{
    FaultRecord, Id, RecordingRecord, RunEnd, RunRecord, RunWriter, StepRecord, Store, StoreError,
    TraceData,
};

use crate::failure::Failure;
use crate::stop::Stop;

/// Entries that may wait for the disk; a bench that produces more waits for the writer.
const QUEUE: usize = 4096;
/// A run under way waits so long for another writer: it would lose all that is still to come, and its thread
/// keeps nobody waiting but the bench.
const PATIENCE_MS: u32 = 30_000;
/// Steps reach the file at least this often.
const FLUSH: Duration = Duration::from_millis(250);

/// Something to record.
enum Entry {
    Step(StepRecord),
    /// A fault, numbered from 0 through the run.
    Fault(FaultRecord),
    /// A trace and the numbers of the faults it shows.
    Trace(Vec<usize>, TraceData),
    /// What the traces since the last recording came from.
    Recording(RecordingRecord),
    Finish(RunEnd),
}

/// The sending end.
pub struct RunStore {
    entries: SyncSender<Entry>,
    thread: JoinHandle<(Store, Result<(), StoreError>)>,
    /// The run's id.
    pub id: Id,
}

impl RunStore {
    /// Begins the run: its row is on the disk when this returns. Should writing fail later, `stop` is pressed
    /// at once: nobody drives a unit for a run that is not kept.
    ///
    /// # Errors
    /// The database does not take it.
    pub fn begin(store: Store, record: RunRecord, stop: &Stop) -> Result<Self, Failure> {
        let (entries, receiver) = mpsc::sync_channel(QUEUE);
        let (begun, beginning) = mpsc::sync_channel(1);
        let stop = stop.clone();
        let thread = std::thread::Builder::new()
            .name("store".into())
            .spawn(move || {
                let result = write(&store, &record, &receiver, &begun, &stop);
                (store, result)
            })
            .map_err(|error| Failure::bench(format!("cannot start the writer: {error}")))?;
        match beginning.recv() {
            Ok(id) => Ok(Self {
                entries,
                thread,
                id,
            }),
            Err(_) => Err(match thread.join() {
                Ok((_, Err(error))) => error.into(),
                _ => Failure::bench("the writer ended before it began"),
            }),
        }
    }

    /// Records a step.
    pub fn step(&self, step: StepRecord) {
        self.send(Entry::Step(step));
    }

    /// Records a fault at once; faults are numbered from 0 in the order of these calls.
    pub fn fault(&self, fault: FaultRecord) {
        self.send(Entry::Fault(fault));
    }

    /// Records a trace of the faults with these numbers.
    pub fn trace(&self, faults: Vec<usize>, trace: TraceData) {
        self.send(Entry::Trace(faults, trace));
    }

    /// Records what was done in the procedure whose traces were recorded last.
    pub fn recording(&self, recording: RecordingRecord) {
        self.send(Entry::Recording(recording));
    }

    /// A send fails only after the writer has ended with an error, which `finish` returns.
    fn send(&self, entry: Entry) {
        let _ = self.entries.send(entry);
    }

    /// Ends the run and gives the store back.
    ///
    /// # Errors
    /// The first error of writing.
    pub fn finish(self, end: RunEnd) -> Result<Store, Failure> {
        self.send(Entry::Finish(end));
        drop(self.entries);
        match self.thread.join() {
            Ok((store, Ok(()))) => Ok(store),
            Ok((_, Err(error))) => Err(error.into()),
            Err(_) => Err(Failure::bench("the writer ended unexpectedly")),
        }
    }
}

fn write(
    store: &Store,
    record: &RunRecord,
    entries: &Receiver<Entry>,
    begun: &SyncSender<Id>,
    stop: &Stop,
) -> Result<(), StoreError> {
    // Nothing is lost yet: a file that is locked is said as soon as any.
    let mut writer = RunWriter::begin(store, record)?;
    store.set_busy_timeout_ms(PATIENCE_MS)?;
    let _ = begun.send(writer.id());
    let result = write_entries(&mut writer, entries);
    if result.is_err() {
        stop.press_once();
        // What still comes is taken off the queue so that nobody waits.
        entries.iter().for_each(drop);
    }
    result
}

fn write_entries(writer: &mut RunWriter<'_>, entries: &Receiver<Entry>) -> Result<(), StoreError> {
    let mut occurrences = Vec::new();
    let mut traces = Vec::new();
    let mut flushed = Instant::now();
    loop {
        match entries.recv_timeout(FLUSH) {
            Ok(Entry::Step(step)) => writer.step(step)?,
            Ok(Entry::Fault(fault)) => occurrences.push(writer.fault(&fault)?.occurrence),
            Ok(Entry::Trace(faults, trace)) => {
                let shown: Vec<_> = faults
                    .iter()
                    .filter_map(|i| occurrences.get(*i).copied())
                    .collect();
                traces.push(writer.trace(&shown, &trace)?);
            }
            Ok(Entry::Recording(recording)) => {
                writer.recording(&recording, &traces)?;
                traces.clear();
            }
            Ok(Entry::Finish(end)) => return writer.finish(&end),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return writer.flush(),
        }
        if flushed.elapsed() >= FLUSH {
            writer.flush()?;
            flushed = Instant::now();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use fault_db::{OpenOptions, UnitRecord, Verdict};

    use super::*;
    use crate::clock;

    /// Goal: another program that holds the file for longer than it may when it is opened costs a run nothing.
    #[test]
    fn a_run_under_way_waits_for_another_writer() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("history.db");
        let options = OpenOptions::new(clock::ids()).busy_timeout_ms(1);
        let store = Store::open(&file, options).expect("a database");
        let record = RunRecord {
            unit: UnitRecord {
                serial: "ATC-7".into(),
                kind: "ATC".into(),
                config_name: "sg100".into(),
                sw_versions: BTreeMap::new(),
            },
            line: "line8".into(),
            train: String::new(),
            seed: 1,
            operator: String::new(),
            source: "sim".into(),
            started_at_us: 0,
            app_version: String::new(),
            scripts_sha256: String::new(),
            unit_config_sha256: String::new(),
            injected: None,
            owner: String::new(),
            scripts: Vec::new(),
        };
        let run = RunStore::begin(store, record, &Stop::default()).expect("begun");
        let id = run.id;
        let other = rusqlite::Connection::open(&file).expect("the database");
        other.execute_batch("BEGIN IMMEDIATE").expect("a lock");
        let ends = std::thread::spawn(move || {
            run.finish(RunEnd {
                verdict: Verdict::Passed,
                finished_at_us: 1,
                bench_time_us: 1,
                wall_time_us: 1,
            })
        });
        std::thread::sleep(Duration::from_millis(300));
        other.execute_batch("ROLLBACK").expect("released");
        let store = ends.join().expect("no panic").expect("recorded");
        let found = store.run(id, &|_| false).expect("there").run.verdict;
        assert_eq!(found, Some(Verdict::Passed));
    }
}
