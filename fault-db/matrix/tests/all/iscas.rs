//! Matrices nobody here made: the stuck-at fault dictionaries of ISCAS-85 circuits, with tests that are
//! certain and with tests that err.
//!
//! `tests/iscas/make.py` writes them from the circuits, and checks these against what is printed of them.

use ::matrix::{Matrix, Method, Node};

use super::matrix::{Dice, near, planned, test, walked, weighted};

pub(super) const C17: &str = include_str!("../iscas/c17.hex");
pub(super) const C432: &str = include_str!("../iscas/c432.hex");
pub(super) const C499: &str = include_str!("../iscas/c499.hex");

/// A dictionary, its states equally likely, its tests of equal cost; each outcome is wrong with
/// probability `error`.
pub(super) fn matrix(text: &str, error: f64) -> Matrix {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let vectors = lines.next().and_then(|line| line.strip_prefix("vectors "));
    let tests = vectors.expect("vectors").split(' ');
    let tests: Vec<_> = tests.map(|vector| test(vector, 1.0)).collect();
    let rows = lines.map(|line| line.split_once(' ').expect("a row"));
    let rows: Vec<(&str, &str)> = rows.collect();
    let states = weighted(rows.iter().map(|(faults, _)| ((*faults).into(), 1.0)));
    let cell = |digits: &str, test: usize| {
        // The bit of the first vector stands first, and the digits may have bits to spare before it.
        let place = test + 4 * digits.len() - tests.len();
        let digit = digits.as_bytes()[place / 4] as char;
        match digit.to_digit(16).expect("a hex digit") >> (3 - place % 4) & 1 {
            1 => 1.0 - error,
            _ => error,
        }
    };
    let cells = rows.iter().flat_map(|(_, digits)| {
        let row = (0..tests.len()).map(|test| cell(digits, test));
        row.collect::<Vec<_>>()
    });
    let cells = cells.collect();
    Matrix::new(states, tests, cells).expect("a valid matrix")
}

/// So many different numbers below `all`, at random.
pub(super) fn some(count: usize, all: usize, dice: &mut Dice) -> Vec<usize> {
    let mut left: Vec<usize> = (0..all).collect();
    let mut any = || left.swap_remove(dice.below(left.len() as u64) as usize);
    (0..count).map(|_| any()).collect()
}

/// Tests in all that tell equally likely states apart one by one, at least: the length of Huffman's code.
fn huffman(states: u32) -> u32 {
    let whole = states.ilog2();
    states * whole + 2 * (states - (1 << whole))
}

/// For each test the states in which it fails, as bits.
fn columns(matrix: &Matrix) -> Vec<Vec<u64>> {
    let states = matrix.states().len();
    let column = |test: usize| {
        let mut bits = vec![0; states.div_ceil(64)];
        for state in (0..states).filter(|state| matrix.row(*state)[test] == 1.0) {
            bits[state / 64] |= 1 << (state % 64);
        }
        bits
    };
    (0..matrix.tests().len()).map(column).collect()
}

/// Tests in all that any tree of these tests does for the states of a set, at least: every choice of the
/// next `depth` tests, then Huffman's code.
fn least_tests(columns: &[Vec<u64>], set: &[u64], depth: u32) -> u32 {
    let states: u32 = set.iter().map(|word| word.count_ones()).sum();
    if states < 2 {
        return 0;
    }
    if depth == 0 {
        return huffman(states);
    }
    let halves = columns.iter().filter_map(|column| {
        let pairs = set.iter().zip(column);
        let (fail, pass): (Vec<u64>, Vec<u64>) = pairs.map(|(s, c)| (s & c, s & !c)).unzip();
        let both = fail.iter().any(|word| *word != 0) && pass.iter().any(|word| *word != 0);
        both.then(|| {
            least_tests(columns, &fail, depth - 1) + least_tests(columns, &pass, depth - 1)
        })
    });
    states + halves.min().expect("the states can be told apart")
}

#[test]
fn c17_is_told_apart_by_as_few_tests_as_is_known_of_it() {
    let matrix = matrix(C17, 0.0);
    assert_eq!((matrix.states().len(), matrix.tests().len()), (22, 32));
    let best = planned(&matrix, Method::Optimal);
    assert!(best.optimal);
    near(best.expected_cost, 101.0 / 22.0, 0);
    near(walked(&matrix, &best.tree), 101.0 / 22.0, 0);
    // Huffman's code has 100: the optimum is one test longer than any tests could be.
    assert_eq!(huffman(22), 100);
}

/// Goal: a greedy tree of hundreds of states tells each from all others and is not much longer than
/// any tree has to be.
#[test]
fn each_state_of_c432_and_c499_is_isolated_near_the_bound_of_information() {
    for (text, states, most) in [(C432, 458, 1.28), (C499, 723, 1.21)] {
        let matrix = matrix(text, 0.0);
        assert_eq!(matrix.states().len(), states);
        assert!(matrix.ambiguity_groups().is_empty());
        let made = planned(&matrix, Method::Greedy);
        near(walked(&matrix, &made.tree), made.expected_cost, 0);
        let leaves = made.tree.nodes.iter().filter_map(|node| match node {
            Node::Leaf(leaf) => Some(leaf.states.len()),
            Node::Test { .. } => None,
        });
        let leaves: Vec<_> = leaves.collect();
        assert_eq!(leaves, vec![1; states]);
        let all: Vec<u64> = (0..states.div_ceil(64))
            .map(|word| match states - 64 * word {
                64.. => u64::MAX,
                left => (1 << left) - 1,
            })
            .collect();
        let least = f64::from(least_tests(&columns(&matrix), &all, 3)) / states as f64;
        let ratio = made.expected_cost / least;
        println!(
            "{states} states: {:.3} tests, at least {least:.3}, Huffman {:.3}, ratio {ratio:.3}",
            made.expected_cost,
            f64::from(huffman(states as u32)) / states as f64
        );
        assert!((1.0..most).contains(&ratio), "{states} states: {ratio}");
    }
}

/// Goal: where the optimum can be known, the greedy tree is near it. Method: 20 states at random of each
/// circuit; that the optimum is one is checked elsewhere against a search that tries everything.
#[test]
fn greedy_trees_of_a_few_states_of_c432_and_c499_are_near_the_optimum() {
    for text in [C432, C499] {
        let whole = matrix(text, 0.0);
        let mut dice = Dice(20);
        let mut worst = 0.0_f64;
        for turn in 0..5 {
            let some = some(20, whole.states().len(), &mut dice);
            let ids = some.iter().map(|state| whole.states()[*state].id.clone());
            let states = weighted(ids.map(|id| (id, 1.0)));
            let cells = some.iter().flat_map(|state| whole.row(*state).to_vec());
            let part = Matrix::new(states, whole.tests().to_vec(), cells.collect());
            let part = part.expect("a valid matrix");
            let best = planned(&part, Method::Optimal);
            assert!(best.optimal, "turn {turn}");
            let greedy = planned(&part, Method::Greedy);
            let ratio = greedy.expected_cost / best.expected_cost;
            assert!(ratio > 1.0 - 1e-9, "turn {turn}: {ratio}");
            worst = worst.max(ratio);
        }
        println!("20 states at random: ratio {worst:.3} at worst");
        assert!(worst < 1.05, "{worst}");
    }
}
