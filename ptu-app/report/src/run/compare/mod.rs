//! Two runs beside each other, step by step: which verdicts and values changed, and what makes the two hard to compare.
//!
//! Terms: run *A* and run *B* are the first and the second named, mostly before and after a repair. The repair sheet of
//! a case ([`super::CaseSheet`]) lays the steps that failed side by side in the same way.

mod paper;
mod table;
mod text;

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use fault_db::{Id, MeasurementRecord, RunDetail, StepRecord, Store, Verdict, rank};

use super::steps::passed;
use ptu_runs::failure::{Asked, Failure};
use ptu_runs::stored::outside_of;

pub(super) use table::{comparison, name_of};
pub use text::{comparison_json, comparison_text};

/// One step in two runs, or one measurement of this step in both runs.
#[derive(Clone, Copy)]
pub struct Compared<'a> {
    /// The step in the first run; `None` if that run lacks the step.
    pub step_before: Option<&'a StepRecord>,
    /// The step in the second run; `None` if that run lacks the step.
    pub step_after: Option<&'a StepRecord>,
    /// Measurement in the first run; `None` if that run lacks the measurement, or if the row is about the step.
    pub before: Option<&'a MeasurementRecord>,
    pub after: Option<&'a MeasurementRecord>,
}

impl<'a> Compared<'a> {
    /// The step, in whichever run.
    pub fn step(&self) -> Option<&'a StepRecord> {
        self.step_before.or(self.step_after)
    }

    /// The measurement, in whichever run.
    pub fn measured(&self) -> Option<&'a MeasurementRecord> {
        self.before.or(self.after)
    }

    /// Verdict in the second run; `None` if the step or measurement was not tested again.
    pub fn verdict_after(&self) -> Option<Verdict> {
        match self.measured() {
            Some(_) => self.after.map(|after| after.verdict),
            None => self.step_after.map(|step| step.verdict),
        }
    }

    /// Increase of the value from the first run to the second; `None` if a run has no value, or if the units differ.
    pub fn change(&self) -> Option<f64> {
        let (before, after) = (self.before?, self.after?);
        let change = after.value? - before.value?;
        (before.unit == after.unit).then_some(change)
    }
}

/// One step in two runs, with its measurements.
pub struct StepPair<'a> {
    /// The step without its measurements.
    pub step: Compared<'a>,
    pub measurements: Vec<Compared<'a>>,
}

impl StepPair<'_> {
    fn verdicts(&self) -> [Option<Verdict>; 2] {
        [self.step.step_before, self.step.step_after].map(|step| Some(step?.verdict))
    }

    /// The step passed in both runs: there is little to say of it.
    pub fn passed_in_both(&self) -> bool {
        self.verdicts() == [Some(Verdict::Passed); 2]
    }
}

/// Numbers of steps by their results in A and in B; steps that passed in both are not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Steps that did not pass in A and pass in B.
    pub pass_now: usize,
    /// Steps that passed in A and do not pass in B.
    pub passed_before: usize,
    /// Steps that pass in neither.
    pub in_neither: usize,
    pub only_a: usize,
    /// Steps that B alone has.
    pub only_b: usize,
}

/// Differences that make two runs hard to compare.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Differs {
    /// Serial numbers.
    Unit(String, String),
    /// Names of unit configurations whose contents differ; the names may be equal.
    Configuration(String, String),
    /// Names of lines.
    Line(String, String),
    /// Paths of scripts that both runs used with different contents; empty if only other scripts differ.
    Scripts(Vec<String>),
    /// A run without a verdict.
    Unfinished(Id),
    Order,
}

/// Two runs, in the order in which they were named.
pub struct RunComparison {
    pub a: RunDetail,
    pub b: RunDetail,
    /// Steps that passed in both runs are shown, too.
    pub all: bool,
}

impl RunComparison {
    /// Reads both runs.
    ///
    /// # Errors
    /// The same run twice, no such run, or the database cannot be read.
    pub fn gather(store: &Store, a: Id, b: Id, all: bool) -> Result<Self, Failure> {
        if a == b {
            return Err(Failure::usage(Asked::RunBesideItself(a)));
        }
        let read = |run| store.run(run);
        Ok(Self {
            a: read(a)?,
            b: read(b)?,
            all,
        })
    }

    /// Each step once: the steps of A in their order, then those that B alone has.
    pub fn steps(&self) -> Vec<StepPair<'_>> {
        let (first, second) = (by_name(&self.a.steps), by_name(&self.b.steps));
        let of_a = in_order(&self.a.steps).into_iter();
        let mut pairs: Vec<_> = of_a
            .map(|key| pair(first.get(&key).copied(), second.get(&key).copied()))
            .collect();
        let of_b = in_order(&self.b.steps).into_iter();
        let only_b = of_b.filter(|key| !first.contains_key(key));
        pairs.extend(only_b.map(|key| pair(None, second.get(&key).copied())));
        pairs
    }

    /// Numbers of steps by result. A skipped step counts in no direction; an entry outside steps is not counted.
    pub fn tally(&self) -> Tally {
        let mut tally = Tally::default();
        let is_step =
            |pair: &StepPair<'_>| pair.step.step().is_some_and(|of| outside_of(of).is_none());
        for pair in self.steps().into_iter().filter(is_step) {
            match pair.verdicts() {
                [Some(_), None] => tally.only_a += 1,
                [None, Some(_)] => tally.only_b += 1,
                [Some(a), Some(b)] => match (a, b) {
                    (Verdict::Passed, b) if !passed(b) => tally.passed_before += 1,
                    (a, Verdict::Passed) if !passed(a) => tally.pass_now += 1,
                    (a, b) if !passed(a) && !passed(b) => tally.in_neither += 1,
                    _ => {}
                },
                [None, None] => {}
            }
        }
        tally
    }

    /// Differences that make the runs hard to compare.
    pub fn differs(&self) -> Vec<Differs> {
        let (a, b) = (&self.a.run, &self.b.run);
        let two = |a: &String, b: &String| (a.clone(), b.clone());
        let mut all = Vec::new();
        if a.unit_serial != b.unit_serial {
            let (a, b) = two(&a.unit_serial, &b.unit_serial);
            all.push(Differs::Unit(a, b));
        }
        if a.unit_config_sha256 != b.unit_config_sha256 {
            let (a, b) = two(&a.unit_config_name, &b.unit_config_name);
            all.push(Differs::Configuration(a, b));
        }
        if a.line != b.line {
            let (a, b) = two(&a.line, &b.line);
            all.push(Differs::Line(a, b));
        }
        if a.scripts_sha256 != b.scripts_sha256 {
            all.push(Differs::Scripts(self.other_scripts()));
        }
        let unfinished = [a, b].into_iter().filter(|run| run.verdict.is_none());
        all.extend(unfinished.map(|run| Differs::Unfinished(run.id)));
        if a.started_at_us > b.started_at_us {
            all.push(Differs::Order);
        }
        all
    }

    /// Paths of scripts that both runs used with different contents.
    fn other_scripts(&self) -> Vec<String> {
        let of_b = self
            .b
            .scripts
            .iter()
            .map(|script| (&script.path, &script.sha256));
        let of_b: BTreeMap<_, _> = of_b.collect();
        let is_other = |path, hash| of_b.get(path).is_some_and(|other| *other != hash);
        let of_a = self.a.scripts.iter();
        of_a.filter(|script| is_other(&script.path, &script.sha256))
            .map(|script| script.path.clone())
            .collect()
    }
}

/// Procedure and name of a step, or of an entry outside steps, and whether the key is of a step.
type Key<'a> = (&'a str, &'a str, bool);

fn key(step: &StepRecord) -> Key<'_> {
    let is_step = outside_of(step).is_none();
    (&step.procedure, &step.name, is_step)
}

/// Keys of the steps in their order, each once.
fn in_order(steps: &[StepRecord]) -> Vec<Key<'_>> {
    let mut seen = std::collections::BTreeSet::new();
    let keys = steps.iter().map(key);
    keys.filter(|key| seen.insert(*key)).collect()
}

/// Steps by their names; of several records of one step, the one with the highest rank.
fn by_name(steps: &[StepRecord]) -> BTreeMap<Key<'_>, &StepRecord> {
    let mut all: BTreeMap<_, &StepRecord> = BTreeMap::new();
    for step in steps {
        let known = all.entry(key(step)).or_insert(step);
        *known = telling(known, step);
    }
    all
}

/// Of two records of one step, the one with the higher rank; `one` if the ranks are equal.
fn telling<'a>(one: &'a StepRecord, other: &'a StepRecord) -> &'a StepRecord {
    match rank(other.verdict) > rank(one.verdict) {
        true => other,
        false => one,
    }
}

/// A step of two runs with its measurements.
pub(super) fn pair<'a>(
    before: Option<&'a StepRecord>,
    after: Option<&'a StepRecord>,
) -> StepPair<'a> {
    let step = Compared {
        step_before: before,
        step_after: after,
        before: None,
        after: None,
    };
    let measured = |step: Option<&'a StepRecord>| step.map_or(&[][..], |step| &step.measurements);
    let (first, second) = (measured(before), measured(after));
    let find = |all: &'a [MeasurementRecord], name: &str| all.iter().find(|m| m.name == name);
    let mut measurements: Vec<_> = first
        .iter()
        .map(|before| Compared {
            before: Some(before),
            after: find(second, &before.name),
            ..step
        })
        .collect();
    let only_after = second
        .iter()
        .filter(|after| find(first, &after.name).is_none());
    measurements.extend(only_after.map(|after| Compared {
        after: Some(after),
        ..step
    }));
    StepPair { step, measurements }
}

/// The record of this step in another run; of several the one that [`telling`] chooses.
pub(super) fn same_step<'a>(step: &StepRecord, run: &'a RunDetail) -> Option<&'a StepRecord> {
    let all = run.steps.iter().filter(|other| is_same(other, step));
    all.reduce(telling)
}

/// Whether two records, of one run or of two, are of the same step.
pub(super) fn is_same(one: &StepRecord, other: &StepRecord) -> bool {
    key(one) == key(other)
}
