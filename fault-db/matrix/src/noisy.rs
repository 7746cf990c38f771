//! Search over noisy matrices (tests may miss or raise false alarms): a search node is the set of possible
//! states with the outcomes so far; a path uses each test at most once.

use super::bits::{Bits, ones};
use super::information::{binary_entropy, capacity, entropy};
use super::problem::{Belief, Problem, USELESS_BITS};
use super::search::{Branch, Space};

/// A search node: what is known there. An outcome that is equally likely in all possible groups is left out, so that
/// paths to the same knowledge meet in one node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct NoisyPoint {
    /// Groups that are possible.
    possible: u64,
    /// Tests that passed.
    passed: u64,
    /// Tests that failed.
    failed: u64,
}

/// The search space of a problem with at most 64 groups and 64 tests.
pub(super) struct NoisySpace<'a> {
    problem: &'a Problem<'a>,
    /// Entropy of the outcome of each test in each group, bits, in the order of the cells.
    noise: Vec<f64>,
    /// For each test and outcome, the groups in which that outcome is possible.
    ways: Vec<Vec<u64>>,
    /// For each test and group, groups with an equal cell.
    same: Vec<u64>,
    /// For each test and two groups, the overlap of the outcomes: 1 if they are equally likely, 0 if they exclude each
    /// other.
    overlap: Vec<f64>,
}

impl<'a> NoisySpace<'a> {
    pub(super) fn new(problem: &'a Problem<'a>) -> Self {
        let (groups, tests) = (problem.len(), problem.tests.len());
        let mut space = Self {
            problem,
            noise: Vec::new(),
            ways: (0..tests)
                .map(|test| vec![0; problem.outcomes(test)])
                .collect(),
            same: vec![0; tests * groups],
            overlap: vec![0.0; tests * groups * groups],
        };
        for group in 0..groups {
            let row = problem.row(group);
            space
                .noise
                .extend(row.iter().map(|cell| binary_entropy(*cell)));
            for (test, &cell) in row.iter().enumerate() {
                for (outcome, groups) in space.ways[test].iter_mut().enumerate() {
                    let can = problem.likelihood(group, test, outcome) > 0.0;
                    *groups |= u64::from(can) << group;
                }
                for other in 0..groups {
                    let that = problem.row(other)[test];
                    space.same[test * groups + group] |= u64::from(cell == that) << other;
                    let both = (0..problem.outcomes(test)).map(|outcome| {
                        let one = problem.likelihood(group, test, outcome);
                        (one * problem.likelihood(other, test, outcome)).sqrt()
                    });
                    space.overlap[(test * groups + group) * groups + other] = both.sum();
                }
            }
        }
        space
    }

    pub(super) fn root(&self) -> NoisyPoint {
        let possible = (0..self.problem.len()).fold(0, |set, group| set | 1 << group);
        NoisyPoint {
            possible,
            passed: 0,
            failed: 0,
        }
    }

    /// Probabilities of the possible groups at a node, and the tests used on the way.
    fn belief(&self, point: NoisyPoint) -> Belief {
        let mut members: Vec<(usize, f64)> = ones(point.possible)
            .map(|group| {
                let row = self.problem.row(group);
                let passed: f64 = ones(point.passed).map(|test| 1.0 - row[test]).product();
                let failed: f64 = ones(point.failed).map(|test| row[test]).product();
                (group, self.problem.weights[group] * passed * failed)
            })
            .collect();
        let total: f64 = members.iter().map(|(_, weight)| weight).sum();
        for (_, weight) in &mut members {
            *weight /= total;
        }
        let mut used = Bits::none(self.problem.tests.len());
        for test in ones(point.passed | point.failed) {
            used.insert(test);
        }
        Belief { members, used }
    }

    /// Tests that give information at a node, with the probability of each outcome.
    fn useful(&self, belief: &Belief) -> Vec<(usize, Vec<f64>)> {
        if belief.members.len() < 2 || self.problem.is_decided(belief) {
            return Vec::new();
        }
        let tests = self.problem.tests.len();
        let mut useful = Vec::new();
        for test in (0..tests).filter(|test| !belief.used.contains(*test)) {
            let (mut shares, mut noise) = (vec![0.0; self.problem.outcomes(test)], 0.0);
            for &(group, weight) in &belief.members {
                for (outcome, share) in shares.iter_mut().enumerate() {
                    *share += weight * self.problem.likelihood(group, test, outcome);
                }
                noise += weight * self.noise[group * tests + test];
            }
            if let [pass, fail] = &mut shares[..] {
                *pass = 1.0 - *fail;
            }
            if entropy(shares.iter().copied()) - noise > USELESS_BITS {
                useful.push((test, shares));
            }
        }
        useful
    }

    fn after(&self, point: NoisyPoint, test: usize, outcome: usize) -> NoisyPoint {
        let possible = point.possible & self.ways[test][outcome];
        // A test with words as outcomes is certain: its outcome is equally likely in all groups that stay possible.
        let outcomes = match outcome {
            _ if self.problem.is_worded(test) => (point.passed, point.failed),
            0 => (point.passed | 1 << test, point.failed),
            _ => (point.passed, point.failed | 1 << test),
        };
        let first = possible.trailing_zeros() as usize;
        let telling = |set: u64| {
            ones(set)
                .filter(|test| {
                    let same = self.same.get(test * self.problem.len() + first);
                    possible & !same.copied().unwrap_or(u64::MAX) != 0
                })
                .fold(0, |set, test| set | 1 << test)
        };
        NoisyPoint {
            possible,
            passed: telling(outcomes.0),
            failed: telling(outcomes.1),
        }
    }

    /// Upper limit, in bits, of the entropy that remains after all unused tests.
    ///
    /// For a state i it is the mean of log2 Σ_j π_j P(y|j) / (π_i P(y|i)); the root of a sum is at
    /// most the sum of roots, and Jensen's inequality takes the mean inside, where it is the overlap
    /// of the outcomes in both states.
    fn residue(&self, belief: &Belief) -> f64 {
        let groups = self.problem.len();
        let unused: Vec<usize> = (0..self.problem.tests.len())
            .filter(|test| !belief.used.contains(*test))
            .collect();
        let mut sums = vec![1.0; belief.members.len()];
        for (i, &(a, weight_a)) in belief.members.iter().enumerate() {
            for (j, &(b, weight_b)) in belief.members.iter().enumerate().skip(i + 1) {
                let alike: f64 = unused
                    .iter()
                    .map(|test| self.overlap[(test * groups + a) * groups + b])
                    .product();
                if alike > 0.0 && weight_a > 0.0 && weight_b > 0.0 {
                    sums[i] += alike * (weight_b / weight_a).sqrt();
                    sums[j] += alike * (weight_a / weight_b).sqrt();
                }
            }
        }
        let bits = belief.members.iter().zip(&sums);
        bits.map(|((_, weight), sum)| 2.0 * weight * sum.log2())
            .sum()
    }

    /// Upper limit of the entropy over the classes at a leaf that reached the confidence.
    fn doubt(&self, groups: usize) -> f64 {
        let doubt = 1.0 - self.problem.confidence;
        binary_entropy(doubt) + doubt * (groups.max(2) as f64 - 1.0).log2()
    }
}

impl Space for NoisySpace<'_> {
    type Point = NoisyPoint;

    fn branches(&self, point: NoisyPoint) -> Vec<Branch<NoisyPoint>> {
        let useful = self.useful(&self.belief(point));
        let branch = |(test, shares): (usize, Vec<f64>)| {
            let ways = shares.into_iter().enumerate();
            let ways = ways.filter(|(outcome, _)| point.possible & self.ways[test][*outcome] != 0);
            Branch {
                test,
                cost: self.problem.costs[test],
                ways: ways
                    .map(|(outcome, share)| (self.after(point, test, outcome), share))
                    .collect(),
            }
        };
        useful.into_iter().map(branch).collect()
    }

    /// A leaf has either reached the confidence or has no use for the tests left. So the entropy left there is at
    /// most the doubt allowed plus what all tests would leave. Tests have to remove the rest; each is used at
    /// most once and removes at most its capacity. It is cheapest to take them by rising cost per bit.
    fn bound(&self, point: NoisyPoint) -> f64 {
        let belief = self.belief(point);
        let useful = self.useful(&belief);
        let Some(least) = useful
            .iter()
            .map(|(test, _)| self.problem.costs[*test])
            .min_by(f64::total_cmp)
        else {
            return 0.0;
        };
        let slack = self.problem.tests.len() as f64 * USELESS_BITS;
        let mut needed = entropy(belief.members.iter().map(|(_, weight)| *weight))
            - self.doubt(belief.members.len())
            - slack;
        if needed > 0.0 {
            needed -= self.residue(&belief);
        }
        let mut offers: Vec<(f64, f64)> = (0..self.problem.tests.len())
            .filter(|test| !belief.used.contains(*test))
            .filter_map(|test| {
                let cells = belief
                    .members
                    .iter()
                    .map(|(group, _)| self.problem.row(*group)[test]);
                let (low, high) = cells.fold((1.0_f64, 0.0_f64), |(low, high), cell| {
                    (low.min(cell), high.max(cell))
                });
                let bits = match self.problem.is_worded(test) {
                    true => (self.problem.outcomes(test) as f64).log2(),
                    false => capacity(low, high),
                };
                (bits > 0.0).then(|| (self.problem.costs[test], bits))
            })
            .collect();
        offers.sort_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)));
        let mut cost = 0.0;
        for (price, bits) in offers {
            if needed <= 0.0 {
                break;
            }
            cost += price * (needed / bits).min(1.0);
            needed -= bits;
        }
        // Rounding must not raise the bound above the true cost.
        cost.max(least) * (1.0 - 1e-9)
    }
}
