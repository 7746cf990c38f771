//! Merges the history of one file into another, in one transaction.

mod files;
mod seals;
mod trust;

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::Connection;
use serde::Serialize;

use super::change_set::{ChangeSet, ENOUGH_BYTES, MOST_ENTRIES};
use super::sync::Difference;
use super::tables::TableId;
use super::to_file::FileApplier;
use crate::backend::Refusal;
use crate::backend::{Backend, SqlResult, from_row, values};
use crate::exchange::domain::{Refusals, shown_id};
use crate::history::event_graph::{fault_of, settle};
use crate::history::recurrence::HighWaterMark;
use crate::id::Id;
use crate::seal::{BY_IMPORT, known_heads};
use trust::{Entry, is_same, is_unwritten_remainder, runs_of_nothing, seal_mismatch};

/// The result of a merge.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct MergeCounts {
    /// Units not known before.
    pub units: usize,
    /// Runs not known before.
    pub runs: usize,
    /// Steps not known before.
    pub steps: usize,
    /// Measurements not known before.
    pub measurements: usize,
    /// Faults not known before.
    pub faults: usize,
    /// Occurrences not known before.
    pub occurrences: usize,
    /// Events not known before.
    pub events: usize,
    /// Traces not known before.
    pub traces: usize,
    /// Recordings not known before.
    pub recordings: usize,
    /// Notes on runs not known before.
    pub notes: usize,
    /// Runs that are finished on both sides with different content; ours were kept.
    pub different: Vec<Difference>,
    /// Set if the other file is a copy of a file whose chain of seals is known here.
    pub copy: Option<CopyOf>,
    /// Rows of the other file outside their columns' domain, and runs that do not match their seals: they
    /// were left out, with all rows that depend on them.
    pub refused: Refusals,
}

/// How the other file, which is a copy, relates to the file whose chain of seals is known here.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CopyOf {
    /// The file id that both have.
    pub file: Id,
    /// The last entry of the chain of seals that both have.
    pub after: i64,
    /// Whether the copy has entries of its own after that; else it is an older state.
    pub went_on: bool,
}

struct Merge<'a> {
    theirs: &'a Backend,
    ours: &'a Backend,
    /// The SQLite connection of `ours`.
    conn: &'a Connection,
    applier: FileApplier<'a>,
    counts: MergeCounts,
    /// Runs of theirs with rows that refer to nothing.
    of_nothing: BTreeSet<i64>,
    /// Runs of theirs that are refused, with all that belongs to them.
    refused_runs: BTreeSet<i64>,
    /// What became here of each fault of the other file.
    faults_here: BTreeMap<i64, LocalFault>,
    /// Ids of the other file's runs, events, notes and traces that are left out.
    left_out: BTreeSet<Vec<u8>>,
    /// Runs that are finished here and differ there.
    different_runs: BTreeSet<Id>,
}

impl<'a> Merge<'a> {
    fn begin(theirs: &'a Backend, ours: &'a Backend, conn: &'a Connection) -> SqlResult<Self> {
        Ok(Self {
            theirs,
            ours,
            conn,
            applier: FileApplier::begin(ours, conn)?,
            counts: MergeCounts::default(),
            of_nothing: BTreeSet::new(),
            refused_runs: BTreeSet::new(),
            faults_here: BTreeMap::new(),
            left_out: BTreeSet::new(),
            different_runs: BTreeSet::new(),
        })
    }

    fn all(mut self, copy: Option<CopyOf>) -> SqlResult<MergeCounts> {
        let mark = HighWaterMark::of(self.ours)?;
        self.of_nothing = runs_of_nothing(self.theirs, &mut self.counts.refused)?;
        self.each(TableId::Run, "unit", Self::run)?;
        self.aliases()?;
        self.each(TableId::Event, "fault", Self::event)?;
        self.each(TableId::Note, "run", Self::note)?;
        self.each(TableId::Trace, "run", Self::trace)?;
        settle(self.ours, &self.applier.touched, Some(mark))?;
        self.seals()?;
        self.applier.seal_the_rest(BY_IMPORT)?;
        for head in known_heads::of_file(self.theirs)? {
            known_heads::keep(self.ours, &head)?;
        }
        let new = |of: TableId| self.applier.counts[of as usize] as usize;
        Ok(MergeCounts {
            units: new(TableId::Unit),
            runs: new(TableId::Run),
            steps: new(TableId::Step),
            measurements: new(TableId::Measurement),
            faults: self.applier.faults_added()?,
            occurrences: new(TableId::Occurrence),
            events: new(TableId::Event),
            traces: new(TableId::Trace),
            recordings: new(TableId::Recording),
            notes: new(TableId::Note),
            copy,
            ..self.counts
        })
    }

    /// Reads all entries of a table of theirs into change sets, and applies these. `read` returns whether the
    /// entry is taken or known.
    fn each(
        &mut self,
        of: TableId,
        parent: &str,
        read: fn(&mut Self, &mut ChangeSet, &Entry) -> SqlResult<bool>,
    ) -> SqlResult<()> {
        let sql = format!(
            "SELECT seq, {parent}, id FROM {} WHERE seq > ?1 ORDER BY seq LIMIT {MOST_ENTRIES}",
            of.table().name
        );
        let mut after = i64::MIN;
        loop {
            let entries = self.theirs.select(&sql, &values![after], |row| {
                Ok(from_row!(row => Entry: seq, parent, id))
            })?;
            if entries.is_empty() {
                return Ok(());
            }
            let mut set = ChangeSet::new(false);
            for entry in entries {
                after = entry.seq;
                let is_taken = read(self, &mut set, &entry)?;
                for refusal in std::mem::take(&mut set.refused) {
                    self.refuse(&entry, refusal);
                }
                if !is_taken {
                    self.left_out.insert(entry.id);
                }
                if set.bytes() >= ENOUGH_BYTES {
                    break;
                }
            }
            self.applier.apply(&set)?;
        }
    }

    /// Reads an entry with all that belongs to it; whether it was added to the change set.
    fn take(
        &mut self,
        set: &mut ChangeSet,
        of: TableId,
        entry: &Entry,
        read: impl FnOnce(&mut ChangeSet) -> SqlResult<()>,
    ) -> SqlResult<bool> {
        let before = set.rows(of).count();
        if let Some(refusal) = set.whole(read)? {
            self.refuse(entry, refusal);
        }
        Ok(set.rows(of).count() > before)
    }

    fn refuse(&mut self, entry: &Entry, refusal: Refusal) {
        let (what, reason) = match refusal.table {
            "run_script" | "step" | "measurement" | "fault_occurrence" => (
                format!("run {}", shown_id(&entry.id)),
                format!("{}: {}", refusal.row(), refusal.reason),
            ),
            _ => (refusal.row(), refusal.reason),
        };
        self.counts.refused.add(what, reason);
    }

    /// A run that is finished here stays as it is, because it is sealed; only recordings are added, which its
    /// seal covers by digest.
    fn run(&mut self, set: &mut ChangeSet, entry: &Entry) -> SqlResult<bool> {
        let known = "SELECT seq, verdict IS NOT NULL FROM run WHERE id = ?1";
        let known = self.ours.first(known, &values![&entry.id[..]], |row| {
            Ok((row.get::<i64>(0)?, row.get::<bool>(1)?))
        })?;
        let theirs = self.theirs;
        if let (Some((ours, true)), Ok(id)) = (known, entry.id[..].try_into()) {
            if !is_same(self.ours, ours, theirs, entry)? {
                let id = Id::from_bytes(id);
                self.different_runs.insert(id);
                (self.counts.different).push(Difference { what: "run", id });
            }
            self.recordings(set, entry)?;
            return Ok(true);
        }
        let refers_to_nothing = self.of_nothing.contains(&entry.seq);
        let is_taken = self.take(set, TableId::Run, entry, |set| {
            set.run(theirs, entry.seq)?;
            let reason = if refers_to_nothing {
                Some("a step or fault it speaks of is not there".to_owned())
            } else if known.is_some() && is_unwritten_remainder(theirs, entry)? {
                None
            } else {
                seal_mismatch(theirs, entry)?
            };
            match reason {
                Some(reason) => Err(Refusal::of("run", shown_id(&entry.id), reason)),
                None => Ok(()),
            }
        })?;
        if is_taken {
            self.recordings(set, entry)?;
        } else {
            self.refused_runs.insert(entry.seq);
        }
        Ok(is_taken)
    }

    /// Reads the recordings of a run, if they fit its seal.
    fn recordings(&mut self, set: &mut ChangeSet, entry: &Entry) -> SqlResult<()> {
        let theirs = self.theirs;
        let refused = set.whole(|set| {
            set.read(theirs, TableId::Recording, entry.seq)?;
            fits(theirs, set, TableId::Recording, entry)
        })?;
        if let Some(refusal) = refused {
            let what = format!("recordings of run {}", shown_id(&entry.id));
            self.counts.refused.add(what, refusal.reason);
        }
        Ok(())
    }

    /// Reads an event, note or trace. An entry that is here already stays as it is; `seals` compares the other file's
    /// seal of an event or note with it. An entry that is new here must fit its seal in the other file.
    fn take_sealed(
        &mut self,
        set: &mut ChangeSet,
        of: TableId,
        entry: &Entry,
        read: impl FnOnce(&mut ChangeSet, &Backend) -> SqlResult<()>,
    ) -> SqlResult<bool> {
        let theirs = self.theirs;
        let known = format!("SELECT 1 FROM {} WHERE id = ?1", of.table().name);
        let is_known = self.ours.has(&known, &values![&entry.id[..]])?;
        self.take(set, of, entry, |set| {
            read(set, theirs)?;
            match is_known {
                true => Ok(()),
                false => fits(theirs, set, of, entry),
            }
        })
    }

    /// Applies the other ids that the other file has for faults that are here.
    fn aliases(&mut self) -> SqlResult<()> {
        let faults = "SELECT DISTINCT fault FROM fault_alias ORDER BY fault";
        for fault in self.theirs.select(faults, &[], |row| row.get(0))? {
            if self.fault_here(fault)? != LocalFault::Known {
                continue;
            }
            let (theirs, mut set) = (self.theirs, ChangeSet::new(false));
            let refused = set.whole(|set| set.fault(theirs, fault))?;
            if refused.is_some() {
                self.faults_here.insert(fault, LocalFault::LeftOut);
            }
            self.applier.apply(&set)?;
            for refusal in set.refused.into_iter().chain(refused) {
                (self.counts.refused).add(refusal.row(), refusal.reason);
            }
        }
        Ok(())
    }

    fn event(&mut self, set: &mut ChangeSet, entry: &Entry) -> SqlResult<bool> {
        let here = self.fault_here(entry.parent)?;
        Ok(here != LocalFault::LeftOut
            && self.take_sealed(set, TableId::Event, entry, |set, theirs| match here {
                LocalFault::Known => set.read(theirs, TableId::Event, entry.seq),
                _ => set.event(theirs, entry.seq),
            })?)
    }

    /// Whether a fault of theirs is here: it was, or it came with a run.
    fn fault_here(&mut self, fault: i64) -> SqlResult<LocalFault> {
        if let Some(known) = self.faults_here.get(&fault) {
            return Ok(*known);
        }
        let ids = "SELECT id FROM fault WHERE seq = ?1 UNION ALL SELECT id FROM fault_alias WHERE fault = ?1";
        let ids = (self.theirs).select(ids, &values![fault], |row| row.get::<Vec<u8>>(0))?;
        let mut found = LocalFault::SeenByNobody;
        let seen = "SELECT 1 FROM fault_occurrence WHERE fault = ?1";
        if self.theirs.has(seen, &values![fault])? {
            found = LocalFault::LeftOut;
        }
        for id in ids {
            if let Ok(id) = id[..].try_into().map(Id::from_bytes)
                && fault_of(self.ours, id)?.is_some()
            {
                found = LocalFault::Known;
            }
        }
        self.faults_here.insert(fault, found);
        Ok(found)
    }

    fn note(&mut self, set: &mut ChangeSet, entry: &Entry) -> SqlResult<bool> {
        Ok(!self.refused_runs.contains(&entry.parent)
            && self.take_sealed(set, TableId::Note, entry, |set, theirs| {
                set.read(theirs, TableId::Note, entry.seq)
            })?)
    }

    fn trace(&mut self, set: &mut ChangeSet, entry: &Entry) -> SqlResult<bool> {
        Ok(!self.refused_runs.contains(&entry.parent)
            && self.take_sealed(set, TableId::Trace, entry, |set, theirs| {
                set.trace(theirs, entry.seq)
            })?)
    }
}

/// Refuses an entry that does not fit its seal, unless a row of it is refused already.
fn fits(theirs: &Backend, set: &ChangeSet, of: TableId, entry: &Entry) -> SqlResult<()> {
    if !set.refused.is_empty() {
        return Ok(());
    }
    match trust::mismatch(theirs, of, entry)? {
        Some(reason) => Err(Refusal::of(of.table().name, shown_id(&entry.id), reason)),
        None => Ok(()),
    }
}

/// State here of a fault of the other file.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LocalFault {
    Known,
    /// No occurrence shows the fault; it is taken with its events.
    SeenByNobody,
    /// Not here, although runs of the other file saw the fault: each was refused, or is finished here without the
    /// fault. Or the row of the fault was refused.
    LeftOut,
}
