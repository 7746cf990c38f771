//! AND/OR search for the cheapest tree: at each node one test is chosen, and all its outcomes have to be paid for.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hash, Hasher};

/// A search graph: tests can be done at each node, and each outcome leads to a node.
pub(super) trait Space {
    /// Identifies a node.
    type Point: Copy + Eq + Hash;

    /// The tests at a node; empty at a leaf.
    fn branches(&self, point: Self::Point) -> Vec<Branch<Self::Point>>;

    /// A lower bound of the cost from a node on; 0 at a leaf.
    fn bound(&self, point: Self::Point) -> f64;
}

/// A test at a node.
pub(super) struct Branch<P> {
    pub(super) test: usize,
    /// Cost of the test, a part of the cost of its node.
    pub(super) cost: f64,
    /// The node after each outcome, with the weight of that node's cost.
    pub(super) ways: Vec<(P, f64)>,
}

/// Limits of the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Greatest number of nodes kept in memory.
    pub(super) points: usize,
    /// Greatest number of branches examined.
    pub(super) branches: u64,
}

/// A limit was reached before the optimum was known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct WorkLimitReached;

#[derive(Clone, Copy)]
struct Known {
    /// The least cost from the node on if `solved`, else a lower bound of it.
    cost: f64,
    solved: bool,
    /// The best test, if there is any.
    test: Option<usize>,
}

pub(super) struct Search<S: Space> {
    pub(super) space: S,
    known: HashMap<S::Point, Known, BuildHasherDefault<Mix>>,
    limits: Limits,
    weighed: u64,
}

impl<S: Space> Search<S> {
    pub(super) fn new(space: S, limits: Limits) -> Self {
        Self {
            space,
            known: HashMap::default(),
            limits,
            weighed: 0,
        }
    }

    /// The least cost from a node on. The recursion is at most as deep as there are tests.
    pub(super) fn solve(&mut self, point: S::Point) -> Result<f64, WorkLimitReached> {
        if let Some(known) = self.known.get(&point).filter(|known| known.solved) {
            return Ok(known.cost);
        }
        let branches = self.space.branches(point);
        self.weighed += branches.len() as u64;
        if self.weighed > self.limits.branches || self.known.len() > self.limits.points {
            return Err(WorkLimitReached);
        }
        let mut order: Vec<(f64, usize)> = Vec::with_capacity(branches.len());
        for (index, branch) in branches.iter().enumerate() {
            order.push((self.least_of(branch.cost, &branch.ways), index));
        }
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut best = (f64::INFINITY, None);
        'tests: for (least, index) in order {
            if least >= best.0 {
                break;
            }
            let branch = &branches[index];
            // The outcome with the greatest weight first, as it soonest makes the test too expensive.
            let mut ways = branch.ways.clone();
            ways.sort_by(|a, b| b.1.total_cmp(&a.1));
            let (mut cost, mut left) = (branch.cost, &ways[..]);
            while let [(point, weight), others @ ..] = left {
                cost += weight * self.solve(*point)?;
                left = others;
                if self.least_of(cost, left) >= best.0 {
                    continue 'tests;
                }
            }
            best = (cost, Some(branch.test));
        }
        let cost = if branches.is_empty() { 0.0 } else { best.0 };
        let known = Known {
            cost,
            solved: true,
            test: best.1,
        };
        self.known.insert(point, known);
        Ok(cost)
    }

    /// The best test at a solved node; `None` at a leaf.
    pub(super) fn best_test(&self, point: S::Point) -> Option<usize> {
        self.known.get(&point).and_then(|known| known.test)
    }

    /// `cost` plus the weighted least costs known for the nodes in `ways`.
    fn least_of(&mut self, cost: f64, ways: &[(S::Point, f64)]) -> f64 {
        let mut least = cost;
        for (point, weight) in ways {
            least += weight * self.least(*point);
        }
        least
    }

    /// A lower bound of the cost from a node on: what is known of the node, or else the space's bound.
    fn least(&mut self, point: S::Point) -> f64 {
        if let Some(known) = self.known.get(&point) {
            return known.cost;
        }
        let cost = self.space.bound(point);
        let known = Known {
            cost,
            solved: false,
            test: None,
        };
        self.known.insert(point, known);
        cost
    }
}

/// A hasher that mixes small keys: the standard one costs more than the search itself. No result depends on the order
/// of the table.
#[derive(Default)]
pub(super) struct Mix(u64);

impl Hasher for Mix {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_u64(u64::from(*byte));
        }
    }

    fn write_u64(&mut self, value: u64) {
        // The finaliser of SplitMix64 (Steele, Lea, Flood 2014).
        let mut mixed = self.0 ^ value;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        self.0 = (mixed ^ (mixed >> 31)).wrapping_add(0x9e37_79b9_7f4a_7c15);
    }
}
