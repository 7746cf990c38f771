//! Evaluates a fault dictionary: diagnoses every held-out run with it and computes the figures of the result.

use std::collections::{BTreeMap, BTreeSet};

use diagnosis::{Diagnosis, Dictionary, Finding, Model, PartProbability, Relations, Settings};
use protocol::LruId;

use super::samples::Sample;
use super::suite::SuiteRun;
use crate::pool;
use crate::stop::Stop;

/// Beyond this many parts nothing is isolated.
const MOST_PARTS: usize = 3;

/// A held-out run with a fault, and what diagnosis makes of it.
#[derive(Clone, Debug)]
pub struct Assessment {
    /// Fault mode.
    pub fault: String,
    pub lru: LruId,
    /// `permanent`, `intermittent` or `degraded`.
    pub kind: &'static str,
    /// The mode can leave the train less protected.
    pub unsafe_: bool,
    /// A laptop alone should find the fault.
    pub reachable: bool,
    pub level: usize,
    pub seed: u64,
    /// A step did not pass, or a fault was found.
    pub detected: bool,
    /// Parts that are named, for certain or as likely.
    pub parts: Vec<LruId>,
    pub finding: Finding,
    /// All parts, the likeliest first.
    pub ranked: Vec<PartProbability>,
}

impl Assessment {
    /// Whether the fault is isolated to at most `parts` parts, the right one among them.
    pub fn isolated(&self, parts: usize) -> bool {
        self.detected && self.parts.len() <= parts && self.is_named()
    }

    /// One part or few are named for certain, and the right one is not among them.
    pub fn is_wrong(&self) -> bool {
        self.is_certain() && !self.names_the_part()
    }

    /// The right part is named for certain, alone or among few.
    pub fn is_named(&self) -> bool {
        self.is_certain() && self.names_the_part()
    }

    /// The right part is the likeliest, or named for certain.
    pub fn is_first_or_named(&self) -> bool {
        self.rank() == Some(0) || self.is_named()
    }

    /// The right part is named for certain, and nothing else.
    pub fn is_found(&self) -> bool {
        matches!(self.finding, Finding::Found | Finding::OfBench) && self.names_the_part()
    }

    fn is_certain(&self) -> bool {
        matches!(
            self.finding,
            Finding::Found | Finding::OfBench | Finding::OneOf
        )
    }

    fn names_the_part(&self) -> bool {
        self.parts.contains(&self.lru)
    }

    /// Place of the right part among all.
    pub fn rank(&self) -> Option<usize> {
        self.ranked.iter().position(|part| part.lru == self.lru)
    }
}

/// Diagnoses these runs with a fault.
pub fn assess(
    dictionary: &Dictionary,
    (settings, relations): (&Settings, &Relations),
    faulty: &[(&Sample, &SuiteRun)],
    jobs: usize,
) -> Vec<Assessment> {
    let model = Model::new(dictionary, settings, &BTreeMap::new()).with_relations(relations);
    let one = |i: usize| {
        let (sample, run) = faulty[i];
        assess_one(&model, sample, run)
    };
    let assessed = pool::run(faulty.len(), jobs, &Stop::default(), &mut |_| {}, one);
    let assessed = assessed.into_iter();
    assessed.filter_map(|(_, assessment)| assessment).collect()
}

/// What did not pass, for each run of a good unit.
pub fn not_passed(good: &[(&Sample, &SuiteRun)]) -> Vec<Vec<String>> {
    let good = good.iter().map(|(_, run)| match run.passed {
        true => Vec::new(),
        false => run.not_passed.clone(),
    });
    good.collect()
}

/// Diagnoses a run with a fault; `None` for a good unit.
pub(super) fn assess_one(model: &Model<'_>, sample: &Sample, run: &SuiteRun) -> Option<Assessment> {
    let mode = sample.faults.first()?;
    let diagnosis = Diagnosis::of(model, &run.seen);
    Some(Assessment {
        fault: sample.modes(),
        lru: sample.cause.as_ref().unwrap_or(&mode.lru).clone(),
        kind: mode.kind().word(),
        unsafe_: mode.unsafe_,
        reachable: mode.out_of_reach.is_none(),
        level: sample.level,
        seed: sample.seed,
        detected: !run.passed,
        parts: diagnosis.conclusion.parts(),
        finding: diagnosis.conclusion.finding(),
        ranked: diagnosis.parts,
    })
}

/// Runs with a property, out of all runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Runs with the property.
    pub of: usize,
    pub all: usize,
}

impl Share {
    pub(super) fn over<'a>(
        runs: impl Iterator<Item = &'a Assessment>,
        has: impl Fn(&Assessment) -> bool,
    ) -> Self {
        let mut share = Self::default();
        for run in runs {
            share.count(has(run));
        }
        share
    }

    pub(super) fn count(&mut self, has: bool) {
        self.of += usize::from(has);
        self.all += 1;
    }

    /// The share, 0 to 1; `None` without a run.
    pub fn value(self) -> Option<f64> {
        (self.all > 0).then(|| self.of as f64 / self.all as f64)
    }
}

/// A fault mode that was missed or not isolated in some run.
#[derive(Clone, Debug, PartialEq)]
pub struct Shortfall {
    pub fault: String,
    /// Runs in which the mode was detected, or isolated, out of all its runs.
    pub share: Share,
    /// Parts that the mode was taken for, or what the diagnosis said, the most frequent first.
    pub taken_for: Vec<String>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    /// Fault modes.
    pub modes: usize,
    /// Fault modes detected in every held-out run.
    pub detected_modes: usize,
    /// Fault modes isolated to at most 1, 2, 3 parts in every held-out run.
    pub isolated_modes: [usize; MOST_PARTS],
    /// Runs detected, by kind.
    pub detected: BTreeMap<&'static str, Share>,
    /// Runs of unsafe modes detected.
    pub unsafe_detected: Share,
    /// Runs detected, of modes that a laptop alone should find.
    pub reachable_detected: Share,
    /// Runs isolated to one part, of those detected.
    pub detected_isolated: Share,
    /// Runs isolated to at most 1, 2, 3 parts.
    pub isolated: [Share; MOST_PARTS],
    /// Runs in which diagnosis names one part or few for certain, and the right one is not among them.
    pub wrong: Share,
    /// Runs in which diagnosis names the right part, alone or among few, of those detected.
    pub named: Share,
    /// Modes that were not detected in some run.
    pub undetected: Vec<Shortfall>,
    /// Modes that were not isolated to one part in some run.
    pub not_isolated: Vec<Shortfall>,
    /// Groups of parts that were not told apart in some run.
    pub ambiguous: Vec<Vec<String>>,
    /// Runs of good units.
    pub good_runs: usize,
    /// Runs of good units that did not pass.
    pub false_alarms: usize,
}

/// The figures over all held-out runs.
pub fn figures(assessments: &[Assessment], good: &[Vec<String>]) -> Figures {
    let mut by_mode: BTreeMap<&str, Vec<&Assessment>> = BTreeMap::new();
    for one in assessments {
        by_mode.entry(&one.fault).or_default().push(one);
    }
    let kinds: BTreeSet<_> = assessments.iter().map(|one| one.kind).collect();
    let all = || assessments.iter();
    let every = |has: &dyn Fn(&Assessment) -> bool| {
        by_mode
            .values()
            .filter(|runs| runs.iter().all(|run| has(run)))
            .count()
    };
    let lacking = |has: &dyn Fn(&Assessment) -> bool| {
        let shortfalls = by_mode
            .iter()
            .map(|(fault, runs)| shortfall(fault, runs, has));
        shortfalls
            .filter(|s| s.share.of < s.share.all)
            .collect::<Vec<_>>()
    };
    Figures {
        modes: by_mode.len(),
        detected_modes: every(&|run| run.detected),
        isolated_modes: [1, 2, 3].map(|parts| every(&|run| run.isolated(parts))),
        detected: kinds
            .into_iter()
            .map(|kind| {
                (
                    kind,
                    Share::over(all().filter(|r| r.kind == kind), |r| r.detected),
                )
            })
            .collect(),
        unsafe_detected: Share::over(all().filter(|run| run.unsafe_), |run| run.detected),
        reachable_detected: Share::over(all().filter(|run| run.reachable), |run| run.detected),
        detected_isolated: Share::over(all().filter(|run| run.detected), |run| run.isolated(1)),
        isolated: [1, 2, 3].map(|parts| Share::over(all(), |run| run.isolated(parts))),
        wrong: Share::over(all(), Assessment::is_wrong),
        named: Share::over(all().filter(|run| run.detected), Assessment::is_named),
        undetected: lacking(&|run| run.detected),
        not_isolated: lacking(&|run| run.isolated(1)),
        ambiguous: ambiguous(assessments),
        good_runs: good.len(),
        false_alarms: good.iter().filter(|said| !said.is_empty()).count(),
    }
}

fn shortfall(fault: &str, runs: &[&Assessment], has: &dyn Fn(&Assessment) -> bool) -> Shortfall {
    let mut taken_for: BTreeMap<String, usize> = BTreeMap::new();
    for run in runs.iter().filter(|run| !has(run)) {
        let what = match run.finding {
            Finding::Found | Finding::OfBench | Finding::OneOf | Finding::CannotTell => {
                joined(&run.parts)
            }
            _ => run.finding.label().to_owned(),
        };
        *taken_for.entry(what).or_default() += 1;
    }
    let mut taken_for: Vec<_> = taken_for.into_iter().collect();
    taken_for.sort_by_key(|(_, runs)| std::cmp::Reverse(*runs));
    Shortfall {
        fault: fault.to_owned(),
        share: Share::over(runs.iter().copied(), has),
        taken_for: taken_for.into_iter().map(|(what, _)| what).collect(),
    }
}

pub(super) fn joined(parts: &[LruId]) -> String {
    let parts: Vec<_> = parts.iter().map(LruId::as_str).collect();
    parts.join(" or ")
}

/// Parts that stand together in an answer of several, joined as far as answers overlap.
fn ambiguous(assessments: &[Assessment]) -> Vec<Vec<String>> {
    let mut groups: Vec<BTreeSet<String>> = Vec::new();
    let open = assessments
        .iter()
        .filter(|run| run.detected && run.finding == Finding::OneOf);
    for run in open.filter(|run| run.parts.len() <= MOST_PARTS) {
        let mut group: BTreeSet<_> = run.parts.iter().map(LruId::to_string).collect();
        let (touching, apart): (Vec<_>, Vec<_>) = groups
            .into_iter()
            .partition(|known| !known.is_disjoint(&group));
        group.extend(touching.into_iter().flatten());
        groups = apart;
        groups.push(group);
    }
    groups
        .into_iter()
        .map(|group| group.into_iter().collect())
        .collect()
}
