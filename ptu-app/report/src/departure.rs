//! Whether a run holds as a departure test, until when, or why not.

use std::fmt::Display;

use fault_db::{RunDetail, RunFilter, Store, Verdict, is_practice};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::words::{Language, Words, fill};
use ptu_runs::clock::{local_zoned, now_us, rfc3339};
use ptu_runs::coverage::counts_of;
use ptu_runs::failure::Failure;
use ptu_runs::run::Evidence;
use ptu_runs::stored::{DEPARTURE, standing};

/// How long a unit that passed is good for service, µs: 24 hours, as the operating rules of a railway have it (CSS 551).
const VALID_US: i64 = 86_400_000_000;

/// Most steps that were not run for which each is named; more of them are counted.
const MOST_NAMED: usize = 3;

/// A run as a departure test: until when it is valid, or why it is not.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Departure {
    /// Serial number of the unit.
    pub unit: String,
    /// End of the time for which the test is valid, µs.
    pub until_us: i64,
    /// Reasons for which the test is not valid, in English and Korean.
    pub why_not: Vec<[String; 2]>,
}

impl Departure {
    /// The run as a departure test; `None` if no departure test was due in the run. The test is valid if the run made
    /// departure tests alone, all of them, on a real unit without injected faults, and if it passed and is signed.
    pub fn of(run: &RunDetail) -> Option<Self> {
        let is_departure = |path: &str| path.starts_with(DEPARTURE);
        if !run.scripts.iter().any(|script| is_departure(&script.path)) {
            return None;
        }
        let run_of = &run.run;
        let finished_us = run_of.finished_at_us.unwrap_or(run_of.started_at_us);
        let mut departure = Self {
            unit: run_of.unit_serial.clone(),
            until_us: finished_us.saturating_add(VALID_US),
            why_not: Vec::new(),
        };
        if !run.scripts.iter().all(|script| is_departure(&script.path)) {
            departure.add(|words| words.verify.with_others.into());
        }
        let counts = counts_of(run_of);
        let skipped = standing(&run.steps).filter(|step| step.verdict == Verdict::Skipped);
        // The number of many steps that were not run tells more than their names.
        let named = counts.not_run() as usize == skipped.take(MOST_NAMED).count();
        for step in standing(&run.steps) {
            let said: fn(&Words) -> &'static str = match step.verdict {
                Verdict::Passed => continue,
                Verdict::Skipped if !named => continue,
                Verdict::Failed => |words| words.verify.step_failed,
                Verdict::Skipped => |words| words.verify.step_skipped,
                _ => |words| words.verify.step_not_tested,
            };
            departure.add(|words| fill(said(words), &[("step", &words.record(step))]));
        }
        if counts.not_run() > 0 && !named {
            let of: [(&str, &dyn Display); 2] = [("n", &counts.not_run()), ("of", &counts.planned)];
            departure.add(|words| fill(words.verify.steps_not_run, &of));
        }
        let evidence = run_of.evidence.as_deref().and_then(Evidence::of);
        if run_of.continues.is_some() || evidence.is_none_or(|evidence| evidence.is_part) {
            departure.add(|words| words.verify.is_part.into());
        }
        if let Some(faults) = run_of.injected.as_ref().filter(|faults| !faults.is_empty()) {
            departure.add(|words| fill(words.verify.with_faults, &[("faults", faults)]));
        }
        if is_practice(&run_of.source, None) {
            departure.add(|words| words.verify.of_simulated.into());
        }
        if run_of.verdict != Some(Verdict::Passed) && departure.why_not.is_empty() {
            departure.add(|words| words.verify.no_pass.into());
        }
        if run.signature.is_none() {
            departure.add(|words| words.verify.departure_unsigned.into());
        }
        Some(departure)
    }

    /// Adds a reason for which the test is not valid, in both languages; a reason that is known already is not added again.
    pub fn add(&mut self, why: impl Fn(&'static Words) -> String) {
        let why = Language::ALL.map(|language| why(language.words()));
        if !self.why_not.contains(&why) {
            self.why_not.push(why);
        }
    }

    /// Adds a reason for each later departure test of this unit that failed.
    ///
    /// # Errors
    /// The store cannot be read.
    pub fn held_against(&mut self, store: &Store) -> Result<(), Failure> {
        let filter = RunFilter {
            unit: Some(self.unit.clone()),
            verdict: Some(Verdict::Failed),
            since_us: Some(self.until_us.saturating_sub(VALID_US)),
            ..RunFilter::default()
        };
        for later in store.runs(&filter)? {
            let is_real = !later.is_practice();
            if is_real && Self::of(&store.run(later.id)?).is_some() {
                let at = local_zoned(later.started_at_us);
                let of: [(&str, &dyn Display); 2] = [("run", &later.id.short()), ("at", &at)];
                self.add(|words| fill(words.verify.later_failed, &of));
            }
        }
        Ok(())
    }

    /// The test at the present time: if its time is over, it has this as a reason.
    pub fn now(mut self) -> Self {
        if self.why_not.is_empty() && now_us() > self.until_us {
            let at = local_zoned(self.until_us);
            self.add(|words| fill(words.verify.was_valid_until, &[("at", &at)]));
        }
        self
    }

    /// Reasons for which the test is not valid; empty if it is valid.
    pub fn why_not(&self, words: &Words) -> Vec<&str> {
        let place = usize::from(words.language == Language::Korean);
        let said = self.why_not.iter().map(|why| why[place].as_str());
        said.collect()
    }

    /// Name and text of the fact: until when the test is valid, or why it is not.
    pub fn fact(&self, words: &Words) -> (String, String) {
        match self.why_not.is_empty() {
            true => (words.report.valid_until.into(), local_zoned(self.until_us)),
            false => (
                words.report.not_valid.into(),
                self.why_not(words).join("; "),
            ),
        }
    }

    /// The test as JSON, for other programs.
    pub fn json(&self) -> Value {
        json!({
            "unit_serial": self.unit, "valid": self.why_not.is_empty(),
            "valid_until": self.why_not.is_empty().then(|| rfc3339(self.until_us)),
            "why_not": self.why_not(Language::English.words()),
        })
    }
}
