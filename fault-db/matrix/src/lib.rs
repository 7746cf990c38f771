//! Dependency matrices: states with probabilities, tests with costs, and the outcome of each test in each state. The
//! crate makes from a matrix the cheapest order of tests, as a decision tree.
//!
//! **Terms.** A *state* is a condition that the system may be in: sound, or with one fault. A *cell* is the probability
//! that a test fails in a state: 1 detects for certain, 0 never fails, between them lie detection and false-alarm
//! probabilities. A matrix of 0 and 1 alone is *crisp*, any other *noisy*. States that no test tells apart are an
//! *ambiguity group*.
//!
//! Four layers: [`Matrix`] is read and checked once, [`Posterior`] weighs it with outcomes, [`plan`]
//! makes the [`Tree`], and the tree writes itself as JSON. Costs are in whatever unit the matrix
//! has, probabilities are plain numbers, information is in bits. Test outcomes are independent of
//! each other in a given state; only one state holds at a time, and tests do not change it.
//!
//! Method: memoised AND/OR search with the lower bound of Huffman codes (Pattipati and Alexandridis, IEEE Trans. SMC
//! 20(4), 1990); for larger matrices information gain per cost with a one-step rollout (Tu and Pattipati, IEEE Trans.
//! SMC-A 33(1), 2003).

mod answer;
mod bits;
mod crisp;
mod error;
mod greedy;
mod information;
mod model;
mod noisy;
mod plan;
mod posterior;
mod problem;
mod read;
mod search;
mod tree;

pub use error::MatrixError;
pub use model::{Matrix, State, Test};
pub use plan::{DEFAULT_CONFIDENCE, MAX_OPTIMAL, Method, Plan, PlanOptions, plan};
pub use posterior::{Outcome, Posterior};
pub use read::read_outcomes;
pub use tree::{Leaf, Node, Tree};
