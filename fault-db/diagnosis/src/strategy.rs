//! Automatic fault isolation: which procedure to start, when to leave it, when to stop.
//!
//! The caller runs the procedure that [`Strategy::begin`] names from its first step, passes every step's result to
//! [`Strategy::saw`], and leaves the procedure when [`Strategy::saw`] returns false.

use std::collections::BTreeSet;

use protocol::Verdict;

use super::belief::{Belief, Settled};
use super::hidden::Hidden;
use super::model::Model;
use super::next_check::{costs, most_per_second};
use super::observation::{CheckName, Observation, ObservedStep};

/// Isolates a fault, check by check.
///
/// A unit that seems healthy is checked further, for each mode that can leave the train less protected and that no
/// check so far would have shown. No check is begun that would make the run longer than all allowed procedures take on
/// a good unit, each run once.
#[derive(Debug)]
pub struct Strategy<'m, 'd> {
    belief: Belief<'m, 'd>,
    hidden: Hidden,
    done: BTreeSet<CheckName>,
    allowed: Option<BTreeSet<String>>,
    target: Option<CheckName>,
    seen: Observation,
    /// Time that the run may take, s.
    most_s: f64,
    /// Time that the run took so far, s.
    time_s: f64,
}

impl<'m, 'd> Strategy<'m, 'd> {
    /// Starts without evidence. Only procedures in `allowed` can be run, if given.
    pub fn new(model: &'m Model<'d>, allowed: Option<BTreeSet<String>>) -> Self {
        Self {
            belief: Belief::new(model),
            hidden: Hidden::new(model),
            done: BTreeSet::new(),
            target: None,
            seen: Observation::default(),
            most_s: suite_s(model, allowed.as_ref()),
            time_s: 0.0,
            allowed,
        }
    }

    /// The check to run next, in a procedure to be started; `None` when one part is found, the unit is
    /// healthy, no check gives more information, or the time is over.
    pub fn begin(&mut self) -> Option<CheckName> {
        self.aim(None);
        if self.target.is_some() {
            self.time_s += self.belief.model.settings.bring_up_s;
        }
        self.target.clone()
    }

    /// Adds the result of a step; whether its procedure is to go on.
    pub fn saw(&mut self, step: &ObservedStep) -> bool {
        self.time_s += step.time_s;
        let new = self.done.insert(step.check.clone());
        if new {
            self.belief.see(self.seen.steps.len(), step);
            if let Some(place) = self.belief.model.dictionary.place(&step.check) {
                self.hidden.see(place);
            }
            self.seen.steps.push(step.clone());
        }
        let surprising = new && (step.result != Verdict::Passed || !step.signs.is_empty());
        let reached = self
            .target
            .as_ref()
            .is_none_or(|check| *check == step.check);
        if surprising || reached {
            self.aim(Some(&step.check.procedure));
        }
        let here = |target: &CheckName| target.procedure == step.check.procedure;
        self.target.as_ref().is_some_and(here)
    }

    /// The procedure has run to its end: none of its checks is asked for again, not even those that were not reached.
    pub fn ended(&mut self, procedure: &str) {
        let checks = &self.belief.model.dictionary.checks;
        let of_procedure = checks.iter().filter(|check| check.procedure == procedure);
        self.done.extend(of_procedure.cloned());
    }

    /// Bench time so far, with bringing the unit up for each procedure, s.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    fn has_time_for(&self, cost_s: f64) -> bool {
        self.time_s + cost_s <= self.most_s
    }

    fn aim(&mut self, under_way: Option<&str>) {
        self.target = match self.belief.answer() {
            Some(Settled::Part(_)) => None,
            Some(Settled::Healthy) => self.hidden_check(under_way),
            None => {
                let may = self.allowed.as_ref();
                let next = self.belief.next_check(&self.done, under_way, may);
                let next = next.map(|next| (next.check, next.cost_s));
                next.filter(|(_, cost_s)| self.has_time_for(*cost_s))
                    .map(|(check, _)| check)
                    .or_else(|| self.hidden_check(under_way))
            }
        };
    }

    /// The check that tells most per second about unsafe modes that no check so far would have shown; `None` once a fault has
    /// shown.
    fn hidden_check(&self, under_way: Option<&str>) -> Option<CheckName> {
        if self.seen.shows_a_fault() {
            return None;
        }
        let model = self.belief.model;
        let costs = costs(model, &self.done, under_way, self.allowed.as_ref(), false);
        let within = costs.filter(|(_, cost_s)| self.has_time_for(*cost_s));
        let showing = within.filter_map(|(place, cost_s)| {
            let worth = self.hidden.worth(place)?;
            Some((place, cost_s, worth))
        });
        let (place, ..) = most_per_second(showing)?;
        Some(model.dictionary.checks[place].clone())
    }
}

/// Bench time of all procedures in `allowed`, each once, with bringing the unit up for each, on a good unit, s.
pub fn suite_s(model: &Model<'_>, allowed: Option<&BTreeSet<String>>) -> f64 {
    let checks = model.dictionary.checks.iter().enumerate();
    let allowed = checks
        .filter(|(_, check)| allowed.is_none_or(|allowed| allowed.contains(&check.procedure)));
    let mut procedures = BTreeSet::new();
    let steps_s: f64 = allowed
        .map(|(place, check)| {
            procedures.insert(&check.procedure);
            model.healthy_time_s(place)
        })
        .sum();
    steps_s + procedures.len() as f64 * model.settings.bring_up_s
}
