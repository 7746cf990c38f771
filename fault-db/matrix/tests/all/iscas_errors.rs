//! The dictionaries of ISCAS-85 circuits where each outcome is wrong with a known probability.

use std::collections::BTreeMap;

use ::matrix::{Matrix, Method, Node, Outcome, Posterior};
use diagnosis::{
    Basis, CheckName, ConclusionSettings, CountedSettings, Diagnosis, Dictionary, Finding,
    ModeName, Model, Observation, ObservedStep, Settings,
};
use protocol::Verdict;

use super::iscas::{C17, C432, C499, matrix, some};
use super::matrix::{CONFIDENCE, Dice, planned, walked};

/// Shares of outcomes that are wrong.
const ERRORS: [f64; 2] = [0.01, 0.05];

/// Answers by their own probability, in bands that begin at [`Bands::FROM`].
#[derive(Debug, Default)]
struct Bands([Band; 5]);

#[derive(Debug, Default)]
struct Band {
    answers: usize,
    right: usize,
    /// How many should be right by their own probabilities, and the variance of that number.
    wanted: f64,
    variance: f64,
}

impl Bands {
    const FROM: [f64; 5] = [0.0, 0.5, 0.9, 0.95, 0.99];

    fn add(&mut self, p: f64, right: bool) {
        let band = Self::FROM.iter().rposition(|from| p >= *from);
        let band = &mut self.0[band.expect("a probability")];
        band.answers += 1;
        band.right += usize::from(right);
        band.wanted += p;
        band.variance += p * (1.0 - p);
    }
}

impl Band {
    /// How many more are right than said, in standard deviations; one answer is let pass.
    fn excess(&self) -> f64 {
        let more = self.right as f64 - self.wanted;
        more.signum() * (more.abs() - 1.0).max(0.0) / self.variance.sqrt().max(1e-9)
    }
}

/// The likeliest state and its probability after tests on a system in a state.
fn answer(matrix: &Matrix, state: usize, tests: &[usize], dice: &mut Dice) -> (usize, f64) {
    let outcomes = tests.iter().map(|test| {
        let failed = dice.share() < matrix.row(state)[*test];
        let outcome = if failed { Outcome::Fail } else { Outcome::Pass };
        (matrix.tests()[*test].id.clone(), outcome)
    });
    let known = Posterior::given(matrix, &outcomes.collect::<Vec<_>>());
    known.expect("any outcomes are possible").ranked()[0]
}

/// Goal: an answer is right as often as it says. Method: systems in random states, a random number of
/// random tests done on each, the likeliest state against the true one.
#[test]
fn answers_from_tests_that_err_are_right_as_often_as_they_say() {
    for error in ERRORS {
        let mut bands = Bands::default();
        for text in [C17, C432, C499] {
            let matrix = matrix(text, error);
            let mut dice = Dice(7);
            for _ in 0..600 {
                let state = dice.below(matrix.states().len() as u64) as usize;
                let all = matrix.tests().len();
                let count = all / 4 + dice.below(all as u64 * 3 / 4) as usize;
                let tests = some(count, all, &mut dice);
                let (named, p) = answer(&matrix, state, &tests, &mut dice);
                bands.add(p, named == state);
            }
        }
        for band in &bands.0 {
            println!("{error}: {band:.1?}");
            assert!(band.answers >= 30, "{error}: {band:?}");
            assert!(band.excess().abs() < 3.0, "{error}: {band:?}");
        }
    }
}

/// Goal: how far a whole dictionary isolates a fault where its outcomes err, at what share of wrong answers.
#[test]
fn all_vectors_of_a_circuit_isolate_most_faults_and_name_few_wrong_ones() {
    for (text, error, isolated_at_least) in [
        (C432, 0.01, 0.92),
        (C499, 0.01, 0.92),
        (C432, 0.05, 0.42),
        (C499, 0.05, 0.45),
    ] {
        const SYSTEMS: usize = 250;
        let matrix = matrix(text, error);
        let mut dice = Dice(3);
        let all: Vec<usize> = (0..matrix.tests().len()).collect();
        let (mut isolated, mut wrong, mut first) = (0, 0, 0);
        for _ in 0..SYSTEMS {
            let state = dice.below(matrix.states().len() as u64) as usize;
            let (named, p) = answer(&matrix, state, &all, &mut dice);
            first += usize::from(named == state);
            isolated += usize::from(p >= CONFIDENCE);
            wrong += usize::from(p >= CONFIDENCE && named != state);
        }
        let states = matrix.states().len();
        println!(
            "{states} states, {error}: {isolated} isolated, {wrong} of these wrong, {first} right"
        );
        assert!(isolated as f64 >= isolated_at_least * SYSTEMS as f64);
        assert!(wrong as f64 <= (1.0 - CONFIDENCE) * isolated as f64);
    }
}

/// Goal: a tree of tests that err keeps its word. Method: each state sent down both branches with its
/// probability, so each leaf's is known, not estimated.
#[test]
fn a_tree_of_tests_that_err_isolates_each_state_of_c17() {
    let matrix = matrix(C17, ERRORS[0]);
    let made = planned(&matrix, Method::Greedy);
    let cost = walked(&matrix, &made.tree);
    assert!((cost - made.expected_cost).abs() < 1e-9);
    assert_eq!(made.tree.cut_probability(), 0.0);
    let isolated = made.tree.nodes.iter().map(|node| match node {
        Node::Leaf(leaf) if leaf.states.len() == 1 => leaf.reached,
        _ => 0.0,
    });
    let isolated: f64 = isolated.sum();
    println!("{cost:.3} tests, {isolated:.5} isolated");
    assert!(isolated > 0.999, "{isolated}");
}

/// A run of some vectors on a c17 in a state.
fn run(matrix: &Matrix, state: usize, tests: &[usize], dice: &mut Dice) -> Observation {
    let steps = tests.iter().map(|test| ObservedStep {
        check: vector(matrix, *test),
        result: match dice.share() < matrix.row(state)[*test] {
            true => Verdict::Failed,
            false => Verdict::Passed,
        },
        time_s: 1.0,
        values: Vec::new(),
        signs: Default::default(),
    });
    Observation {
        steps: steps.collect(),
        ..Observation::default()
    }
}

fn vector(matrix: &Matrix, test: usize) -> CheckName {
    CheckName {
        procedure: "c17".into(),
        step: matrix.tests()[test].id.clone(),
    }
}

/// The part at fault: the net of a state's first fault.
fn part(matrix: &Matrix, state: usize) -> String {
    let net = matrix.states()[state].id.split(['>', '/']).next();
    format!("net_{}", net.unwrap_or_default())
}

/// As a campaign makes one: twenty runs of a good circuit and of each fault.
fn counted(matrix: &Matrix, dice: &mut Dice) -> Dictionary {
    let all: Vec<usize> = (0..matrix.tests().len()).collect();
    let checks = all.iter().map(|test| vector(matrix, *test)).collect();
    let mut dictionary = Dictionary::new(Basis::default(), vec![1], checks);
    let mut runs = |state| -> Vec<_> { (0..20).map(|_| run(matrix, state, &all, dice)).collect() };
    dictionary.set_healthy(&runs(0));
    for state in 1..matrix.states().len() {
        let lru = part(matrix, state);
        let mode = ModeName {
            id: format!("{lru}.fault_{state}"),
            lru: lru.parse().expect("a part"),
            text: String::new(),
            kind: "permanent".into(),
            unsafe_: false,
            weight: 1.0,
        };
        dictionary.add(&mode, "nominal".into(), &runs(state));
    }
    dictionary
}

/// Goal: a dictionary that was counted, not given, names no more wrong parts than it says, and few for
/// certain. Method: vectors are independent of each other, so each weighs as one check.
#[test]
fn a_dictionary_counted_from_tests_that_err_is_not_surer_than_it_may_be() {
    for (error, found_at_least) in [(0.01, 0.55), (0.05, 0.30)] {
        const CIRCUITS: usize = 500;
        let matrix = matrix(C17, error);
        assert_eq!(matrix.states()[0].id, "good");
        let mut dice = Dice(11);
        let dictionary = counted(&matrix, &mut dice);
        let settings = Settings {
            no_fault: 1.0 / matrix.states().len() as f64,
            weight_of_step: 0.99,
            // Each fault that a circuit has was counted.
            counted: CountedSettings {
                as_counted: 50.0,
                ..CountedSettings::default()
            },
            conclusion: ConclusionSettings {
                least_of_set: 0.05,
                ..ConclusionSettings::default()
            },
            ..Settings::default()
        };
        let model = Model::new(&dictionary, &settings, &BTreeMap::new());
        let mut bands = Bands::default();
        let (mut found, mut wrong) = (0, 0);
        for _ in 0..CIRCUITS {
            let state = dice.below(matrix.states().len() as u64) as usize;
            let count = 8 + dice.below(25) as usize;
            let tests = some(count, matrix.tests().len(), &mut dice);
            let seen = run(&matrix, state, &tests, &mut dice);
            let answer = Diagnosis::of(&model, &seen);
            let likeliest = &answer.parts[0];
            let is_it = state != 0 && likeliest.lru == part(&matrix, state).as_str();
            match answer.no_fault > likeliest.probability {
                true => bands.add(answer.no_fault, state == 0),
                false => bands.add(likeliest.probability, is_it),
            }
            if answer.conclusion.finding() == Finding::Found {
                found += 1;
                wrong += usize::from(!is_it);
            }
        }
        println!("counted, {error}: {found} found, {wrong} of these wrong");
        for band in &bands.0 {
            println!("counted, {error}: {band:.1?}");
            assert!(band.excess() > -3.0, "{error}: {band:?}");
        }
        assert!(found as f64 >= found_at_least * CIRCUITS as f64);
        assert!(wrong as f64 <= 0.01 * found as f64);
    }
}
