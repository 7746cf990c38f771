//! `ptu matrix`: the contract of its JSON, its examples, and what it refuses.

use crate::common::{Place, list, number, scripts, text};
use serde_json::{Value, json};

fn example(name: &str) -> String {
    scripts().join("matrices").join(name).display().to_string()
}

/// Sends a state down a crisp tree: tests on its way and the end it comes to.
fn way<'a>(tree: &'a Value, outcomes: &Value, state: &str) -> (Vec<String>, &'a Value) {
    let (mut node, mut tests) = (tree, Vec::new());
    while let Some(test) = node["test"].as_str() {
        tests.push(test.to_owned());
        let failed = outcomes[test][state].as_f64().unwrap_or(0.0) == 1.0;
        node = &node[if failed { "fail" } else { "pass" }];
    }
    (tests, node)
}

/// Worked by hand: with tests of cost 1 a tree costs the mean length of a code for the states, and
/// Huffman's for 0.3, 0.2, 0.2, 0.1, 0.1, 0.1 has 0.2 + 0.3 + 0.4 + 0.6 + 1 = 2.5; the tests allow
/// it: pulses, then sensor 1 or the self test, and so on.
#[test]
fn six_by_six_costs_what_huffman_says() {
    let place = Place::new();
    let file = example("six_by_six.json");
    let answer = place.json(&["matrix", &file, "--json"]);
    assert!((number(&answer["expected_cost"]) - 2.5).abs() < 1e-12);
    assert_eq!(answer["optimal"], true);
    assert_eq!(answer["next_test"], answer["tree"]["test"]);
    let matrix: Value =
        serde_json::from_str(&std::fs::read_to_string(&file).expect("example")).expect("JSON");
    let mut cost = 0.0;
    for state in list(&matrix["states"]) {
        let (tests, end) = way(&answer["tree"], &matrix["outcomes"], text(&state["id"]));
        assert_eq!(end["state"], state["id"]);
        cost += number(&state["p"]) * tests.len() as f64;
    }
    assert!((cost - 2.5).abs() < 1e-12);
    let greedy = place.json(&["matrix", &file, "--tree", "greedy", "--json"]);
    assert_eq!(greedy["optimal"], false);
    assert!(number(&greedy["expected_cost"]) >= 2.5 - 1e-12);
}

#[test]
fn uncertain_tests_end_at_the_confidence_asked() {
    let place = Place::new();
    let file = example("false_alarms.json");
    let cost = |confidence: &str| {
        let answer = place.json(&["matrix", &file, "--confidence", confidence, "--json"]);
        assert_eq!(answer["optimal"], true);
        let mut open = vec![&answer["tree"]];
        while let Some(node) = open.pop() {
            if node["test"].is_string() {
                open.extend([&node["pass"], &node["fail"]]);
            } else if node["state"].is_string() {
                assert!(number(&node["p"]) >= confidence.parse::<f64>().expect("a number") - 1e-9);
            }
        }
        number(&answer["expected_cost"])
    };
    assert!(cost("0.9") < cost("0.99"), "surer answers cost more");
}

#[test]
fn an_optimal_tree_that_is_too_large_is_refused_with_the_limit() {
    let place = Place::new();
    let count = 70;
    let states: Vec<_> = (0..count)
        .map(|i| json!({"id": format!("s{i}"), "p": 1.0 / f64::from(count)}))
        .collect();
    let tests: Vec<_> = (0..count)
        .map(|i| json!({"id": format!("t{i}"), "cost": 1}))
        .collect();
    let outcomes: serde_json::Map<_, _> = (0..count)
        .map(|i| (format!("t{i}"), json!({format!("s{i}"): 1})))
        .collect();
    let matrix = json!({"states": states, "tests": tests, "outcomes": outcomes});
    let file = place.write("large.json", &matrix.to_string());
    let optimal = ["matrix", &file, "--tree", "optimal"];
    place
        .ptu(&optimal)
        .exits(2)
        .explains(&["at most 64", "70", "greedy"]);
    let answer = place.json(&["matrix", &file, "--json"]);
    // Each test ends one of n alike: (2 + … + 70) / 70.
    assert!((number(&answer["expected_cost"]) - 2484.0 / 70.0).abs() < 1e-9);
}
