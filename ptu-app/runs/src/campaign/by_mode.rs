//! Intervals of figures over runs. Runs of one fault mode are much alike, so that a mode is one piece of evidence: modes are
//! drawn with replacement (bootstrap), each with all its runs.

use std::collections::BTreeMap;

use protocol::Random;

use super::evaluate::Assessment;
use crate::drive::monte_carlo::percentile;

/// Number of draws.
const DRAWS: usize = 2000;
/// Percentiles at the ends of the interval, which has 95 % of the draws.
const ENDS: [f64; 2] = [2.5, 97.5];

/// The interval of the share of runs for which `has` holds; none without runs.
pub(super) fn interval(
    runs: &[&Assessment],
    has: impl Fn(&Assessment) -> bool,
) -> Option<[f64; 2]> {
    let mut of_modes: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for run in runs {
        let (of, all) = of_modes.entry(&run.fault).or_default();
        *of += usize::from(has(run));
        *all += 1;
    }
    let of_modes: Vec<_> = of_modes.into_values().collect();
    if of_modes.is_empty() {
        return None;
    }
    let mut random = Random::new(1);
    let draw = |_| {
        let drawn = (0..of_modes.len()).map(|_| of_modes[random.below(of_modes.len())]);
        let (of, all) = drawn.fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
        of as f64 / all as f64
    };
    let mut shares: Vec<f64> = (0..DRAWS).map(draw).collect();
    shares.sort_by(f64::total_cmp);
    let ends = ENDS.map(|end| percentile(&shares, end));
    Some([ends[0]?, ends[1]?])
}
