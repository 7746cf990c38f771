//! Decision trees, and their JSON.

use std::borrow::Cow;

use super::model::Matrix;

/// Number of levels of a written tree that are indented; deeper ones would be mostly blanks.
const MAX_INDENT: usize = 40;

/// A node of a decision tree; states and tests by their index in the matrix.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// Do a test, and continue by its outcome.
    Test {
        test: usize,
        /// Probability of reaching the node.
        reached: f64,
        /// Each possible outcome, with the node after it: an index of [`Tree::nodes`].
        ways: Vec<(usize, usize)>,
    },
    Leaf(Leaf),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// The only possible state, or several that cannot be told apart any further.
    pub states: Vec<usize>,
    /// Probability that one of these states holds, given the outcomes on the path.
    pub p: f64,
    /// Probability of reaching the leaf.
    pub reached: f64,
    /// Whether further informative tests were left out because the tree grew too large.
    pub cut: bool,
}

/// A decision tree; its root is the first node. Nodes are kept in a list: a tree may be thousands of
/// tests deep.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// All nodes, the root first, each before those below it.
    pub nodes: Vec<Node>,
}

impl Tree {
    /// The first test; `None` if the root is a leaf.
    pub fn first_test(&self) -> Option<usize> {
        match self.nodes.first() {
            Some(Node::Test { test, .. }) => Some(*test),
            _ => None,
        }
    }

    /// Expected cost of the tests.
    pub fn expected_cost(&self, matrix: &Matrix) -> f64 {
        let cost = |node: &Node| match node {
            Node::Test { test, reached, .. } => reached * matrix.tests()[*test].cost,
            Node::Leaf(_) => 0.0,
        };
        self.nodes.iter().map(cost).sum()
    }

    /// Probability of reaching a leaf where the tree was cut.
    pub fn cut_probability(&self) -> f64 {
        let cut = |node: &Node| match node {
            Node::Leaf(leaf) if leaf.cut => leaf.reached,
            _ => 0.0,
        };
        self.nodes.iter().map(cut).sum()
    }

    /// The tree as JSON: `{"test", "pass": …, "fail": …}`, or with words as outcomes `{"test", "outcomes": {"low":
    /// …}}`, down to `{"state" | "states", "p", "reached"}`, indented by `indent` levels. Not recursive, so any depth
    /// can be written.
    pub fn to_json(&self, matrix: &Matrix, indent: usize) -> String {
        enum Task<'a> {
            Node(usize, usize),
            Text(Cow<'a, str>, usize),
        }
        let mut text = String::new();
        let mut tasks = vec![Task::Node(0, indent)];
        while let Some(task) = tasks.pop() {
            let (index, level) = match task {
                Task::Node(index, level) => (index, level),
                Task::Text(part, level) => {
                    line(&mut text, level);
                    text.push_str(&part);
                    continue;
                }
            };
            match self.nodes.get(index) {
                Some(Node::Test { test, ways, .. }) => {
                    text.push('{');
                    line(&mut text, level + 1);
                    text.push_str("\"test\": ");
                    text.push_str(&quoted(&matrix.tests()[*test].id));
                    text.push(',');
                    tasks.push(Task::Text("}".into(), level));
                    let mut inner = level + 1;
                    if !matrix.words(*test).is_empty() {
                        line(&mut text, inner);
                        text.push_str("\"outcomes\": {");
                        tasks.push(Task::Text("}".into(), inner));
                        inner += 1;
                    }
                    for (place, (outcome, node)) in ways.iter().enumerate().rev() {
                        tasks.push(Task::Node(*node, inner));
                        let key = quoted(matrix.outcome(*test, *outcome)) + ": ";
                        tasks.push(Task::Text(key.into(), inner));
                        if place > 0 {
                            tasks.push(Task::Text(",".into(), usize::MAX));
                        }
                    }
                }
                Some(Node::Leaf(leaf)) => leaf.write_json(matrix, &mut text),
                None => {}
            }
        }
        text
    }
}

impl Leaf {
    fn write_json(&self, matrix: &Matrix, text: &mut String) {
        let mut ids = self
            .states
            .iter()
            .map(|state| quoted(&matrix.states()[*state].id));
        match (ids.next(), ids.len()) {
            (Some(only), 0) => text.push_str(&format!("{{\"state\": {only}")),
            (first, _) => {
                let all: Vec<_> = first.into_iter().chain(ids).collect();
                text.push_str(&format!("{{\"states\": [{}]", all.join(", ")));
            }
        }
        // Probabilities are finite, so these are JSON numbers.
        text.push_str(&format!(
            ", \"p\": {:?}, \"reached\": {:?}",
            self.p, self.reached
        ));
        if self.cut {
            text.push_str(", \"cut\": true");
        }
        text.push('}');
    }
}

/// A line break with indentation; nothing for levels too deep to be indented.
fn line(text: &mut String, level: usize) {
    if level != usize::MAX {
        text.push('\n');
        text.push_str(&"  ".repeat(level.min(MAX_INDENT)));
    }
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
