//! The writer: one thread owns the database and takes what is to be recorded, in order, and what is to be
//! said of it, which is said when it is in the file.

use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use fault_db::{
    FaultRecord, Id, RecordingRecord, RunEnd, RunRecord, RunWriter, StepRecord, Store, StoreError,
    TraceData,
};

use crate::clock;
use crate::failure::Failure;
use crate::stop::Stop;

/// Entries that may wait for the disk; a bench that produces more waits for the writer.
const QUEUE: usize = 4096;
/// Steps reach the file at least this often.
const FLUSH: Duration = Duration::from_millis(250);

/// How long a run under way waits for another writer. It would lose all that is still to come, and its thread
/// keeps nobody waiting but the bench.
#[derive(Clone, Copy)]
struct Patience {
    /// After so long the bench is stopped: nobody drives a unit for a run that may not be kept.
    stops_ms: u32,
    /// After so long what was measured is kept in another file.
    gives_up: Duration,
}

const PATIENCE: Patience = Patience {
    stops_ms: 30_000,
    gives_up: Duration::from_secs(180),
};

/// Something to record.
enum Entry {
    Step(StepRecord),
    /// A fault, numbered from 0 through the run.
    Fault(FaultRecord),
    /// A trace and the numbers of the faults it shows.
    Trace(Vec<usize>, TraceData),
    /// What the traces since the last recording came from.
    Recording(RecordingRecord),
    /// Something to say once all before it is in the file.
    Say(String),
    Finish(RunEnd),
}

/// Says a line, without ever waiting for anybody.
pub type Speaker = Box<dyn FnMut(String) + Send>;

/// Lines that wait until what they tell of is in the file.
#[derive(Default)]
struct Lines {
    speaker: Option<Speaker>,
    waiting: Vec<String>,
}

impl Lines {
    /// All that was recorded so far is in the file.
    fn stored(&mut self) {
        for line in self.waiting.drain(..) {
            if let Some(speaker) = &mut self.speaker {
                speaker(line);
            }
        }
    }
}

/// The sending end.
pub struct RunStore {
    entries: SyncSender<Entry>,
    thread: JoinHandle<(Store, Result<(), Failure>)>,
    /// The run's id.
    pub id: Id,
}

impl RunStore {
    /// Begins the run: its row is on the disk when this returns. What is to be said goes to `speaker`. Should
    /// writing fail later, `stop` is pressed at once: nobody drives a unit for a run that is not kept.
    ///
    /// # Errors
    /// The database does not take it.
    pub fn begin(
        store: Store,
        record: RunRecord,
        speaker: Option<Speaker>,
        stop: &Stop,
    ) -> Result<Self, Failure> {
        Self::begin_with(PATIENCE, store, record, speaker, stop)
    }

    fn begin_with(
        patience: Patience,
        store: Store,
        record: RunRecord,
        speaker: Option<Speaker>,
        stop: &Stop,
    ) -> Result<Self, Failure> {
        let (entries, receiver) = mpsc::sync_channel(QUEUE);
        let (begun, beginning) = mpsc::sync_channel(1);
        let stop = stop.clone();
        let thread = std::thread::Builder::new()
            .name("store".into())
            .spawn(move || {
                let mut kept = Kept::default();
                kept.lines.speaker = speaker;
                let result = write(&store, &record, &receiver, kept, &begun, (patience, &stop));
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
                Ok((_, Err(error))) => error,
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

    /// Has something said as soon as all that was recorded before is in the file.
    pub fn say(&self, line: String) {
        self.send(Entry::Say(line));
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
            Ok((_, Err(error))) => Err(error),
            Err(_) => Err(Failure::bench("the writer ended unexpectedly")),
        }
    }
}

fn write(
    store: &Store,
    record: &RunRecord,
    entries: &Receiver<Entry>,
    mut kept: Kept,
    begun: &SyncSender<Id>,
    (patience, stop): (Patience, &Stop),
) -> Result<(), Failure> {
    // Nothing is lost yet: a file that is locked is said as soon as any.
    let mut writer = RunWriter::begin(store, record)?;
    store.set_busy_timeout_ms(patience.stops_ms)?;
    let _ = begun.send(writer.id());
    let result = write_entries(&mut writer, &mut kept, entries, (patience, stop));
    let Err((error, at_hand)) = result else {
        return Ok(());
    };
    stop.press_because(error.to_string());
    let rest = match &error {
        StoreError::Locked { .. } => {
            kept.before = kept.occurrences.len();
            keep_rest(&mut writer, kept, record, at_hand, entries)
        }
        _ => None,
    };
    // What still comes is taken off the queue so that nobody waits.
    entries.iter().for_each(drop);
    Err(match rest {
        Some(rest) => Failure::bench(format!(
            "{error}; what was measured since is kept in {rest}: bring it in with `ptu db import {rest}` when the \
             database is free",
            rest = rest.display()
        )),
        None => error.into(),
    })
}

/// What was recorded that later entries name.
#[derive(Default)]
struct Kept {
    occurrences: Vec<Id>,
    /// So many of them are in another file.
    before: usize,
    traces: Vec<Id>,
    /// What is to be said of it.
    lines: Lines,
}

/// Records all that comes. An entry that was not taken comes back with the error.
fn write_entries(
    writer: &mut RunWriter<'_>,
    kept: &mut Kept,
    entries: &Receiver<Entry>,
    (patience, stop): (Patience, &Stop),
) -> Result<(), (StoreError, Option<Box<Entry>>)> {
    let mut flushed = Instant::now();
    loop {
        let entry = match entries.recv_timeout(FLUSH.saturating_sub(flushed.elapsed())) {
            Ok(entry) => Some(entry),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                let done = patiently(patience, stop, |_| writer.flush());
                done.map_err(|error| (error, None))?;
                kept.lines.stored();
                return Ok(());
            }
        };
        if let Some(entry) = entry {
            let is_end = matches!(entry, Entry::Finish(_));
            let done = patiently(patience, stop, |again| keep(writer, kept, &entry, again));
            match done {
                Ok(()) if is_end => {
                    kept.lines.stored();
                    return Ok(());
                }
                Ok(()) => {}
                Err(error) => return Err((error, Some(Box::new(entry)))),
            }
        }
        if flushed.elapsed() >= FLUSH {
            let done = patiently(patience, stop, |_| writer.flush());
            done.map_err(|error| (error, None))?;
            flushed = Instant::now();
        }
        if writer.waiting_steps() == 0 {
            kept.lines.stored();
        }
    }
}

/// Does it until the file is free. A unit is not driven meanwhile for longer than a moment.
fn patiently(
    patience: Patience,
    stop: &Stop,
    mut work: impl FnMut(bool) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let begun = Instant::now();
    let mut again = false;
    loop {
        match work(again) {
            Err(error @ StoreError::Locked { .. }) if begun.elapsed() < patience.gives_up => {
                stop.press_because(error.to_string());
                again = true;
            }
            done => return done,
        }
    }
}

/// Records one entry, perhaps for another time: a step that was not written waits with the writer.
fn keep(
    writer: &mut RunWriter<'_>,
    kept: &mut Kept,
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

/// Records the rest of a run in a file of its own, beside the one that stays busy; none if that fails, too.
fn keep_rest(
    writer: &mut RunWriter<'_>,
    mut kept: Kept,
    record: &RunRecord,
    at_hand: Option<Box<Entry>>,
    entries: &Receiver<Entry>,
) -> Option<PathBuf> {
    let mut name = writer.path().as_os_str().to_owned();
    name.push(format!(".run-{}.db", writer.id().short()));
    let path = PathBuf::from(name);
    let store = Store::open(&path, clock::open_options()).ok()?;
    let mut rest = writer.go_on_in(&store, record).ok()?;
    for entry in at_hand
        .map(|entry| *entry)
        .into_iter()
        .chain(entries.iter())
    {
        // A step that was not written waits with the writer, which brought it here.
        keep(&mut rest, &mut kept, &entry, false)
            .or_else(|error| match error {
                StoreError::StepOrder { .. } => Ok(()),
                other => Err(other),
            })
            .ok()?;
        if matches!(entry, Entry::Finish(_)) {
            break;
        }
    }
    rest.flush().ok()?;
    kept.lines.stored();
    drop(rest);
    store.close().ok()?;
    Some(path)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use fault_db::{Channel, ChannelKind, OpenOptions, UnitRecord, Verdict};
    use rusqlite::Connection;

    use super::*;

    fn record() -> RunRecord {
        RunRecord {
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
        }
    }

    fn step(index: u32) -> StepRecord {
        StepRecord {
            index,
            procedure: "atp/overspeed".into(),
            name: format!("step {index}"),
            verdict: Verdict::Passed,
            started_bench_us: 0,
            bench_time_us: 1,
            message: String::new(),
            script_line: None,
            measurements: Vec::new(),
        }
    }

    fn fault() -> FaultRecord {
        FaultRecord {
            code: 231,
            code_name: "eb_relay_open".into(),
            lru: "eb_relay".into(),
            severity: "major".into(),
            at_us: 1,
            bench_us: 1,
            step_index: Some(1),
            message: "late".into(),
            freeze: Vec::new(),
        }
    }

    fn trace() -> TraceData {
        TraceData {
            t0_bench_us: 0,
            t0_us: 0,
            period_us: 50_000,
            trigger_row: Some(1),
            partial: false,
            gaps: false,
            channels: vec![Channel {
                name: "speed".into(),
                unit: "km/h".into(),
                kind: ChannelKind::Number { lsb: 0.1 },
            }],
            columns: vec![vec![0.0, 0.1]],
        }
    }

    fn end(verdict: Verdict) -> RunEnd {
        RunEnd {
            verdict,
            finished_at_us: 1,
            bench_time_us: 1,
            wall_time_us: 1,
        }
    }

    /// A run that begins, with so much patience, and another program that holds its file from then on.
    fn held(folder: &std::path::Path, patience: Patience) -> (RunStore, Stop, Connection) {
        let file = folder.join("history.db");
        let options = OpenOptions::new(clock::ids()).busy_timeout_ms(1);
        let store = Store::open(&file, options).expect("a database");
        let stop = Stop::default();
        let run = RunStore::begin_with(patience, store, record(), None, &stop).expect("begun");
        let other = Connection::open(&file).expect("the database");
        let wait = other.busy_timeout(Duration::from_secs(60));
        wait.expect("it waits for the writer");
        other.execute_batch("BEGIN EXCLUSIVE").expect("a lock");
        (run, stop, other)
    }

    /// Goal: another program that holds the file for longer than it may when it is opened costs a run nothing.
    #[test]
    fn a_run_under_way_waits_for_another_writer() {
        let folder = tempfile::tempdir().expect("a folder");
        let (run, stop, other) = held(folder.path(), PATIENCE);
        let id = run.id;
        let ends = std::thread::spawn(move || run.finish(end(Verdict::Passed)));
        std::thread::sleep(Duration::from_millis(300));
        other.execute_batch("ROLLBACK").expect("released");
        let store = ends.join().expect("no panic").expect("recorded");
        let found = store.run(id, &|_| false).expect("there").run.verdict;
        assert_eq!((found, stop.presses()), (Some(Verdict::Passed), 0));
    }

    /// Goal: a file that is held for long ends the run, says why, and takes all of it when it is free.
    #[test]
    fn a_database_busy_for_long_ends_a_run_and_takes_all_of_it_in_the_end() {
        let folder = tempfile::tempdir().expect("a folder");
        let patience = Patience {
            stops_ms: 20,
            gives_up: Duration::from_secs(600),
        };
        let (run, stop, other) = held(folder.path(), patience);
        let id = run.id;
        run.step(step(0));
        run.fault(fault());
        while stop.presses() == 0 {
            std::thread::sleep(Duration::from_millis(5));
        }
        let reason = stop.reason().expect("a reason");
        assert!(
            reason.starts_with("database busy: ") && reason.contains("history.db is locked"),
            "{reason}"
        );
        run.trace(vec![0], trace());
        run.step(step(1));
        other.execute_batch("ROLLBACK").expect("released");
        let store = run.finish(end(Verdict::Error)).expect("recorded");
        let found = store.run(id, &|_| false).expect("there");
        assert_eq!((found.steps.len(), found.faults.len()), (2, 1));
        assert_eq!(found.run.verdict, Some(Verdict::Error));
        assert!(found.faults[0].trace_id.is_some());
        assert_eq!(store.check().expect("checked").problems, []);
    }

    /// Goal: what a file that stays busy did not take is kept beside it, and an import brings the run together.
    #[test]
    fn what_a_busy_database_does_not_take_comes_with_an_import() {
        let folder = tempfile::tempdir().expect("a folder");
        let patience = Patience {
            stops_ms: 10,
            gives_up: Duration::from_millis(40),
        };
        let (run, stop, other) = held(folder.path(), patience);
        let id = run.id;
        run.step(step(0));
        run.fault(fault());
        run.trace(vec![0], trace());
        run.step(step(1));
        let failure = run.finish(end(Verdict::Error)).expect_err("busy");
        assert_eq!(stop.presses(), 1);
        let rest = folder
            .path()
            .join(format!("history.db.run-{}.db", id.short()));
        for said in [
            "database busy",
            "ptu db import",
            &rest.display().to_string(),
        ] {
            assert!(failure.message.contains(said), "{}", failure.message);
        }
        other.execute_batch("ROLLBACK").expect("released");
        drop(other);
        let file = folder.path().join("history.db");
        let store = Store::open(&file, clock::open_options()).expect("free");
        store.import(&rest).expect("the rest");
        let found = store.run(id, &|_| false).expect("there");
        assert_eq!((found.steps.len(), found.faults.len()), (2, 1));
        assert_eq!(found.run.verdict, Some(Verdict::Error));
        assert!(found.faults[0].trace_id.is_some());
        assert_eq!(store.check().expect("checked").problems, []);
    }
}
