//! Plans the order of tests: options, choice of the method, and the resulting plan.

use super::crisp::CrispSpace;
use super::error::MatrixError;
use super::greedy::grow;
use super::model::Matrix;
use super::noisy::NoisySpace;
use super::posterior::Posterior;
use super::problem::{Belief, Problem};
use super::search::{Limits, Search, Space, WorkLimitReached};
use super::tree::{Node, Tree};

/// Default of the confidence: probability that an answer must have where tests are not certain.
pub const DEFAULT_CONFIDENCE: f64 = 0.99;

/// Greatest number of groups of states, and of tests, for an optimal tree.
pub const MAX_OPTIMAL: usize = 64;

/// Greatest number of groups of states for which an optimal tree is tried if no method was asked for.
const TRIED_STATES: usize = 24;

/// Limits of the search in crisp matrices: all sets of 21 groups, 40 tests.
const CRISP_LIMITS: Limits = Limits {
    points: 2_200_000,
    branches: 90_000_000,
};

/// Limits of the search in noisy matrices, where a node costs about ten microseconds.
const NOISY_LIMITS: Limits = Limits {
    points: 120_000,
    branches: 500_000,
};

/// Greatest number of nodes of an optimal tree; nodes that meet in the search are written out several times.
const MAX_NODES: usize = 200_000;

/// How a tree is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Optimal,
    /// By information gain per cost, with a one-step rollout.
    Greedy,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanOptions {
    /// The method; without one, the cheapest tree if it can be found, else a greedy one.
    pub method: Option<Method>,
    /// Probability that an answer must have, above 0.5 and at most 1. Only noisy matrices need it: certain tests
    /// give certain answers.
    pub confidence: f64,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            method: None,
            confidence: DEFAULT_CONFIDENCE,
        }
    }
}

/// The order of the tests that are not done yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub tree: Tree,
    /// Expected cost of the tree, in the unit of the tests' costs.
    pub expected_cost: f64,
    /// Whether it is proven that no tree costs less.
    pub optimal: bool,
    /// Warnings for whoever follows the plan.
    pub warnings: Vec<String>,
}

/// Plans the tests that are not done yet, given what is known.
///
/// # Errors
/// The confidence is out of range, or an optimal tree is asked for and the matrix is too large for one.
pub fn plan(matrix: &Matrix, known: &Posterior, options: PlanOptions) -> Result<Plan, MatrixError> {
    if !(options.confidence > 0.5 && options.confidence <= 1.0) {
        return Err(MatrixError::Confidence(options.confidence));
    }
    let mut warnings = remarks(matrix);
    let problem = Problem::new(matrix, known, options.confidence);
    let tests = problem.tests.len();
    let small = problem.len() <= MAX_OPTIMAL && (problem.matrix.is_crisp() || tests <= MAX_OPTIMAL);
    let tried = match options.method {
        Some(Method::Optimal) if !small => {
            return Err(MatrixError::TooLargeForOptimal {
                states: problem.len(),
                tests,
                limit: MAX_OPTIMAL,
            });
        }
        Some(Method::Optimal) => true,
        Some(Method::Greedy) => false,
        None => small && problem.len() <= TRIED_STATES,
    };
    if tried {
        match best_tree(&problem) {
            Ok(tree) => {
                return Ok(Plan {
                    expected_cost: tree.expected_cost(matrix),
                    tree,
                    optimal: true,
                    warnings,
                });
            }
            Err(WorkLimitReached) => warnings.push(
                "the search for the optimal tree met its limit of work; this tree is greedy and may cost more"
                    .into(),
            ),
        }
    }
    let grown = grow(&problem);
    if grown.unchecked {
        warnings.push(
            "the work allowed for rollout was used up; some tests are chosen by information gain per cost alone"
                .into(),
        );
    }
    let cut = grown.tree.cut_probability();
    if cut > 0.0 {
        warnings.push(format!(
            "the tree grew too large and is cut: with probability {cut:.3e} it ends before the confidence is reached, and the expected cost leaves out what would follow there; give the outcomes found and ask again"
        ));
    }
    Ok(Plan {
        expected_cost: grown.tree.expected_cost(matrix),
        tree: grown.tree,
        optimal: false,
        warnings,
    })
}

fn best_tree(problem: &Problem<'_>) -> Result<Tree, WorkLimitReached> {
    if problem.matrix.is_crisp() {
        let space = CrispSpace::new(problem);
        let root = space.root();
        searched(problem, Search::new(space, CRISP_LIMITS), root)
    } else {
        let space = NoisySpace::new(problem);
        let root = space.root();
        searched(problem, Search::new(space, NOISY_LIMITS), root)
    }
}

/// Searches for the optimal tree and writes it out.
fn searched<S: Space>(
    problem: &Problem<'_>,
    mut search: Search<S>,
    root: S::Point,
) -> Result<Tree, WorkLimitReached> {
    search.solve(root)?;
    let leaf = |belief: &Belief| Node::Leaf(problem.leaf(belief, false));
    let mut nodes = vec![leaf(&problem.root())];
    let mut open = vec![(root, problem.root(), 0)];
    while let Some((point, belief, place)) = open.pop() {
        let best = search.best_test(point);
        let branches = search.space.branches(point);
        let Some(branch) = branches.iter().find(|branch| Some(branch.test) == best) else {
            continue;
        };
        if nodes.len() >= MAX_NODES {
            return Err(WorkLimitReached);
        }
        let split = problem.split(&belief, branch.test);
        let next = nodes.len();
        nodes[place] = problem.node(&belief, branch.test, &split, next);
        nodes.extend(split.iter().map(|(_, belief)| leaf(belief)));
        let below = branch.ways.iter().zip(split).zip(next..);
        let below = below.map(|(((point, _), (_, belief)), place)| (*point, belief, place));
        let after = open.len();
        open.extend(below);
        open[after..].reverse();
    }
    Ok(Tree { nodes })
}

/// Warnings about a matrix that can be planned for nevertheless.
fn remarks(matrix: &Matrix) -> Vec<String> {
    const SHOWN: usize = 8;
    let some = |names: Vec<&str>| {
        let more = names.len().saturating_sub(SHOWN);
        let shown = names.into_iter().take(SHOWN);
        let quoted: Vec<String> = shown.map(|name| format!("\"{name}\"")).collect();
        match more {
            0 => quoted.join(", "),
            _ => format!("{} and {more} more", quoted.join(", ")),
        }
    };
    let mut remarks = Vec::new();
    let groups = matrix.ambiguity_groups();
    for group in groups.iter().take(SHOWN) {
        let names = group.iter().map(|s| matrix.states()[*s].id.as_str());
        remarks.push(format!(
            "no test tells these states apart (their rows are the same): {}",
            some(names.collect())
        ));
    }
    if let Some(more) = groups.len().checked_sub(SHOWN + 1) {
        remarks.push(format!("{} more groups of states are alike", more + 1));
    }
    let first = matrix.row(0);
    let mut silent: Vec<bool> = vec![true; matrix.tests().len()];
    for state in 0..matrix.states().len() {
        for ((silent, cell), first) in silent.iter_mut().zip(matrix.row(state)).zip(first) {
            *silent &= cell == first;
        }
    }
    let names = matrix.tests().iter().zip(silent);
    let names: Vec<&str> = names
        .filter(|(_, silent)| *silent && matrix.states().len() > 1)
        .map(|(test, _)| test.id.as_str())
        .collect();
    if !names.is_empty() {
        remarks.push(format!(
            "these tests say the same of every state and are never of use: {}",
            some(names)
        ));
    }
    remarks
}
