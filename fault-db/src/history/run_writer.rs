//! Records one run while it happens.
//!
//! The run's row is on the disk before [`RunWriter::begin`] returns, so that a killed program leaves an
//! interrupted run, not none. A fault is on the disk before [`RunWriter::fault`] returns. Steps are
//! buffered and written in batches, in short transactions: one commit costs milliseconds, and a long
//! transaction would lock out every other run on the file.

use std::borrow::Cow;
use std::collections::HashSet;

use crate::error::StoreError;
use crate::files::held_file::HeldFile;
use crate::history::insert::FaultStored;
use crate::history::insert::{FaultIds, FaultPlace, insert_fault, insert_run, insert_steps};
use crate::history::limits;
use crate::id::Id;
use crate::schema::packed::fill_empty_blocks;
use crate::seal::run::{RunDigest, end_fields, run_fields};
use crate::seal::{self, SealHead};
use crate::store::Store;
use crate::trace::TraceData;
use crate::values::record::LOG_SOURCE;
use crate::values::record::{FaultRecord, RunEnd, RunRecord, StepRecord};

/// Buffered steps that cause a flush.
const FLUSH_AT_STEPS: usize = 256;

/// Most steps that are buffered while writing fails.
const MAX_WAITING_STEPS: usize = 16_384;

/// Writes one run. Several writers may write to one store, and to one file.
///
/// A dropped writer writes the buffered steps if it can; without [`finish`](Self::finish) the run then counts as
/// interrupted.
pub struct RunWriter<'a> {
    pub(crate) store: &'a Store,
    id: Id,
    pub(crate) run: i64,
    unit: i64,
    line: String,
    /// The run is an imported log, not a test.
    of_log: bool,
    /// Row number of the last fault event in the file when the run began.
    known_events: i64,
    waiting: Vec<StepRecord>,
    /// Digest of the run, computed from the records as they come.
    pub(crate) seal: RunDigest,
    last_index: Option<u32>,
    /// This file takes the rest of a run because the run's own file was busy for too long; the run is complete and
    /// sealed where both files are merged.
    is_rest: bool,
    /// The verdict is written; it is not yet checked that another program finds the run in the file.
    ended: bool,
    /// Number of steps recorded.
    steps: usize,
    /// Occurrences that have a trace.
    traced: HashSet<Id>,
    finished: bool,
    /// The end of the file's chain of seals when the run began.
    began: Option<SealHead>,
    /// Tells other programs that the run is under way.
    lock: Option<HeldFile>,
}

impl<'a> RunWriter<'a> {
    /// The run's id.
    pub fn id(&self) -> Id {
        self.id
    }

    /// Begins a run and commits it.
    ///
    /// # Errors
    /// The file does not take it, was removed or replaced since it was opened, or has a second name.
    pub fn begin(store: &'a Store, record: &RunRecord) -> Result<Self, StoreError> {
        Self::begin_as(store.mint()?, store, record)
    }

    fn begin_as(id: Id, store: &'a Store, record: &RunRecord) -> Result<Self, StoreError> {
        const DOING: &str = "beginning a run";
        record.check()?;
        // Text only: cannot fail.
        let sw_versions = serde_json::to_string(&record.unit.sw_versions).unwrap_or_default();
        let fields = run_fields(id, record, &sw_versions);
        let seal = RunDigest::begin(&fields, &record.scripts);
        // Checked before anything is recorded, so that an error loses nothing.
        store.check_place()?;
        let began = store.head()?;
        let lock = store.hold_run(id)?;
        let (run, unit) = store.write(DOING, |_| {
            store.ask(DOING, |file| insert_run(file, record, &fields))
        })?;
        let waiting = Vec::with_capacity(FLUSH_AT_STEPS);
        Ok(Self {
            store,
            id,
            run,
            unit,
            line: record.line.clone(),
            of_log: record.source.starts_with(LOG_SOURCE),
            known_events: store.last_event()?,
            waiting,
            seal,
            last_index: None,
            is_rest: false,
            ended: false,
            steps: 0,
            traced: HashSet::new(),
            finished: false,
            began,
            lock: Some(lock),
        })
    }

    /// The file that the writer writes to.
    pub fn path(&self) -> &std::path::Path {
        self.store.path()
    }

    /// Continues the run in another file, which gets the buffered steps that this file does not take. Importing the
    /// other file completes the run here.
    ///
    /// # Errors
    /// The other file does not take the run; the steps stay buffered here.
    pub fn continue_in<'b>(
        &mut self,
        store: &'b Store,
        record: &RunRecord,
    ) -> Result<RunWriter<'b>, StoreError> {
        let mut rest = self.begin_again_in(store, record)?;
        rest.waiting = std::mem::take(&mut self.waiting);
        rest.last_index = self.last_index;
        rest.is_rest = true;
        self.finished = true;
        Ok(rest)
    }

    /// Begins this run again, under its id, in another file, where this file was lost.
    ///
    /// # Errors
    /// The other file does not take the run.
    pub fn begin_again_in<'b>(
        &self,
        store: &'b Store,
        record: &RunRecord,
    ) -> Result<RunWriter<'b>, StoreError> {
        RunWriter::begin_as(self.id, store, record)
    }

    /// Steps recorded but not yet in the file.
    pub fn waiting_steps(&self) -> usize {
        self.waiting.len()
    }

    /// Records a finished step. It reaches the file with the next flush, fault or finish.
    ///
    /// After a write error the step stays buffered and is written when writing works again.
    pub fn step(&mut self, mut step: StepRecord) -> Result<(), StoreError> {
        self.check_unfinished()?;
        step.check()?;
        // An infinite limit is no limit, and a value that is not finite was not measured.
        for measured in &mut step.measurements {
            for number in [&mut measured.value, &mut measured.low, &mut measured.high] {
                *number = number.filter(|number| number.is_finite());
            }
        }
        if let Some(last) = self.last_index.filter(|last| step.index <= *last) {
            return Err(StoreError::StepOrder {
                index: step.index,
                last,
            });
        }
        if self.waiting.len() >= MAX_WAITING_STEPS {
            let path = self.store.path().to_path_buf();
            return Err(StoreError::StepsWaiting {
                path,
                waiting: self.waiting.len(),
            });
        }
        self.last_index = Some(step.index);
        if let Cow::Owned(cut) = limits::cut(&step.message) {
            step.message = cut;
        }
        self.seal.step(&step);
        self.steps += 1;
        self.waiting.push(step);
        if self.waiting.len() >= FLUSH_AT_STEPS {
            self.flush()
        } else {
            Ok(())
        }
    }

    /// Commits the buffered steps.
    pub fn flush(&mut self) -> Result<(), StoreError> {
        const DOING: &str = "storing steps";
        if self.waiting.is_empty() {
            return Ok(());
        }
        let (store, run, waiting) = (self.store, self.run, &self.waiting);
        store.write(DOING, |_| {
            store.ask(DOING, |file| insert_steps(file, run, waiting))
        })?;
        self.waiting.clear();
        Ok(())
    }

    /// Commits an occurrence of a fault, with its freeze frame, and the buffered steps.
    ///
    /// The occurrence belongs to the unclosed fault of this unit, code and part; without one, it begins a fault. A
    /// repaired or verified fault is reopened.
    pub fn fault(&mut self, record: &FaultRecord) -> Result<FaultStored, StoreError> {
        let occurrence = self.store.mint()?;
        self.fault_as(occurrence, record)
    }

    /// Commits a fault from an entry of a unit's own log, under an id computed from the entry: every store that imports
    /// the entry has that id, so a merge of two histories keeps one occurrence. This store must not have the entry yet.
    pub fn logged_fault(
        &mut self,
        occurrence: Id,
        record: &FaultRecord,
    ) -> Result<FaultStored, StoreError> {
        let stored = self.fault_as(occurrence, record)?;
        self.seal.share_occurrence(occurrence);
        Ok(stored)
    }

    fn fault_as(
        &mut self,
        occurrence: Id,
        record: &FaultRecord,
    ) -> Result<FaultStored, StoreError> {
        const DOING: &str = "storing a fault";
        self.check_unfinished()?;
        let (store, run, waiting) = (self.store, self.run, &self.waiting);
        let place = FaultPlace {
            run,
            unit: self.unit,
            line: &self.line,
            of_log: self.of_log,
            known_events: self.known_events,
        };
        let ids = FaultIds {
            fault: store.mint()?,
            occurrence,
            event: store.mint()?,
        };
        let (stored, digest) = store.write(DOING, |_| {
            store.ask(DOING, |file| {
                insert_steps(file, run, waiting)?;
                insert_fault(file, &place, ids, record)
            })
        })?;
        self.seal.occurrence(stored.occurrence, digest);
        self.waiting.clear();
        Ok(stored)
    }

    /// Commits a trace and links it to `occurrences` of this run, perhaps none. An occurrence that has a trace keeps
    /// its first, with which it is sealed.
    ///
    /// # Errors
    /// The run has ended, or the trace cannot be written.
    pub fn trace(&mut self, occurrences: &[Id], trace: &TraceData) -> Result<Id, StoreError> {
        self.check_unfinished()?;
        let id = self.store.mint()?;
        let is_new = |occurrence: &Id| !self.traced.contains(occurrence);
        let new: Vec<_> = occurrences.iter().copied().filter(is_new).collect();
        self.trace_as(id, &new, trace)?;
        self.traced.extend(new);
        Ok(id)
    }

    /// Commits a trace of a unit's own record, under an id computed from the trace; the store must not have it yet.
    pub fn recorded_trace(&mut self, id: Id, trace: &TraceData) -> Result<(), StoreError> {
        self.check_unfinished()?;
        self.trace_as(id, &[], trace)
    }

    fn trace_as(
        &mut self,
        id: Id,
        occurrences: &[Id],
        trace: &TraceData,
    ) -> Result<(), StoreError> {
        let digest = self.store.insert_trace(id, self.run, occurrences, trace)?;
        self.seal.trace(id, digest);
        Ok(())
    }

    /// Commits the buffered steps and the verdict; a passing run is noted at the repairs that it tested. After an
    /// error, `finish` can be called again.
    ///
    /// # Errors
    /// The end of the run cannot be written, or another program would not find the run under the store's name: the file
    /// was removed, replaced or overwritten meanwhile, or has a second name. Within a transaction, that is not checked.
    pub fn finish(&mut self, end: &RunEnd) -> Result<(), StoreError> {
        if self.finished {
            return Err(StoreError::RunFinished(self.id));
        }
        if !self.ended {
            self.end(end)?;
            self.waiting.clear();
            self.ended = true;
        }
        if self.store.file()?.is_autocommit() {
            let began = self.began.as_ref();
            self.store
                .check_holds(self.id, began, (!self.is_rest).then_some(self.steps))?;
        }
        self.finished = true;
        self.lock = None;
        Ok(())
    }

    fn end(&mut self, end: &RunEnd) -> Result<(), StoreError> {
        const DOING: &str = "finishing a run";
        const SQL: &str = "UPDATE run SET verdict = ?1, finished_at_us = ?2, bench_time_us = ?3,
            wall_time_us = ?4 WHERE seq = ?5";
        let (store, run, waiting) = (self.store, self.run, &self.waiting);
        let (unit, id, known_events) = (self.unit, self.id, self.known_events);
        let (payload, digest) = self.seal.end(end);
        let is_rest = self.is_rest;
        store.write(DOING, |_| {
            store.ask(DOING, |file| {
                insert_steps(file, run, waiting)?;
                let mut values = end_fields(end).to_vec();
                values.push(run.into());
                file.execute(SQL, &values)?;
                match is_rest {
                    true => Ok(()),
                    false => seal::append(file, "run", id, &payload, &digest),
                }
            })?;
            store.note_passed((unit, run, id), known_events, end)?;
            store.ask(DOING, fill_empty_blocks)
        })
    }

    pub(crate) fn check_unfinished(&self) -> Result<(), StoreError> {
        if self.ended || self.finished {
            Err(StoreError::RunFinished(self.id))
        } else {
            Ok(())
        }
    }
}

impl Drop for RunWriter<'_> {
    fn drop(&mut self) {
        // The caller returns its own error, which says more than this one.
        let _ = self.flush();
    }
}
