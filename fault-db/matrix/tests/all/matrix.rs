//! Decision trees against exhaustive search and against a walk of every state through them.

use ::matrix::{
    Matrix, Method, Node, Outcome, Plan, PlanOptions, Posterior, State, Test, Tree, plan,
};

pub(super) const CONFIDENCE: f64 = 0.95;

/// A small generator (SplitMix64), so that a failing matrix can be made again from its seed.
pub(super) struct Dice(pub(super) u64);

impl Dice {
    pub(super) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(super) fn below(&mut self, limit: u64) -> u64 {
        self.next() % limit
    }

    /// In 0..1.
    pub(super) fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// States with probabilities in proportion to these weights.
pub(super) fn weighted(weights: impl Iterator<Item = (String, f64)>) -> Vec<State> {
    let weights: Vec<_> = weights.collect();
    let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
    let state = |(id, weight)| State {
        id,
        probability: weight / total,
    };
    weights.into_iter().map(state).collect()
}

pub(super) fn test(id: &str, cost: f64) -> Test {
    Test {
        id: id.into(),
        cost,
    }
}

/// The probabilities of all states.
pub(super) fn prior(matrix: &Matrix) -> Vec<f64> {
    matrix.states().iter().map(|s| s.probability).collect()
}

/// A matrix whose cells the dice choose; `noisy_in_ten` of ten cells are neither 0 nor 1.
fn random(dice: &mut Dice, states: usize, tests: usize, noisy_in_ten: u64) -> Matrix {
    let weights = (0..states).map(|i| (format!("s{i}"), 0.02 + dice.share()));
    let states = weighted(weights);
    let tests = (0..tests).map(|i| test(&format!("t{i}"), 0.5 + 4.0 * dice.share()));
    let tests: Vec<_> = tests.collect();
    let cells = (0..states.len() * tests.len())
        .map(|_| match dice.below(10) < noisy_in_ten {
            true => 0.02 + 0.96 * dice.share(),
            false => dice.below(2) as f64,
        })
        .collect();
    Matrix::new(states, tests, cells).expect("a valid matrix")
}

pub(super) fn planned(matrix: &Matrix, method: Method) -> Plan {
    let options = PlanOptions {
        method: Some(method),
        confidence: CONFIDENCE,
    };
    plan(matrix, &Posterior::prior(matrix), options).expect("a plan")
}

/// A table whose tests have three words, words and errors by turns; `noisy_in_ten` of the errors' cells are uncertain.
fn random_words(dice: &mut Dice, states: usize, tests: usize, noisy_in_ten: u64) -> Matrix {
    let names = (0..tests).map(|test| format!("t{test}"));
    let mut lines = vec![["state".to_owned()].into_iter().chain(names).collect()];
    let costs = (0..tests).map(|_| (1 + dice.below(40)).to_string());
    lines.push(["cost".to_owned()].into_iter().chain(costs).collect());
    for state in 0..states {
        let mut line = vec![format!("s{state}")];
        line.extend((0..tests).map(|test| match test % 3 {
            2 if dice.below(10) < noisy_in_ten => format!("{:.2}", 0.02 + 0.96 * dice.share()),
            2 => dice.below(2).to_string(),
            1 => ["ok", "low", "high"][dice.below(3) as usize].to_owned(),
            _ => (dice.below(2) * 2 + 1).to_string(),
        }));
        lines.push(line);
    }
    let lines: Vec<_> = lines
        .iter()
        .map(|line: &Vec<String>| line.join(","))
        .collect();
    Matrix::from_csv(&lines.join("\n")).expect("a valid table")
}

/// Probability of an outcome in a state.
fn chance(matrix: &Matrix, state: usize, test: usize, outcome: usize) -> f64 {
    let cell = matrix.row(state)[test];
    match outcome {
        _ if !matrix.words(test).is_empty() => f64::from(cell == outcome as f64),
        0 => 1.0 - cell,
        _ => cell,
    }
}

/// Least cost of telling states apart by certain tests: every order of every test tried.
pub(super) fn exhaustive_crisp(matrix: &Matrix, states: &[usize]) -> f64 {
    let mass: f64 = states.iter().map(|s| matrix.states()[*s].probability).sum();
    let mut best = f64::INFINITY;
    for (test, it) in matrix.tests().iter().enumerate() {
        let parts = (0..matrix.words(test).len().max(2)).map(|outcome| {
            let is_here = |state: &usize| chance(matrix, *state, test, outcome) > 0.0;
            let part = states.iter().copied().filter(is_here);
            part.collect::<Vec<_>>()
        });
        let parts: Vec<_> = parts.filter(|part| !part.is_empty()).collect();
        let split = |part: &Vec<usize>| exhaustive_crisp(matrix, part);
        if parts.len() > 1 && parts.iter().all(|part| part.len() < states.len()) {
            best = best.min(mass * it.cost + parts.iter().map(split).sum::<f64>());
        }
    }
    if best.is_finite() { best } else { 0.0 }
}

/// The same where tests may err: `weights` are joint probabilities of all states.
pub(super) fn exhaustive_noisy(matrix: &Matrix, weights: &[f64], used: &mut Vec<bool>) -> f64 {
    let total: f64 = weights.iter().sum();
    let alike = |a: usize, b: usize| {
        (0..used.len()).all(|t| used[t] || matrix.row(a)[t] == matrix.row(b)[t])
    };
    let possible: Vec<usize> = (0..weights.len()).filter(|s| weights[*s] > 0.0).collect();
    for &a in &possible {
        let class = possible.iter().filter(|b| alike(a, **b));
        let class: f64 = class.map(|b| weights[*b]).sum();
        if class >= total * (CONFIDENCE - 1e-12) {
            return 0.0;
        }
    }
    let mut best = f64::INFINITY;
    for test in 0..used.len() {
        let outcomes = matrix.words(test).len().max(2);
        let part = |outcome: usize| -> Vec<f64> {
            let weighed = weights.iter().enumerate();
            let weighed = weighed.map(|(s, weight)| weight * chance(matrix, s, test, outcome));
            weighed.collect()
        };
        let parts: Vec<_> = (0..outcomes).map(part).collect();
        let shannon = |p: f64| if p > 0.0 { -p * p.log2() } else { 0.0 };
        let sums = parts.iter().map(|part| part.iter().sum::<f64>());
        let all = sums.map(|sum| shannon(sum / total));
        let of_state = |s: usize| (0..outcomes).map(move |o| shannon(chance(matrix, s, test, o)));
        let noise = possible
            .iter()
            .map(|s| weights[*s] * of_state(*s).sum::<f64>());
        if used[test] || all.sum::<f64>() - noise.sum::<f64>() / total <= 1e-6 {
            continue;
        }
        used[test] = true;
        let mut cost = total * matrix.tests()[test].cost;
        for part in parts.iter().filter(|part| part.iter().sum::<f64>() > 0.0) {
            cost += exhaustive_noisy(matrix, part, used);
        }
        used[test] = false;
        best = best.min(cost);
    }
    if best.is_finite() { best } else { 0.0 }
}

/// Sends every state down the tree with its probability; checks the ends and gives the cost.
pub(super) fn walked(matrix: &Matrix, tree: &Tree) -> f64 {
    let mut open = vec![(0, prior(matrix), Vec::new())];
    let mut cost = 0.0;
    while let Some((place, weights, way)) = open.pop() {
        let mass: f64 = weights.iter().sum();
        match &tree.nodes[place] {
            Node::Test {
                test,
                reached,
                ways,
            } => {
                assert!(!way.contains(test), "a test is done once on a way");
                assert!((reached - mass).abs() < 1e-9);
                cost += mass * matrix.tests()[*test].cost;
                let way = [&way[..], &[*test]].concat();
                for (outcome, node) in ways.iter().rev() {
                    let weigh = |s: usize| weights[s] * chance(matrix, s, *test, *outcome);
                    let after = (0..weights.len()).map(weigh).collect();
                    open.push((*node, after, way.clone()));
                }
            }
            Node::Leaf(leaf) => {
                let named: f64 = leaf.states.iter().map(|s| weights[*s]).sum();
                assert!((leaf.reached - mass).abs() < 1e-9);
                assert!((leaf.p - named / mass).abs() < 1e-9, "{leaf:?}");
                if matrix.is_crisp() {
                    let off = (named - mass).abs();
                    assert!(off < 1e-12, "every state ends where it is named");
                    let rows = |s: &usize| matrix.row(*s).to_vec();
                    let first = rows(&leaf.states[0]);
                    assert!(leaf.states.iter().all(|s| rows(s) == first));
                } else if !leaf.cut {
                    assert!(leaf.p >= CONFIDENCE - 1e-9, "{leaf:?}");
                }
            }
        }
    }
    cost
}

#[track_caller]
pub(super) fn near(found: f64, wanted: f64, seed: u64) {
    assert!(
        (found - wanted).abs() <= 1e-9 * (1.0 + wanted),
        "seed {seed}: {found} instead of {wanted}"
    );
}

/// Holds the optimal tree to a search that tries everything, and each tree to the cost that it names; the cost of the
/// greedy tree as a multiple of the optimum, unless that is 0.
fn compared(matrix: &Matrix, seed: u64) -> Option<f64> {
    let all: Vec<usize> = (0..matrix.states().len()).collect();
    let wanted = match matrix.is_crisp() {
        true => exhaustive_crisp(matrix, &all),
        false => exhaustive_noisy(
            matrix,
            &prior(matrix),
            &mut vec![false; matrix.tests().len()],
        ),
    };
    let best = planned(matrix, Method::Optimal);
    assert!(best.optimal, "seed {seed}");
    near(best.expected_cost, wanted, seed);
    near(walked(matrix, &best.tree), wanted, seed);
    let greedy = planned(matrix, Method::Greedy);
    near(walked(matrix, &greedy.tree), greedy.expected_cost, seed);
    assert!(greedy.expected_cost >= wanted - 1e-9, "seed {seed}");
    (wanted > 0.0).then(|| greedy.expected_cost / wanted)
}

/// Goal: the optimal tree is optimal, its printed cost is its own, and greedy stays near it.
/// Method: 200 matrices, half of them crisp, each against a search that tries everything.
#[test]
fn optimum_of_200_random_matrices_is_the_exhaustive_one() {
    let mut ratios = Vec::new();
    for seed in 0..200_u64 {
        let mut dice = Dice(seed);
        let crisp = seed % 2 == 0;
        let (states, tests) = match crisp {
            true => (2 + dice.below(5) as usize, 1 + dice.below(6) as usize),
            false => (2 + dice.below(4) as usize, 1 + dice.below(4) as usize),
        };
        let noisy_in_ten = if crisp { 0 } else { 1 + dice.below(10) };
        let matrix = random(&mut dice, states, tests, noisy_in_ten);
        ratios.extend(compared(&matrix, seed));
    }
    let worst = ratios.iter().copied().fold(0.0, f64::max);
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!(ratios.len() > 150, "most have something to tell apart");
    assert!(worst < 1.35 && mean < 1.01, "worst {worst}, mean {mean}");
}

/// What one test tells apart is done by hand: the cheap test first would cost more in all.
#[test]
fn an_expensive_test_that_halves_the_states_beats_cheap_ones_that_remove_one_each() {
    let matrix = Matrix::new(
        weighted(["a", "b", "c", "d"].map(|id| (id.into(), 0.25)).into_iter()),
        vec![test("half", 1.1), test("odd", 1.0), test("a_only", 0.9)],
        [
            [1.0, 1.0, 1.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0],
        ]
        .concat(),
    )
    .expect("a valid matrix");
    // "odd" (1) always, then "a_only" (0.9) if it failed, "half" (1.1) if it passed: 1 + 0.45 + 0.55.
    let best = planned(&matrix, Method::Optimal);
    near(best.expected_cost, 2.0, 0);
    assert_eq!(best.tree.first_test(), Some(1));
}

/// Goal: a test of more than two outcomes is worth what all of them tell. Method: tables against exhaustive search, without
/// and with tests that may err; the greedy tree is walked, too.
#[test]
fn tests_of_several_outcomes_make_the_cheapest_tree() {
    for seed in 0..60 {
        let mut dice = Dice(seed);
        let noisy_in_ten = 5 * (seed % 2);
        let matrix = random_words(&mut dice, 6, 5, noisy_in_ten);
        compared(&matrix, seed);
    }
}

/// Worked by hand: "level" alone tells three states apart at 5; after "is low" it is still needed for two of them, 4 + 5 · 2/3.
#[test]
fn a_table_with_words_is_planned_and_its_outcomes_are_weighed() {
    let table = "state;level;is low\ncost;5;4\nsound;ok;0\nleak;low;1,0\nvalve;high;0\n";
    let matrix = Matrix::from_csv(table).expect("a table");
    let best = planned(&matrix, Method::Optimal);
    assert_eq!((best.expected_cost, best.tree.first_test()), (5.0, Some(0)));
    let known = Posterior::prior(&matrix);
    let json = best.to_json(&matrix, &known).expect("JSON");
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["tree"]["outcomes"]["high"]["state"], "valve");
    let given = |word: &str| {
        let found = [("level".to_owned(), Outcome::parse(word))];
        Posterior::given(&matrix, &found)
    };
    assert_eq!(given("low").expect("an outcome").probability(1), 1.0);
    let wrong = given("lo").expect_err("none").to_string();
    let words = "\"lo\"; it must be one of ok, low, high";
    assert!(wrong.contains(words), "{wrong}");
}

#[test]
fn a_wrong_table_is_refused_with_its_line() {
    for (table, told) in [
        ("", "\"states\" is empty"),
        ("state,t\n", "\"states\" is empty"),
        ("state\ns\n", "\"tests\" is empty"),
        (
            "state,t\na,0\nb\n",
            "line 3: it has another number of cells",
        ),
        ("state,p,t\na,x,1\n", "line 2: \"x\" (p) is no number"),
        ("state,t\na,0\n\nb,1.5\n", "line 4: \"1.5\" (t) is neither"),
        ("state,t\na,low\nb,\n", "line 3: \"\" (t) is neither"),
        ("state,t\ncost,0\na,1\n", "test \"t\" has the cost 0"),
        ("state,p,t\na,0.5,1\n", "sum to 0.5"),
    ] {
        let wrong = Matrix::from_csv(table).expect_err(table).to_string();
        assert!(wrong.contains(told), "{table:?}: {wrong}");
    }
}

#[test]
fn outcomes_leave_the_tree_that_is_left() {
    let mut dice = Dice(7);
    for _ in 0..50 {
        let matrix = random(&mut dice, 7, 7, 3);
        let whole = planned(&matrix, Method::Optimal);
        let Some(Node::Test { test, ways, .. }) = whole.tree.nodes.first() else {
            continue;
        };
        let found = [(matrix.tests()[*test].id.clone(), Outcome::Fail)];
        let known = Posterior::given(&matrix, &found).expect("it can fail");
        let options = PlanOptions {
            method: Some(Method::Optimal),
            confidence: CONFIDENCE,
        };
        let rest = plan(&matrix, &known, options).expect("a plan");
        let next = match &whole.tree.nodes[ways[1].1] {
            Node::Test { test, .. } => Some(*test),
            Node::Leaf(_) => None,
        };
        assert_eq!(rest.tree.first_test(), next);
        assert!(rest.tree.nodes.iter().all(|node| match node {
            Node::Test { test: used, .. } => used != test,
            Node::Leaf(_) => true,
        }));
    }
}

#[test]
fn posterior_is_bayes_rule() {
    let matrix = Matrix::new(
        weighted([("sound".into(), 0.9), ("worn".into(), 0.1)].into_iter()),
        vec![test("noise", 1.0)],
        vec![0.05, 0.8],
    )
    .expect("a valid matrix");
    let found = [("noise".to_owned(), Outcome::Fail)];
    let known = Posterior::given(&matrix, &found).expect("explained");
    // 0.1·0.8 / (0.1·0.8 + 0.9·0.05) = 0.08 / 0.125
    assert!((known.probability(1) - 0.64).abs() < 1e-12);
}

/// Goal: nothing recurses with the depth of a tree. Method: halving probabilities and one test for
/// each state make a chain.
#[test]
fn a_tree_of_a_thousand_levels_is_made_and_written() {
    let count = 1_000_usize;
    // A ratio near 1 keeps the smallest probability a normal number, and each test still peels one.
    let states = (0..count).map(|i| (format!("s{i}"), 0.7_f64.powi(i as i32)));
    let states = weighted(states);
    let tests = (0..count).map(|i| test(&format!("t{i}"), 1.0));
    let mut cells = vec![0.0; count * count];
    for i in 0..count {
        cells[i * count + i] = 1.0;
    }
    let matrix = Matrix::new(states, tests.collect(), cells).expect("a valid matrix");
    let made = planned(&matrix, Method::Greedy);
    assert_eq!(made.tree.nodes.len(), 2 * count - 1);
    // 1 − 0.7 of what is left ends at each test: 1/0.3 tests in the mean.
    assert!((made.expected_cost - 1.0 / 0.3).abs() < 1e-6);
    let text = made.tree.to_json(&matrix, 0);
    assert_eq!(text.matches("\"test\"").count(), count - 1);
    assert!(text.len() < 1_000_000, "{} bytes", text.len());
}

/// Goal: where the work runs out, the answer says so instead of passing for a whole tree.
#[test]
fn a_tree_that_is_too_large_is_cut_and_says_so() {
    let matrix = random(&mut Dice(3), 20, 20, 10);
    let made = planned(&matrix, Method::Greedy);
    let cut = made.tree.cut_probability();
    assert!(!made.optimal);
    assert!(
        cut > 0.0,
        "20 tests that err need more nodes than are allowed"
    );
    assert!(made.warnings.iter().any(|warning| warning.contains("cut")));
    assert!((walked(&matrix, &made.tree) - made.expected_cost).abs() < 1e-9);
    let written = made
        .to_json(&matrix, &Posterior::prior(&matrix))
        .expect("JSON");
    let written: serde_json::Value = serde_json::from_str(&written).expect("JSON");
    assert_eq!(written["cut_probability"].as_f64(), Some(cut));
}
