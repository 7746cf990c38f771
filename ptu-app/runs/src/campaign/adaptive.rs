//! Figures of adaptive runs: each held-out unit is tested by one, which chooses its checks by the dictionary.

use std::collections::BTreeMap;

use diagnosis::{Dictionary, Model, Relations, Settings, suite_s};

use super::evaluate::{Assessment, Share, assess_one};
use super::samples::Sample;
use super::suite::Suite;
use crate::drive::monte_carlo::percentile;
use crate::pool;
use crate::stop::Stop;

/// Percentile that nine in ten runs keep to.
const MOST: f64 = 90.0;

/// An adaptive run of a unit with a fault.
struct AdaptiveRun {
    assessment: Assessment,
    steps: usize,
    time_s: f64,
}

/// What the runs take, in steps or in bench time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// Mean over all runs.
    pub mean: f64,
    /// Half of the runs take at most this.
    pub median: f64,
    /// Nine in ten runs take at most this.
    pub p90: f64,
}

/// The figures over adaptive runs of all held-out units with a fault.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AdaptiveFigures {
    pub suite_steps: usize,
    /// Bench time of the suite on a good unit, s.
    pub suite_s: f64,
    /// Steps made, those made again included.
    pub steps: Effort,
    /// Bench time, s.
    pub time_s: Effort,
    /// Runs that did not pass.
    pub detected: Share,
    /// Runs with an unsafe mode that did not pass.
    pub unsafe_detected: Share,
    /// Runs that end with the right part, alone or among few.
    pub named: Share,
    /// Runs that name a wrong part for certain.
    pub wrong: Share,
    /// Unsafe modes whose runs passed.
    pub missed: Vec<String>,
}

impl AdaptiveFigures {
    /// Makes a run of each of these units.
    pub(super) fn of(
        dictionary: &Dictionary,
        (settings, relations): (&Settings, &Relations),
        suite: &Suite,
        samples: &[&Sample],
        jobs: usize,
    ) -> Self {
        let model = Model::new(dictionary, settings, &BTreeMap::new()).with_relations(relations);
        let stop = Stop::default();
        let one = |i: usize| {
            let (run, time_s) = suite.run_adaptively(samples[i], &model, &stop)?;
            Some(AdaptiveRun {
                assessment: assess_one(&model, samples[i], &run)?,
                steps: run.seen.steps.len(),
                time_s,
            })
        };
        let runs = pool::run(samples.len(), jobs, &stop, &mut |_| {}, one);
        let runs: Vec<_> = runs.into_iter().filter_map(|(_, run)| run).collect();
        let all = || runs.iter().map(|run| &run.assessment);
        let unsafe_ = || all().filter(|run| run.unsafe_);
        let missed = unsafe_().filter(|run| !run.detected);
        Self {
            suite_steps: dictionary.checks.len(),
            suite_s: suite_s(&model, None),
            steps: Effort::of(runs.iter().map(|run| run.steps as f64)),
            time_s: Effort::of(runs.iter().map(|run| run.time_s)),
            detected: Share::over(all(), |run| run.detected),
            unsafe_detected: Share::over(unsafe_(), |run| run.detected),
            named: Share::over(all(), Assessment::is_named),
            wrong: Share::over(all(), Assessment::is_wrong),
            missed: missed.map(|run| run.fault.clone()).collect(),
        }
    }
}

impl Effort {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<_> = values.collect();
        values.sort_by(f64::total_cmp);
        let at = |percent: f64| percentile(&values, percent).unwrap_or(0.0);
        Self {
            mean: values.iter().sum::<f64>() / values.len().max(1) as f64,
            median: at(50.0),
            p90: at(MOST),
        }
    }
}
