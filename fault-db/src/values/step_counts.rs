//! Counts the steps of a run, by one rule for everything that shows such counts.

use std::collections::BTreeMap;

use serde::Serialize;

use super::record::{StepKind, StepRecord, Verdict};

/// Numbers of different steps: each counts once, however often it was repeated or begun again. A failure outside the
/// steps of procedures is no step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct StepCounts {
    /// Steps that were due; of a stored run, those with a result, unless the run tells how many were due.
    pub planned: u32,
    /// Steps that passed each time they were run.
    pub passed: u32,
    /// Steps that failed at least once.
    pub failed: u32,
    /// Steps that never failed, but at least once could not be tested to their end.
    pub error: u32,
    /// Results of steps that were run; each repetition counts.
    pub attempts: u32,
    /// Number of failures outside steps.
    pub outside: u32,
}

impl StepCounts {
    /// The counts of these recorded results.
    pub fn of<'a>(records: impl IntoIterator<Item = &'a StepRecord>) -> Self {
        let mut counter = StepCounter::default();
        for record in records {
            match record.kind {
                StepKind::Outside => counter.note_outside(record.verdict),
                _ => counter.note((&record.procedure, record.place), record.verdict),
            }
        }
        counter.counts(0)
    }

    /// Steps that were run, with any result.
    pub fn run(&self) -> u32 {
        self.passed + self.not_passed()
    }

    /// Steps that were run and did not pass.
    pub fn not_passed(&self) -> u32 {
        self.failed + self.error
    }

    /// Steps that were due and not run.
    pub fn not_run(&self) -> u32 {
        self.planned.saturating_sub(self.run())
    }
}

/// Counts results one by one; `K` identifies a step.
#[derive(Clone, Debug)]
pub struct StepCounter<K> {
    /// Worst result of each step, as [`rank`] has it: 0 not run, 1 passed, 2 an error, 3 failed.
    steps: BTreeMap<K, u8>,
    attempts: u32,
    outside: u32,
}

impl<K> Default for StepCounter<K> {
    fn default() -> Self {
        Self {
            steps: BTreeMap::new(),
            attempts: 0,
            outside: 0,
        }
    }
}

impl<K: Ord> StepCounter<K> {
    /// Counts a result of a step.
    pub fn note(&mut self, step: K, verdict: Verdict) {
        let rank = rank(verdict);
        self.attempts += u32::from(rank > 0);
        let worst = self.steps.entry(step).or_default();
        *worst = rank.max(*worst);
    }

    /// Counts a result outside steps.
    pub fn note_outside(&mut self, verdict: Verdict) {
        self.outside += u32::from(rank(verdict) > 1);
    }

    /// The counts so far; `planned` is the number of steps that are due (more if more ran).
    pub fn counts(&self, planned: usize) -> StepCounts {
        let of = |rank| self.steps.values().filter(|worst| **worst == rank).count() as u32;
        StepCounts {
            planned: planned.max(self.steps.len()) as u32,
            passed: of(1),
            failed: of(3),
            error: of(2),
            attempts: self.attempts,
            outside: self.outside,
        }
    }
}

/// Rank of a result; of several results of a step the greatest rank counts.
pub fn rank(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::Skipped => 0,
        Verdict::Passed => 1,
        Verdict::Error | Verdict::Inconclusive | Verdict::Aborted => 2,
        Verdict::Failed => 3,
    }
}

/// SQL: [`StepCounts`] of the stored run `r.seq` by the same rule, so that a list of runs reads no steps; the text has
/// the numbers in the order of the fields.
pub(crate) const COUNTS_OF_RUN: &str = "
    SELECT count(*) || ' ' || count(CASE WHEN worst = 1 THEN 1 END) || ' ' || count(CASE WHEN worst = 3 THEN 1 END)
        || ' ' || count(CASE WHEN worst = 2 THEN 1 END) || ' ' || coalesce(sum(attempts), 0)
        || ' ' || (SELECT count(*) FROM step WHERE run = r.seq AND kind = 'outside'
            AND verdict NOT IN ('passed', 'skipped'))
    FROM (SELECT max(verdict_rank) AS worst, count(CASE WHEN verdict_rank > 0 THEN 1 END) AS attempts
        FROM (SELECT procedure, place,
                CASE verdict WHEN 'skipped' THEN 0 WHEN 'passed' THEN 1 WHEN 'failed' THEN 3 ELSE 2 END AS verdict_rank
            FROM step WHERE run = r.seq AND kind <> 'outside') AS turn
        GROUP BY procedure, place) AS step";

/// Counts from the text of [`COUNTS_OF_RUN`].
pub(crate) fn counts_of_text(text: &str) -> StepCounts {
    let mut numbers = text.split(' ').filter_map(|number| number.parse().ok());
    let mut next = || numbers.next().unwrap_or_default();
    StepCounts {
        planned: next(),
        passed: next(),
        failed: next(),
        error: next(),
        attempts: next(),
        outside: next(),
    }
}
