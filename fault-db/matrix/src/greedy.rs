//! Greedy trees by information gain per cost, with one step of lookahead (rollout): of the few tests with the most gain
//! per cost, the one is chosen whose branches, completed by gain alone, cost least.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::bits::Bits;
use super::information::{binary_entropy, entropy};
use super::problem::{Belief, Problem, USELESS_BITS};
use super::tree::{Node, Tree};

/// Candidate tests whose branches are grown before one is chosen.
const CANDIDATES: usize = 8;

/// Steps of work for all rollouts of a crisp matrix; one step reads one cell, about a nanosecond.
const CRISP_ROLLOUT: u64 = 8_000_000_000;

/// Steps of work for all rollouts of a noisy matrix.
const NOISY_ROLLOUT: u64 = 1_000_000_000;

/// One choice may take 1/4 of the rollout work that is left.
const CRISP_SHARE: u64 = 4;

/// One choice may take 1/64 of it in noisy matrices, where most large branches cannot be completed.
const NOISY_SHARE: u64 = 64;

/// Steps of work of one ranking: for each test in addition to its cells (logarithms), and in total (memory).
const STEPS_PER_TEST: usize = 40;
const STEPS_PER_RANKING: usize = 500;

/// Steps of work to grow a noisy tree, which can be exponentially large.
const NOISY_WORK: u64 = 2_500_000_000;

/// Greatest number of nodes of a noisy tree.
const MAX_NOISY_NODES: usize = 20_000;

/// A group with less than this share of a node's probability is left out when tests of a noisy matrix are weighed.
const RARE: f64 = 1e-9;

pub(super) struct GrownTree {
    pub(super) tree: Tree,
    /// Whether some choices were made by gain alone because the rollout work was used up.
    pub(super) unchecked: bool,
}

/// Grows a tree, the likeliest branches first.
pub(super) fn grow(problem: &Problem<'_>) -> GrownTree {
    let rollout = match problem.matrix.is_crisp() {
        true => CRISP_ROLLOUT,
        false => NOISY_ROLLOUT,
    };
    grow_within(problem, rollout)
}

/// Grows a tree with at most `rollout` steps of rollout; with 0, each choice is the test with the most gain per cost.
fn grow_within(problem: &Problem<'_>, rollout: u64) -> GrownTree {
    let mut grower = Grower::new(problem, rollout);
    let mut nodes = vec![Node::Leaf(problem.leaf(&problem.root(), false))];
    let mut open = BinaryHeap::from([OpenBranch::new(problem.root(), 0)]);
    let mut unchecked = false;
    while let Some(OpenBranch { belief, node, .. }) = open.pop() {
        let ranked = grower.rank(&belief);
        let Some(&best) = ranked.first() else {
            continue;
        };
        if !problem.matrix.is_crisp()
            && (nodes.len() >= MAX_NOISY_NODES || grower.work > NOISY_WORK)
        {
            nodes[node] = Node::Leaf(problem.leaf(&belief, true));
            continue;
        }
        let test = grower.choose(&belief, &ranked).unwrap_or_else(|| {
            unchecked = true;
            best
        });
        let split = problem.split(&belief, test);
        nodes[node] = problem.node(&belief, test, &split, nodes.len());
        for (_, belief) in split {
            let leaf = Node::Leaf(problem.leaf(&belief, false));
            open.push(OpenBranch::new(belief, nodes.len()));
            nodes.push(leaf);
        }
    }
    GrownTree {
        tree: Tree { nodes },
        unchecked,
    }
}

/// A branch that is not grown yet.
struct OpenBranch {
    mass: f64,
    belief: Belief,
    node: usize,
}

impl OpenBranch {
    fn new(belief: Belief, node: usize) -> Self {
        Self {
            mass: belief.mass(),
            belief,
            node,
        }
    }
}

impl Ord for OpenBranch {
    /// The likeliest branch is the greatest; of equally likely ones, the one made first.
    fn cmp(&self, other: &Self) -> Ordering {
        self.mass
            .total_cmp(&other.mass)
            .then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for OpenBranch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for OpenBranch {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for OpenBranch {}

struct Grower<'a> {
    problem: &'a Problem<'a>,
    /// For each group the tests that fail in it, in a crisp matrix.
    fails: Vec<Bits>,
    /// Entropy of the outcome of each test in each group, bits, in a noisy matrix.
    noise: Vec<f64>,
    /// Tests with other outcomes than passing and failing.
    worded: Vec<usize>,
    work: u64,
    rollout_left: u64,
}

impl<'a> Grower<'a> {
    fn new(problem: &'a Problem<'a>, rollout_left: u64) -> Self {
        let groups = 0..problem.len();
        let (mut fails, mut noise) = (Vec::new(), Vec::new());
        if problem.matrix.is_crisp() {
            fails.extend(groups.map(|group| {
                let mut bits = Bits::none(problem.tests.len());
                for (test, cell) in problem.row(group).iter().enumerate() {
                    if *cell == 1.0 && !problem.is_worded(test) {
                        bits.insert(test);
                    }
                }
                bits
            }));
        } else {
            for group in groups {
                noise.extend(problem.row(group).iter().map(|cell| binary_entropy(*cell)));
            }
        }
        Self {
            problem,
            fails,
            noise,
            worded: (0..problem.tests.len())
                .filter(|test| problem.is_worded(*test))
                .collect(),
            work: 0,
            rollout_left,
        }
    }

    /// Informative tests at this node, most gain per cost first; empty at a leaf.
    fn rank(&mut self, belief: &Belief) -> Vec<usize> {
        if belief.members.len() < 2 {
            return Vec::new();
        }
        let cells = belief.members.len() + STEPS_PER_TEST;
        self.work += (cells * self.problem.tests.len() + STEPS_PER_RANKING) as u64;
        let mut scored = match self.problem.matrix.is_crisp() {
            true => self.score_crisp(belief),
            false if self.problem.is_decided(belief) => Vec::new(),
            false => self.score_noisy(belief),
        };
        let has_words = !self.worded.is_empty();
        if has_words && (self.problem.matrix.is_crisp() || !self.problem.is_decided(belief)) {
            scored.extend(self.score_worded(belief));
        }
        for (test, gain) in &mut scored {
            *gain /= self.problem.costs[*test];
        }
        let order = |a: &(usize, f64), b: &(usize, f64)| {
            let costs = &self.problem.costs;
            b.1.total_cmp(&a.1)
                .then(costs[a.0].total_cmp(&costs[b.0]))
                .then(a.0.cmp(&b.0))
        };
        if scored.len() > CANDIDATES {
            scored.select_nth_unstable_by(CANDIDATES, order);
            scored.truncate(CANDIDATES);
        }
        scored.sort_by(order);
        scored.into_iter().map(|(test, _)| test).collect()
    }

    /// Gains of the tests that fail in some members and pass in others.
    fn score_crisp(&self, belief: &Belief) -> Vec<(usize, f64)> {
        let mut some = Bits::none(self.problem.tests.len());
        let mut all: Option<Bits> = None;
        for (group, _) in &belief.members {
            some.unite(&self.fails[*group]);
            all.get_or_insert_with(|| self.fails[*group].clone())
                .intersect(&self.fails[*group]);
        }
        if let Some(all) = &all {
            some.remove(all);
        }
        let mut failing = vec![0.0; self.problem.tests.len()];
        for (group, weight) in &belief.members {
            for test in self.fails[*group].iter() {
                failing[test] += weight;
            }
        }
        let mass = belief.mass();
        let gain = |test: usize| match mass > 0.0 {
            true => binary_entropy(failing[test] / mass),
            false => 0.0,
        };
        some.iter().map(|test| (test, gain(test))).collect()
    }

    /// Gains of the tests with words as outcomes, if more than one outcome is possible.
    fn score_worded(&self, belief: &Belief) -> Vec<(usize, f64)> {
        let gain = |test: &usize| {
            let split = self.problem.split(belief, *test);
            let gain = entropy(split.iter().map(|(_, belief)| belief.mass()));
            (split.len() > 1).then_some((*test, gain))
        };
        self.worded.iter().filter_map(gain).collect()
    }

    /// Gains of the unused tests that are of any use.
    fn score_noisy(&self, belief: &Belief) -> Vec<(usize, f64)> {
        let tests = self.problem.tests.len();
        let mass = belief.mass();
        let (mut failing, mut noise) = (vec![0.0; tests], vec![0.0; tests]);
        let mut weighed = 0.0;
        for &(group, weight) in &belief.members {
            if weight < mass * RARE {
                continue;
            }
            weighed += weight;
            let entropies = &self.noise[group * tests..(group + 1) * tests];
            for (sum, cell) in failing.iter_mut().zip(self.problem.row(group)) {
                *sum += weight * cell;
            }
            for (sum, entropy) in noise.iter_mut().zip(entropies) {
                *sum += weight * entropy;
            }
        }
        if weighed <= 0.0 {
            return Vec::new();
        }
        (0..tests)
            .filter(|test| !belief.used.contains(*test) && !self.problem.is_worded(*test))
            .map(|test| {
                let gain = binary_entropy(failing[test] / weighed) - noise[test] / weighed;
                (test, gain)
            })
            .filter(|(_, gain)| *gain > USELESS_BITS)
            .collect()
    }

    /// The candidate that is best by rollout; `None` if that takes too much work.
    fn choose(&mut self, belief: &Belief, ranked: &[usize]) -> Option<usize> {
        if let [only] = ranked {
            return Some(*only);
        }
        let mut left = match self.problem.matrix.is_crisp() {
            true => self.rollout_left / CRISP_SHARE,
            false => self.rollout_left / NOISY_SHARE,
        };
        let mut best: Option<(f64, usize)> = None;
        for &test in ranked {
            let Some(cost) = self.cost_after(belief, test, &mut left) else {
                break;
            };
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, test));
            }
        }
        best.map(|(_, test)| test)
    }

    /// Cost of a test and of the greedy tree after it, times the probability of reaching this node; `None` once the
    /// work is used up.
    fn cost_after(&mut self, belief: &Belief, test: usize, left: &mut u64) -> Option<f64> {
        let mut cost = belief.mass() * self.problem.costs[test];
        let mut open = self.problem.split(belief, test);
        while let Some((_, belief)) = open.pop() {
            let before = self.work;
            let best = self.rank(&belief).first().copied();
            let taken = self.work - before;
            // Rollout work is not counted as work of growing the tree.
            self.work = before;
            self.rollout_left = self.rollout_left.saturating_sub(taken);
            *left = left.checked_sub(taken)?;
            if let Some(test) = best {
                cost += belief.mass() * self.problem.costs[test];
                open.extend(self.problem.split(&belief, test));
            }
        }
        Some(cost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Matrix, Posterior, State, Test};

    /// 24 states × 24 tests, cells and costs from a seed.
    fn matrix(mut seed: u64) -> Matrix {
        let mut dice = move || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / (1_u64 << 24) as f64
        };
        let state = |i: usize| State {
            id: format!("s{i}"),
            probability: 1.0 / 24.0,
        };
        let tests: Vec<_> = (0..24)
            .map(|i| Test {
                id: format!("t{i}"),
                cost: 1.0 + 9.0 * dice(),
            })
            .collect();
        let cells = (0..24 * 24).map(|_| f64::from(dice() < 0.3));
        let cells = cells.collect();
        Matrix::new((0..24).map(state).collect(), tests, cells).expect("a valid matrix")
    }

    /// Rollout is repeated at each node further down, so a choice that looked better stays better.
    #[test]
    fn rollout_never_costs_more_than_plain_gain_and_mostly_less() {
        let mut less = 0;
        for seed in 0..40 {
            let matrix = matrix(seed);
            let known = Posterior::prior(&matrix);
            let problem = Problem::new(&matrix, &known, 0.99);
            let cost = |grown: GrownTree| grown.tree.expected_cost(&matrix);
            let (plain, checked) = (cost(grow_within(&problem, 0)), cost(grow(&problem)));
            assert!(checked <= plain + 1e-9, "seed {seed}: {checked} > {plain}");
            less += usize::from(checked < plain - 1e-9);
        }
        assert!(less > 20, "{less} of 40");
    }
}
