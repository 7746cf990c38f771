//! Search over crisp matrices (every test certain): a search node is a set of ambiguity groups.

use std::collections::BTreeMap;

use super::bits::ones;
use super::problem::Problem;
use super::search::{Branch, Space};

/// The search space: sets of at most 64 groups, as bits in the order of rising weight.
pub(super) struct CrispSpace {
    /// Weights of the groups, rising.
    weights: Vec<f64>,
    /// Tests that split the groups differently.
    columns: Vec<Column>,
    /// Greatest number of outcomes of a test.
    arity: usize,
    /// Cost of the cheapest test, of the two cheapest together, and so on.
    cheapest: Vec<f64>,
}

struct Column {
    test: usize,
    cost: f64,
    /// For each outcome, the set of groups that have it.
    parts: Vec<u64>,
}

impl CrispSpace {
    pub(super) fn new(problem: &Problem<'_>) -> Self {
        let mut order: Vec<usize> = (0..problem.len()).collect();
        order.sort_by(|a, b| {
            problem.weights[*a]
                .total_cmp(&problem.weights[*b])
                .then(a.cmp(b))
        });
        // Tests that split all groups alike differ in cost only, so one of them is enough.
        let mut columns: BTreeMap<Vec<u64>, Column> = BTreeMap::new();
        for (test, &cost) in problem.costs.iter().enumerate() {
            let mut parts = vec![0; problem.outcomes(test)];
            for (bit, group) in order.iter().enumerate() {
                parts[problem.row(*group)[test] as usize] |= 1 << bit;
            }
            parts.retain(|part| *part != 0);
            let mut same = parts.clone();
            same.sort_unstable();
            if same.len() > 1 && columns.get(&same).is_none_or(|known| cost < known.cost) {
                columns.insert(same, Column { test, cost, parts });
            }
        }
        let mut columns: Vec<_> = columns.into_values().collect();
        columns.sort_by_key(|column| column.test);
        let mut costs: Vec<f64> = columns.iter().map(|column| column.cost).collect();
        costs.sort_by(f64::total_cmp);
        let sums = costs.iter().scan(0.0, |sum, cost| {
            *sum += cost;
            Some(*sum)
        });
        Self {
            weights: order.iter().map(|group| problem.weights[*group]).collect(),
            cheapest: std::iter::once(0.0).chain(sums).collect(),
            arity: columns.iter().map(|c| c.parts.len()).max().unwrap_or(2),
            columns,
        }
    }

    /// The set of all groups.
    pub(super) fn root(&self) -> u64 {
        all(self.weights.len())
    }

    fn mass(&self, set: u64) -> f64 {
        ones(set).map(|bit| self.weights[bit]).sum()
    }

    /// Weighted length of a set's Huffman code: probability times the least number of tests that any tree takes.
    fn huffman(&self, set: u64) -> f64 {
        // Two queues in rising order: the leaves, and the sums in the order in which they are made.
        let mut leaves = [0.0; 64];
        let mut count = 0;
        for bit in ones(set) {
            leaves[count] = self.weights[bit];
            count += 1;
        }
        let mut sums = [0.0; 64];
        let (mut leaf, mut sum, mut made, mut length) = (0, 0, 0, 0.0);
        // The first sum joins just so many that every later sum joins `arity`.
        let mut joint = 2 + count.saturating_sub(2) % (self.arity - 1);
        let mut left = count;
        while left > 1 {
            let mut least = || match sum < made && (leaf == count || sums[sum] < leaves[leaf]) {
                true => {
                    sum += 1;
                    sums[sum - 1]
                }
                false => {
                    leaf += 1;
                    leaves[leaf - 1]
                }
            };
            let joined = (0..joint).map(|_| least()).sum();
            sums[made] = joined;
            made += 1;
            length += joined;
            left -= joint - 1;
            joint = self.arity;
        }
        length
    }

    /// Least cost of this many different tests, in proportion between whole numbers.
    fn cost_of(&self, tests: f64) -> f64 {
        let last = self.cheapest.len() - 1;
        let whole = (tests as usize).min(last);
        let low = self.cheapest[whole];
        match self.cheapest.get(whole + 1) {
            Some(high) => low + (high - low) * (tests - whole as f64),
            None => low,
        }
    }
}

impl Space for CrispSpace {
    type Point = u64;

    fn branches(&self, set: u64) -> Vec<Branch<u64>> {
        let mass = self.mass(set);
        self.columns
            .iter()
            .filter(|column| column.parts.iter().filter(|part| set & *part != 0).count() > 1)
            .map(|column| {
                let parts = column.parts.iter().map(|part| set & part);
                Branch {
                    test: column.test,
                    cost: column.cost * mass,
                    ways: (parts.filter(|part| *part != 0))
                        .map(|part| (part, 1.0))
                        .collect(),
                }
            })
            .collect()
    }

    fn bound(&self, set: u64) -> f64 {
        let mass = self.mass(set);
        if mass <= 0.0 {
            return 0.0;
        }
        // The cost of the n cheapest tests is convex in n, so by Jensen's inequality the mean number of tests may stand
        // for each state's own. The factor keeps rounding from raising the bound.
        mass * self.cost_of(self.huffman(set) / mass) * (1.0 - 1e-12)
    }
}

/// A word with the first `length` bits set.
fn all(length: usize) -> u64 {
    match length {
        64.. => u64::MAX,
        _ => (1 << length) - 1,
    }
}
