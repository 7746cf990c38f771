//! Runs one case many times, each time with another train and other conditions.

use btu_rig::drive::{Ending, Metrics, Scatter, ScatterDraw};

use serde::{Deserialize, Serialize};

use super::Case;
use crate::batch::{self, BatchResult, Head, Keep, Plan};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::stop::Stop;

/// Runs that are shown as the worst.
const WORST: usize = 5;
/// Share of runs that must stop within the door tolerance for the whole to have passed.
const ENOUGH: f64 = 0.999;
/// Farthest a run may stop past the stop point, m.
const NEVER_PAST_M: f64 = 1.0;

#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Seed of this run: `--scattered --seed` repeats the run.
    pub seed: u64,
    pub drawn: ScatterDraw,
    pub ending: Ending,
    /// Head of the train at rest less stop point, m.
    pub stop_error_m: Option<f64>,
    /// Other figures.
    pub metrics: Option<Metrics>,
}

/// The results of many runs.
pub struct MonteCarlo {
    /// The case, with nominal values.
    pub case: Case,
    pub asked: usize,
    /// Runs that were made, by seed.
    pub trials: Vec<Trial>,
}

/// The part of a run that a file keeps; the rest is drawn again from its seed.
#[derive(Serialize, Deserialize)]
struct KeptTrial {
    ending: Ending,
    stop_error_m: Option<f64>,
    metrics: Option<Metrics>,
}

/// Outcome of the runs of a shard or of all.
pub enum Ran {
    /// The results of each case; fewer than were asked for after a stop.
    All(Vec<MonteCarlo>),
    /// The runs of one shard are kept, so many; results are made of the runs of all shards.
    Part(usize),
}

/// Drives each case `count` times, with seeds from the case's own on, or only the runs of a shard. The tester is
/// silent, which changes nothing but the time it takes.
///
/// # Errors
/// The file that keeps the runs cannot be used.
pub fn run(
    cases: Vec<Case>,
    count: usize,
    scatter: &Scatter,
    keep: &Keep,
    (jobs, stop): (usize, &Stop),
) -> Result<Ran, Failure> {
    let quiet: Vec<Case> = cases
        .iter()
        .map(|case| {
            let mut quiet = case.clone();
            quiet.plan.tester = false;
            quiet
        })
        .collect();
    let head = head(&quiet, count, scatter);
    let plan = head.plan.clone();
    let drawn = |i: usize| {
        let (case, seed) = plan.place(i);
        quiet[case].drawn(scatter, seed.unwrap_or_default())
    };
    let one = |i: usize| {
        let outcome = drawn(i).drive();
        Some(KeptTrial {
            ending: outcome.ending,
            stop_error_m: outcome.stop_error_m,
            metrics: outcome.metrics,
        })
    };
    let ours = keep.ours(plan.len()).count();
    let mut progress = Progress::new(ours, plan.names.join(", "));
    let made = batch::make(
        keep,
        head,
        (jobs, stop),
        &mut |done| progress.tell(done),
        one,
    )?;
    let trials: Vec<Option<KeptTrial>> = match made {
        BatchResult::All(trials) => trials.into_iter().map(Some).collect(),
        BatchResult::Part(runs) => return Ok(Ran::Part(runs)),
        BatchResult::Stopped(trials) => trials,
    };
    let trial = |(i, trial): (usize, Option<KeptTrial>)| {
        let (trial, drawn) = (trial?, drawn(i));
        Some(Trial {
            seed: drawn.seed,
            drawn: ScatterDraw {
                load_kg: drawn.plan.load_kg,
                conditions: drawn.plan.conditions,
            },
            ending: trial.ending,
            stop_error_m: trial.stop_error_m,
            metrics: trial.metrics,
        })
    };
    let mut trials = trials.into_iter().enumerate();
    let of_case = |case| MonteCarlo {
        case,
        asked: count,
        trials: trials.by_ref().take(count).filter_map(trial).collect(),
    };
    Ok(Ran::All(cases.into_iter().map(of_case).collect()))
}

/// Head of these runs: all that decides them, and their names.
fn head(cases: &[Case], count: usize, scatter: &Scatter) -> Head {
    let mut made_by = format!("{scatter:?}\n");
    for case in cases {
        let bench = &case.bench;
        made_by += &format!(
            "{} {:?} {} {:?} {:?}\n",
            bench.config.sha256, bench.settings, bench.line.sha256, case.plan, case.fixed
        );
    }
    let name = |case: &Case| {
        let section = case.plan.section.section;
        format!("section {section} {}", case.controller.name())
    };
    let names: Vec<_> = cases.iter().map(name).collect();
    let first = cases.first().map_or(0, |case| case.seed);
    let plan = Plan {
        what: format!(
            "ptu drive --monte-carlo {count} --seed {first}, {}",
            names.join(", ")
        ),
        names,
        seeds: Some((first, count as u64)),
    };
    Head::new(&made_by, plan)
}

impl Trial {
    /// Whether the train stopped without an emergency brake.
    pub fn stopped(&self) -> bool {
        self.ending == Ending::Stopped
    }

    /// Distance from the stop point, m; infinite if the train did not stop.
    fn off_m(&self) -> f64 {
        let error = self.stop_error_m.filter(|_| self.stopped());
        error.map_or(f64::INFINITY, f64::abs)
    }
}

impl MonteCarlo {
    /// Stop errors of all runs that came to stand, however they did, sorted, m.
    pub fn stop_errors_m(&self) -> Vec<f64> {
        sorted(self.trials.iter().filter_map(|trial| trial.stop_error_m))
    }

    /// Runs that stand more than 1 m past the stop point, however they came there.
    pub fn past_1m(&self) -> usize {
        let past = |trial: &&Trial| trial.stop_error_m.is_some_and(|error| error > NEVER_PAST_M);
        self.trials.iter().filter(past).count()
    }

    /// A figure of the runs that came to their stop, sorted.
    pub fn figures(&self, of: fn(&Metrics) -> f64) -> Vec<f64> {
        let stopped = self.trials.iter().filter(|trial| trial.stopped());
        sorted(stopped.filter_map(|trial| trial.metrics.as_ref().map(of)))
    }

    /// Share of all runs that stopped so close to the stop point.
    pub fn within(&self, metres: f64) -> f64 {
        let near = self
            .trials
            .iter()
            .filter(|trial| trial.off_m() <= metres)
            .count();
        near as f64 / self.trials.len().max(1) as f64
    }

    /// Runs that did not come to their stop.
    pub fn failures(&self) -> impl Iterator<Item = &Trial> {
        self.trials.iter().filter(|trial| !trial.stopped())
    }

    /// The worst runs, worst first.
    pub fn worst(&self) -> Vec<&Trial> {
        let mut trials: Vec<_> = self.trials.iter().collect();
        trials.sort_by(|a, b| b.off_m().total_cmp(&a.off_m()));
        trials.truncate(WORST);
        trials
    }

    /// Whether at least 99.9 % stopped within the door tolerance, and none far past the stop point.
    pub fn passed(&self) -> bool {
        self.within(self.case.tolerance_m()) >= ENOUGH && self.past_1m() == 0
    }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The value below which `percent` of sorted values lie, between two of them by proportion.
pub fn percentile(sorted: &[f64], percent: f64) -> Option<f64> {
    let place = percent / 100.0 * sorted.len().checked_sub(1)? as f64;
    let below = sorted.get(place.floor() as usize)?;
    let above = sorted.get(place.ceil() as usize)?;
    Some(below + (above - below) * place.fract())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Median of 0, 10, 20, 30, 40: 20. 2.5 % of the four gaps is a tenth of the first.
    #[test]
    fn percentiles_lie_between_values() {
        let values = [0.0, 10.0, 20.0, 30.0, 40.0];
        let expected = [
            (0.0, 0.0),
            (2.5, 1.0),
            (50.0, 20.0),
            (99.0, 39.6),
            (100.0, 40.0),
        ];
        for (percent, value) in expected {
            let found = percentile(&values, percent).unwrap();
            assert!((found - value).abs() < 1e-9, "{percent} %: {found}");
        }
        assert_eq!(percentile(&[], 50.0), None);
        assert_eq!(percentile(&[3.0], 99.9), Some(3.0));
    }
}
