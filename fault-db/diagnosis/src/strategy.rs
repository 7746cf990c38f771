//! Automatic fault isolation: which procedure to start, when to leave it, when to stop.
//!
//! The caller runs the procedure that [`Strategy::begin`] names from its first step, passes every step's
//! result to [`Strategy::saw`], and leaves the procedure when that says so.

use std::collections::BTreeSet;

use protocol::Verdict;

use super::belief::Belief;
use super::model::Model;
use super::next_check::NextCheck;
use super::observation::{CheckName, Observation, ObservedStep};

/// Isolates a fault, check by check.
#[derive(Debug)]
pub struct Strategy<'m, 'd> {
    belief: Belief<'m, 'd>,
    done: BTreeSet<CheckName>,
    allowed: Option<BTreeSet<String>>,
    target: Option<NextCheck>,
    seen: Observation,
}

impl<'m, 'd> Strategy<'m, 'd> {
    /// Starts without evidence. Only procedures in `allowed` can be run, if given.
    pub fn new(model: &'m Model<'d>, allowed: Option<BTreeSet<String>>) -> Self {
        Self {
            belief: Belief::new(model),
            done: BTreeSet::new(),
            allowed,
            target: None,
            seen: Observation::default(),
        }
    }

    /// The check to run next, in a procedure to be started; `None` when one part is found, the unit is
    /// healthy, or no check gives more information.
    pub fn begin(&mut self) -> Option<NextCheck> {
        self.aim(None);
        self.target.clone()
    }

    /// Adds the result of a step; whether its procedure is to go on.
    pub fn saw(&mut self, step: &ObservedStep) -> bool {
        let new = self.done.insert(step.check.clone());
        if new {
            self.belief.see(self.seen.steps.len(), step);
            self.seen.steps.push(step.clone());
        }
        let surprising = new && (step.result != Verdict::Passed || !step.signs.is_empty());
        let reached = self.target.as_ref().is_none_or(|t| t.check == step.check);
        if surprising || reached {
            self.aim(Some(&step.check.procedure));
        }
        let here = |target: &NextCheck| target.check.procedure == step.check.procedure;
        self.target.as_ref().is_some_and(here)
    }

    /// The procedure has ended; checks in it that were not reached cannot be run.
    pub fn ended(&mut self, procedure: &str) {
        let checks = &self.belief.model.dictionary.checks;
        let of_procedure = checks.iter().filter(|check| check.procedure == procedure);
        self.done.extend(of_procedure.cloned());
    }

    /// The evidence and the posterior.
    pub fn finish(self) -> (Observation, Belief<'m, 'd>) {
        (self.seen, self.belief)
    }

    fn aim(&mut self, under_way: Option<&str>) {
        self.target = if self.belief.is_settled() {
            None
        } else {
            self.belief
                .next_check(&self.done, under_way, self.allowed.as_ref())
        };
    }
}

/// Effort until the question was answered, or all was done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// Steps run.
    pub steps: u32,
    /// Bench time, including the set-up for each procedure, s.
    pub time_s: f64,
    /// Whether one part was found, or the unit is healthy.
    pub settled: bool,
}

/// Effort of the fixed order on a complete run: until the answer that does not change any more. Nobody can
/// stop a fixed order earlier, since only its end shows that.
pub fn fixed_order(model: &Model<'_>, run: &Observation) -> Effort {
    let mut belief = Belief::new(model);
    let mut effort = Effort::default();
    let mut procedure = "";
    let mut answers = Vec::new();
    for (number, step) in run.steps.iter().enumerate() {
        if step.check.procedure != procedure {
            procedure = &step.check.procedure;
            effort.time_s += model.settings.bring_up_s;
        }
        effort.steps += 1;
        effort.time_s += step.time_s;
        belief.see(number, step);
        answers.push((belief.answer(), effort));
    }
    let Some((Some(last), _)) = answers.last().copied() else {
        return effort;
    };
    let stays = answers
        .iter()
        .rev()
        .take_while(|(answer, _)| *answer == Some(last));
    stays.last().map_or(effort, |(_, effort)| Effort {
        settled: true,
        ..*effort
    })
}

/// What the strategy would have done, and what it would have seen, on a run that was made in full: each
/// procedure works on a unit brought up for it, so that it shows the same in any order.
pub fn replayed(model: &Model<'_>, run: &Observation) -> (Effort, Observation) {
    let mut strategy = Strategy::new(model, None);
    let mut effort = Effort::default();
    while let Some(next) = strategy.begin() {
        let procedure = &next.check.procedure;
        effort.time_s += model.settings.bring_up_s;
        let mut steps = run.steps.iter().filter(|s| s.check.procedure == *procedure);
        let left = steps.any(|step| {
            effort.steps += 1;
            effort.time_s += step.time_s;
            !strategy.saw(step)
        });
        if !left {
            strategy.ended(procedure);
        }
    }
    let (seen, belief) = strategy.finish();
    effort.settled = belief.is_settled();
    (effort, seen)
}
