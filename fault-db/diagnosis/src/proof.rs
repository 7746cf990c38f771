//! Whether runs that passed prove a repair: how probable they are while the fault is still there.
//!
//! An intermittent fault hides in a share of all runs. The runs in which the fault was present tell how large that
//! share is: the faults of the dictionary that explain those runs say how often a run like the last passes all the
//! same.

use super::belief::Belief;
use super::logarithms::ln_sum;
use super::model::{Model, NO_FAULT};
use super::observation::Observation;

/// Greatest number of further runs that are asked for: a fault that needs more does not show in such runs.
const MOST_RUNS: u32 = 20;

/// What the runs that passed after a repair prove.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proof {
    /// Probability that a unit which still has the fault passes all runs since the repair.
    pub hidden: f64,
    /// Probability that the unit with the fault passes the last run, given that it passed those before.
    pub hidden_in_last: f64,
    /// How many more runs like the last have to pass until `hidden` is at most the limit; `None` for more than 20.
    pub more: Option<u32>,
}

impl Proof {
    pub fn is_proven(&self) -> bool {
        self.more == Some(0)
    }

    /// Weighs the runs in which the fault was `there` and those that `passed` after the repair, both oldest first; the
    /// repair counts as proven if `hidden` is at most `limit`. `None` without a run that passed.
    pub fn of(
        model: &Model<'_>,
        there: &[Observation],
        passed: &[Observation],
        limit: f64,
    ) -> Option<Self> {
        let (last, before_last) = passed.split_last()?;
        let mut belief = Belief::new(model);
        let mut see = |run: &Observation| {
            for (number, step) in run.steps.iter().enumerate() {
                belief.see(number, step);
            }
            against_healthy(&belief)
        };
        let start = there.iter().fold(0.0, |_, run| see(run));
        let before = before_last.iter().fold(start, |_, run| see(run));
        let after = see(last);
        let hidden = |ln: f64| (ln - start).exp().min(1.0);
        let more = (0..=MOST_RUNS).find(|more| {
            let ln = if *more == 0 { after } else { see(last) };
            hidden(ln) <= limit
        });
        Some(Self {
            hidden: hidden(after),
            hidden_in_last: (after - before).exp().min(1.0),
            more,
        })
    }
}

/// Logarithm of the posterior odds of any fault against no fault.
fn against_healthy(belief: &Belief<'_, '_>) -> f64 {
    let ln = belief.ln();
    let faults = ln
        .iter()
        .enumerate()
        .filter(|(place, _)| *place != NO_FAULT);
    ln_sum(faults.map(|(_, ln)| *ln)) - ln[NO_FAULT]
}
