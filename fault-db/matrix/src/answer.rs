//! The JSON document of a test plan.

use serde::Serialize;

use super::model::Matrix;
use super::plan::Plan;
use super::posterior::Posterior;

#[derive(Serialize)]
struct Head<'a> {
    expected_cost: f64,
    optimal: bool,
    cut_probability: f64,
    next_test: Option<&'a str>,
    posterior: Vec<StateProbability<'a>>,
    warnings: &'a [String],
}

#[derive(Serialize)]
struct StateProbability<'a> {
    id: &'a str,
    p: f64,
}

impl Plan {
    /// `{"expected_cost", "optimal", "cut_probability", "next_test", "posterior": [{"id", "p"}], "warnings", "tree"}`;
    /// the posterior has the possible states, likeliest first. A cut probability above 0 says that the tree was not
    /// grown to its ends, so its cost is only a lower limit.
    pub fn to_json(&self, matrix: &Matrix, known: &Posterior) -> Result<String, serde_json::Error> {
        let name = |state: usize| matrix.states()[state].id.as_str();
        let head = Head {
            expected_cost: self.expected_cost,
            optimal: self.optimal,
            cut_probability: self.tree.cut_probability(),
            next_test: self
                .tree
                .first_test()
                .map(|test| matrix.tests()[test].id.as_str()),
            posterior: known
                .ranked()
                .into_iter()
                .map(|(state, p)| StateProbability { id: name(state), p })
                .collect(),
            warnings: &self.warnings,
        };
        let head = serde_json::to_string_pretty(&head)?;
        // The tree is written separately, as it may be very deep, and put before the last brace.
        let open = head.trim_end_matches('}').trim_end();
        let tree = self.tree.to_json(matrix, 1);
        Ok(format!("{open},\n  \"tree\": {tree}\n}}"))
    }
}
