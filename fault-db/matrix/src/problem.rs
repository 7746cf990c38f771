//! The search problem that remains: states not yet told apart, and tests not yet done.

use super::bits::Bits;
use super::model::{Matrix, equal_rows};
use super::posterior::Posterior;
use super::tree::{Leaf, Node};

/// A test that gives less information, bits, is of no use: it may be a rounding error.
pub(super) const USELESS_BITS: f64 = 1e-6;

/// Share of a node's probability by which rounding may miss the confidence.
const ROUNDING: f64 = 1e-12;

/// The states that remain (one group for those that no remaining test tells apart), and the remaining tests.
pub(super) struct Problem<'a> {
    pub(super) matrix: &'a Matrix,
    posterior: &'a Posterior,
    /// Tests not done yet, by their place in the matrix; rows of `cells` are in this order.
    pub(super) tests: Vec<usize>,
    /// Cost of each test in `tests`.
    pub(super) costs: Vec<f64>,
    /// The states of each group, by their index in the matrix.
    groups: Vec<Vec<usize>>,
    /// Probability of each group.
    pub(super) weights: Vec<f64>,
    cells: Vec<f64>,
    /// Probability that an answer must have; only noisy matrices need it.
    pub(super) confidence: f64,
}

/// The groups possible at a node, each with the joint probability of group and node; and the tests used on
/// the path.
#[derive(Clone, Debug)]
pub(super) struct Belief {
    pub(super) members: Vec<(usize, f64)>,
    pub(super) used: Bits,
}

impl Belief {
    /// Probability of reaching the node.
    pub(super) fn mass(&self) -> f64 {
        self.members.iter().map(|(_, weight)| weight).sum()
    }
}

impl<'a> Problem<'a> {
    pub(super) fn new(matrix: &'a Matrix, posterior: &'a Posterior, confidence: f64) -> Self {
        let tests: Vec<usize> = (0..matrix.tests().len())
            .filter(|test| !posterior.is_done(*test))
            .collect();
        // If tests are certain, a state of probability 0 is told apart like any other; if an answer need only be
        // likely, such a state never is the answer.
        let crisp = matrix.is_crisp();
        let groups = equal_rows(matrix, &tests, |state| {
            posterior.is_possible(state) && (crisp || posterior.probability(state) > 0.0)
        });
        let weight = |group: &Vec<usize>| group.iter().map(|s| posterior.probability(*s)).sum();
        let mut cells = Vec::with_capacity(groups.len() * tests.len());
        for group in &groups {
            let row = group.first().map_or(&[][..], |state| matrix.row(*state));
            cells.extend(tests.iter().filter_map(|test| row.get(*test)));
        }
        Self {
            costs: tests
                .iter()
                .map(|test| matrix.tests()[*test].cost)
                .collect(),
            weights: groups.iter().map(weight).collect(),
            matrix,
            posterior,
            tests,
            groups,
            cells,
            confidence,
        }
    }

    /// Number of groups.
    pub(super) fn len(&self) -> usize {
        self.groups.len()
    }

    /// Probabilities that each remaining test fails in a group.
    pub(super) fn row(&self, group: usize) -> &[f64] {
        &self.cells[group * self.tests.len()..(group + 1) * self.tests.len()]
    }

    /// The root node: all groups, no test used.
    pub(super) fn root(&self) -> Belief {
        Belief {
            members: self.weights.iter().copied().enumerate().collect(),
            used: Bits::none(self.tests.len()),
        }
    }

    /// Whether a remaining test has words as outcomes; such a test is certain.
    pub(super) fn is_worded(&self, test: usize) -> bool {
        !self.matrix.words(self.tests[test]).is_empty()
    }

    /// How many outcomes a remaining test has.
    pub(super) fn outcomes(&self, test: usize) -> usize {
        self.matrix.outcomes(self.tests[test])
    }

    /// Probability of an outcome of a remaining test in a group.
    pub(super) fn likelihood(&self, group: usize, test: usize, outcome: usize) -> f64 {
        let cell = self.row(group)[test];
        self.matrix.likelihood(self.tests[test], outcome, cell)
    }

    /// The possible outcomes of a test at a node, each with the node after it.
    pub(super) fn split(&self, belief: &Belief, test: usize) -> Vec<(usize, Belief)> {
        let mut used = belief.used.clone();
        used.insert(test);
        let after = |outcome: usize| {
            let weighed = belief.members.iter().map(|&(group, weight)| {
                let likelihood = self.likelihood(group, test, outcome);
                (group, weight, likelihood)
            });
            let possible = weighed.filter(|(_, _, likelihood)| *likelihood > 0.0);
            let members = possible.map(|(group, weight, likelihood)| (group, weight * likelihood));
            let used = used.clone();
            let members = members.collect();
            (outcome, Belief { members, used })
        };
        let ways = (0..self.outcomes(test)).map(after);
        ways.filter(|(_, belief)| !belief.members.is_empty())
            .collect()
    }

    /// The tree node for a test done at `belief`; its outcomes lead to the nodes from index `next` on.
    pub(super) fn node(
        &self,
        belief: &Belief,
        test: usize,
        split: &[(usize, Belief)],
        next: usize,
    ) -> Node {
        Node::Test {
            test: self.tests[test],
            reached: belief.mass(),
            ways: split
                .iter()
                .map(|(outcome, _)| *outcome)
                .zip(next..)
                .collect(),
        }
    }

    /// Whether one class (groups that no unused test tells apart) reaches the confidence.
    pub(super) fn is_decided(&self, belief: &Belief) -> bool {
        let total = belief.mass();
        let allowed = total * (1.0 - self.confidence + ROUNDING);
        let mut rest = belief.members.clone();
        rest.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let mut seen = 0.0;
        // Once the classes looked at have more than the allowed doubt, no later class can reach the confidence.
        while seen <= allowed {
            let Some(&(first, _)) = rest.first() else {
                return true;
            };
            let (class, others): (Vec<_>, Vec<_>) = rest
                .into_iter()
                .partition(|(group, _)| self.alike(first, *group, &belief.used));
            let outside = seen + others.iter().map(|(_, weight)| weight).sum::<f64>();
            if outside <= allowed {
                return true;
            }
            seen += class.iter().map(|(_, weight)| weight).sum::<f64>();
            rest = others;
        }
        false
    }

    fn alike(&self, a: usize, b: usize, used: &Bits) -> bool {
        a == b
            || self
                .row(a)
                .iter()
                .zip(self.row(b))
                .enumerate()
                .all(|(test, (x, y))| x == y || used.contains(test))
    }

    /// The answer at a leaf: all remaining states if tests are certain, else the likeliest states that together reach
    /// the confidence.
    pub(super) fn leaf(&self, belief: &Belief, cut: bool) -> Leaf {
        let mut states = Vec::new();
        for &(group, weight) in &belief.members {
            let whole = self.weights[group];
            for &state in &self.groups[group] {
                let share = match whole > 0.0 {
                    true => self.posterior.probability(state) / whole,
                    false => 0.0,
                };
                states.push((state, weight * share));
            }
        }
        states.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let mass = belief.mass();
        if self.matrix.is_crisp() {
            states.sort_by_key(|(state, _)| *state);
            return Leaf {
                states: states.into_iter().map(|(state, _)| state).collect(),
                p: 1.0,
                reached: mass,
                cut,
            };
        }
        let allowed = mass * (1.0 - self.confidence + ROUNDING);
        let mut left_out = 0.0;
        let mut kept = states.len();
        while kept > 1 && left_out + states[kept - 1].1 <= allowed {
            kept -= 1;
            left_out += states[kept].1;
        }
        Leaf {
            states: states[..kept].iter().map(|(state, _)| *state).collect(),
            p: match mass > 0.0 {
                true => (mass - left_out) / mass,
                false => 1.0,
            },
            reached: mass,
            cut,
        }
    }
}
