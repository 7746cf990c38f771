//! Integrity check of a file or a server: damage, altered rows, broken seals, wrong counts.

mod chain;
mod counted;
mod derived;
mod seal_entry;
mod server;
mod signatures;
mod verify;

use std::sync::Arc;

use serde::Serialize;

use crate::backend::Backend;
use crate::error::{Advice, Damage, Derived, ProblemKind, Samples, StoreError};
use crate::history::recording::check_recordings;
use crate::seal::SealHead;
use crate::store::Store;
pub use signatures::KeyUse;
pub use verify::Verification;

const DOING: &str = "checking";

/// The result of a check.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CheckReport {
    /// Runs checked against their seals.
    pub runs: u32,
    /// Traces whose checksum and samples were read.
    pub traces: u32,
    /// Recordings that were decompressed and read.
    pub recordings: u32,
    /// Problems found; empty if the file or server is sound.
    pub problems: Vec<Problem>,
    /// Remarks that are no problems: rows sealed as found, recounts of other files, clocks that went backward.
    pub remarks: Vec<String>,
    /// The last entry of the file's chain of seals, for comparison with values known elsewhere.
    pub head: Option<SealHead>,
    /// Keys that signed entries of the file.
    pub signed: Vec<KeyUse>,
}

/// Remarks, as sentences.
type Remarks = Vec<String>;

/// One problem.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Problem {
    /// The part of the history with the problem.
    pub kind: ProblemKind,
    /// What is wrong, and where.
    pub detail: Damage,
    /// The next step of the person who reads of the problem.
    pub advice: Advice,
}

/// Greatest number of problems listed of each kind; SQLite's own check stops there, too.
const MAX_FINDINGS: u32 = 100;

/// Collects problems of one kind, up to the limit.
struct Findings<'a> {
    problems: &'a mut Vec<Problem>,
    kind: ProblemKind,
    advice: Advice,
    found: u32,
}

impl<'a> Findings<'a> {
    fn new(problems: &'a mut Vec<Problem>, kind: ProblemKind, advice: Advice) -> Self {
        Self {
            problems,
            kind,
            advice,
            found: 0,
        }
    }

    fn add(&mut self, detail: Damage) {
        self.found += 1;
        if self.found <= MAX_FINDINGS {
            self.say(detail);
        }
    }

    fn add_all(&mut self, details: impl IntoIterator<Item = Damage>) {
        details.into_iter().for_each(|detail| self.add(detail));
    }

    fn say(&mut self, detail: Damage) {
        self.problems.push(Problem {
            kind: self.kind,
            detail,
            advice: self.advice,
        });
    }
}

impl Drop for Findings<'_> {
    fn drop(&mut self) {
        let more = self.found.saturating_sub(MAX_FINDINGS);
        if more > 0 {
            self.say(Damage::More(more));
        }
    }
}

impl Store {
    /// Looks for damage and for manual changes: SQLite's integrity check, foreign objects, foreign keys,
    /// every trace and recording, every run, event and note against its seal, the seals against each other,
    /// the derived columns of faults and units, and all counts.
    ///
    /// On a server: every run against its seal, the seals against each other, and the triggers that make its
    /// tables append-only.
    pub fn check(&self) -> Result<CheckReport, StoreError> {
        if let Backend::Server(_) = &self.backend {
            return server::check(self);
        }
        let mut report = CheckReport::default();
        let integrity = format!("PRAGMA integrity_check({MAX_FINDINGS})");
        let problems = &mut report.problems;
        let mut found = Findings::new(problems, ProblemKind::Integrity, Advice::FromBackup);
        for detail in self.select(DOING, &integrity, &[], |row| row.get::<String>(0))? {
            if detail != "ok" {
                found.add(Damage::Told(detail));
            }
        }
        drop(found);
        let is_damaged = !report.problems.is_empty();
        match self.check_rows(&mut report) {
            Err(StoreError::Stopped) => return Err(StoreError::Stopped),
            // If the file is damaged, SQLite's findings say more than the place where reading failed.
            Err(error) if is_damaged => report.problems.push(Problem {
                kind: ProblemKind::Integrity,
                detail: Damage::Rest(Arc::new(error)),
                advice: Advice::FromBackup,
            }),
            done => done?,
        }
        Ok(report)
    }

    fn check_rows(&self, report: &mut CheckReport) -> Result<(), StoreError> {
        let problems = &mut report.problems;
        let mut found = Findings::new(problems, ProblemKind::Schema, Advice::ForeignObject);
        found.add_all(self.foreign_objects()?);
        drop(found);

        let mut found = Findings::new(problems, ProblemKind::ForeignKey, Advice::FromBackup);
        let orphans = "SELECT rowid, \"table\", parent FROM pragma_foreign_key_check";
        self.ask(DOING, |file| {
            file.each(orphans, &[], |row| {
                found.add(Damage::NoParent(row.get(0)?, row.get(1)?, row.get(2)?));
                Ok(())
            })
        })?;
        drop(found);

        let mut found = Findings::new(problems, ProblemKind::Trace, Advice::Lost);
        let traces = "SELECT id FROM trace ORDER BY seq";
        for id in self.select(DOING, traces, &[], |row| row.get(0))? {
            report.traces += 1;
            match self.trace(id) {
                Ok(_) => {}
                // Another program may prune meanwhile.
                Err(StoreError::NotFound { .. }) => report.traces -= 1,
                Err(StoreError::Stopped) => return Err(StoreError::Stopped),
                Err(error) => found.add(Damage::Unread(Arc::new(error))),
            }
        }
        drop(found);

        let mut found = Findings::new(problems, ProblemKind::Recording, Advice::Lost);
        let (recordings, wrong) = self.ask(DOING, check_recordings)?;
        report.recordings = recordings;
        found.add_all(wrong.into_iter().map(Damage::Told));
        drop(found);

        let found = Findings::new(problems, ProblemKind::Seal, Advice::Altered);
        (report.runs, report.signed) = self.ask("checking seals", |file| {
            chain::check(file, found, &mut report.remarks)
        })?;
        report.head = self.head()?;

        let found = Findings::new(problems, ProblemKind::Derived, Advice::Rebuild);
        let conn = self.file()?;
        self.ask(DOING, |_| counted::check(conn, found))?;
        self.ask(DOING, |file| {
            counted::in_snapshot(conn, || derived::check(file, problems))
        })
    }

    /// Recomputes everything that follows from other rows: repairs, packed faults, sums of measured values, search
    /// words of notes, and derived columns of faults. Runs, faults, events, traces and their seals stay as they are,
    /// even if wrong or missing. What differed is sealed with the time `at_us`, and returned.
    pub fn rebuild(&self, at_us: i64) -> Result<Vec<String>, StoreError> {
        counted::rebuild(self, at_us)
    }
}
