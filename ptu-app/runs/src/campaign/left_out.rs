//! How well a dictionary tells faults that it does not know.
//!
//! The same runs make dictionaries without some of the fault modes, and without a whole part at a time; the held-out
//! runs of the modes left out are diagnosed with these dictionaries.

use std::collections::{BTreeMap, BTreeSet};

use diagnosis::{Basis, Settings};
use protocol::LruId;
use protocol::injection::FaultMode;

use super::baselines::{self, Baselines};
use super::by_mode::interval;
use super::dictionary;
use super::evaluate::{Assessment, Share, assess, joined};
use super::samples::{Purpose, Sample};
use super::suite::{Suite, SuiteRun};

/// Classes of probability of the reliability curve.
const CLASSES: usize = 10;

#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Dictionaries without a share of the modes, that keep another mode of each of their parts.
    pub modes: UnseenFigures,
    /// Dictionaries without any mode of one part.
    pub parts: UnseenFigures,
}

/// Figures over all detected runs with faults that the dictionary does not know.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnseenFigures {
    /// The right part is the likeliest.
    pub first: Share,
    /// The right part is among the first two.
    pub first_two: Share,
    /// The right part is the likeliest, or named for certain.
    pub first_or_named: Share,
    /// Interval of that share, 95 %, by fault mode.
    pub first_or_named_within: Option<[f64; 2]>,
    /// The right part is named for certain, and nothing else.
    pub found: Share,
    /// The right part is named for certain, alone or among few.
    pub named_for_certain: Share,
    /// Other parts are named for certain, and the right part is not among them.
    pub wrong: Share,
    /// Interval of that share, 95 %, by fault mode.
    pub wrong_within: Option<[f64; 2]>,
    /// By the probability of the likeliest part, 0–10 % to 90–100 %: how often it is the right one.
    pub reliability: [Share; CLASSES],
    /// Brier score: mean over the runs of the squared errors of all parts' probabilities, 0 = all certain and right.
    pub brier: f64,
    /// Part that failed, part taken for it, and in how many runs.
    pub confused: Vec<(LruId, LruId, usize)>,
    /// Modes whose part was not named for certain though other parts were, with these parts.
    pub wrong_answers: Vec<(String, String)>,
    /// What nearest neighbours and naive Bayes say of the same runs.
    pub baselines: Baselines,
}

/// Figures over runs with faults that act otherwise than the dictionary counted.
#[derive(Clone, Debug, PartialEq)]
pub struct OtherFaults {
    /// A step did not pass, or a fault was found.
    pub detected: Share,
    pub figures: UnseenFigures,
}

impl OtherFaults {
    pub(super) fn of(runs: &[Assessment]) -> Self {
        Self {
            detected: Share::over(runs.iter(), |run| run.detected),
            figures: UnseenFigures::of(runs.iter().filter(|run| run.detected)),
        }
    }
}

/// The runs of a campaign, and all that they were made with.
pub(super) struct Evidence<'a> {
    pub basis: &'a Basis,
    pub suite: &'a Suite,
    pub modes: &'a [&'a FaultMode],
    pub settings: &'a Settings,
    pub samples: &'a [Sample],
    pub runs: &'a [SuiteRun],
    pub jobs: usize,
}

impl LeftOut {
    /// Leaves out one in `folds` of each part's modes at a time, then one part at a time.
    pub(super) fn of(evidence: &Evidence<'_>, folds: usize) -> Self {
        let numbered = numbered(evidence.modes);
        let fold = |turn: usize| -> BTreeSet<&str> {
            let of_turn = numbered
                .iter()
                .filter(|mode| mode.others > 0 && mode.number % folds == turn);
            of_turn.map(|mode| mode.id).collect()
        };
        let parts: BTreeSet<&LruId> = evidence.modes.iter().map(|mode| &mode.lru).collect();
        let whole = |part: &LruId| -> BTreeSet<&str> {
            let of_part = evidence.modes.iter().filter(|mode| mode.lru == *part);
            of_part.map(|mode| mode.id.as_str()).collect()
        };
        Self {
            modes: UnseenFigures::over((0..folds).map(fold), evidence),
            parts: UnseenFigures::over(parts.into_iter().map(whole), evidence),
        }
    }
}

struct Numbered<'a> {
    id: &'a str,
    /// Place of the mode among the modes of its part.
    number: usize,
    /// Other modes of the part.
    others: usize,
}

fn numbered<'a>(modes: &[&'a FaultMode]) -> Vec<Numbered<'a>> {
    let mut counts: BTreeMap<&LruId, usize> = BTreeMap::new();
    let numbers: Vec<_> = modes
        .iter()
        .map(|mode| {
            let count = counts.entry(&mode.lru).or_default();
            *count += 1;
            *count - 1
        })
        .collect();
    let named = modes.iter().zip(numbers);
    let named = named.map(|(mode, number)| Numbered {
        id: &mode.id,
        number,
        others: counts[&mode.lru] - 1,
    });
    named.collect()
}

impl UnseenFigures {
    fn over<'a>(
        left_out: impl Iterator<Item = BTreeSet<&'a str>>,
        evidence: &Evidence<'_>,
    ) -> Self {
        let mut baselines = Baselines::default();
        let assessed =
            left_out.flat_map(|left_out| assess_without(&left_out, evidence, &mut baselines));
        let assessed: Vec<_> = assessed.filter(|run| run.detected).collect();
        Self {
            baselines,
            ..Self::of(assessed.iter())
        }
    }

    fn of<'a>(runs: impl Iterator<Item = &'a Assessment>) -> Self {
        let runs: Vec<_> = runs.collect();
        let share = |has: &dyn Fn(&Assessment) -> bool| Share::over(runs.iter().copied(), has);
        let class = |run: &Assessment| {
            let top = run.ranked.first().map_or(0.0, |part| part.probability);
            ((top * CLASSES as f64) as usize).min(CLASSES - 1)
        };
        let squared = runs.iter().map(|run| {
            let errors = run.ranked.iter().map(|part| {
                let true_ = f64::from(part.lru == run.lru);
                (part.probability - true_).powi(2)
            });
            errors.sum::<f64>()
        });
        Self {
            first: share(&|run| run.rank() == Some(0)),
            first_two: share(&|run| run.rank().is_some_and(|rank| rank < 2)),
            first_or_named: share(&Assessment::is_first_or_named),
            first_or_named_within: interval(&runs, Assessment::is_first_or_named),
            wrong_within: interval(&runs, Assessment::is_wrong),
            found: share(&Assessment::is_found),
            named_for_certain: share(&Assessment::is_named),
            wrong: share(&Assessment::is_wrong),
            reliability: std::array::from_fn(|of| {
                let in_class = runs.iter().copied().filter(|run| class(run) == of);
                Share::over(in_class, |run| run.rank() == Some(0))
            }),
            brier: squared.sum::<f64>() / runs.len().max(1) as f64,
            confused: confused(&runs),
            wrong_answers: runs
                .iter()
                .filter(|run| run.is_wrong())
                .map(|run| (run.fault.clone(), joined(&run.parts)))
                .collect(),
            baselines: Baselines::default(),
        }
    }
}

/// Diagnoses the held-out runs of the modes `left_out` with a dictionary that does not know them.
fn assess_without(
    left_out: &BTreeSet<&str>,
    evidence: &Evidence<'_>,
    baselines: &mut Baselines,
) -> Vec<Assessment> {
    let is_left_out = |mode: &str| left_out.contains(mode);
    let known: Vec<_> = evidence
        .modes
        .iter()
        .copied()
        .filter(|mode| !is_left_out(&mode.id))
        .collect();
    let Evidence {
        suite,
        settings,
        samples,
        runs,
        jobs,
        ..
    } = *evidence;
    let dictionary = dictionary(evidence.basis.clone(), suite, &known, samples, runs);
    let of_these = samples.iter().zip(runs).filter(|(sample, _)| {
        sample.purpose == Purpose::Assessment && sample.mode().is_some_and(is_left_out)
    });
    let of_these: Vec<_> = of_these.collect();
    baselines::judge(baselines, &dictionary, &of_these);
    let judged_by = (settings, &suite.structure.relations);
    assess(&dictionary, judged_by, &of_these, jobs)
}

fn confused(runs: &[&Assessment]) -> Vec<(LruId, LruId, usize)> {
    let mut counts: BTreeMap<(&LruId, &LruId), usize> = BTreeMap::new();
    for run in runs {
        if let Some(taken) = run.ranked.first().filter(|part| part.lru != run.lru) {
            *counts.entry((&run.lru, &taken.lru)).or_default() += 1;
        }
    }
    let mut counts: Vec<_> = counts
        .into_iter()
        .map(|((part, taken), runs)| (part.clone(), taken.clone(), runs))
        .collect();
    counts.sort_by_key(|(.., runs)| std::cmp::Reverse(*runs));
    counts
}
