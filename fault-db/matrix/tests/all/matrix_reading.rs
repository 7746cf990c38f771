//! Reading matrices and outcomes: what is wrong is named, and nothing that is read makes a panic.

use ::matrix::{Matrix, Outcome, PlanOptions, Posterior, plan, read_outcomes};
use proptest::prelude::*;

const STATES: &str = r#"[{"id":"a","p":0.5},{"id":"b","p":0.5}]"#;
const TESTS: &str = r#"[{"id":"t","cost":2}]"#;
const OUTCOMES: &str = r#"{"t":{"a":1}}"#;

fn file(states: &str, tests: &str, outcomes: &str) -> String {
    format!(r#"{{"states":{states},"tests":{tests},"outcomes":{outcomes}}}"#)
}

#[track_caller]
fn refused(text: &str, words: &[&str]) {
    let error = Matrix::from_json(text).expect_err(text).to_string();
    for word in words {
        assert!(error.contains(word), "\"{word}\" is not in \"{error}\"");
    }
}

#[test]
fn a_matrix_is_read_with_nought_for_what_is_not_there() {
    let matrix = Matrix::from_json(&file(STATES, TESTS, OUTCOMES)).expect("valid");
    assert_eq!(matrix.row(0), [1.0]);
    assert_eq!(matrix.row(1), [0.0]);
    assert!(matrix.is_crisp());
    let known = Posterior::prior(&matrix);
    let made = plan(&matrix, &known, PlanOptions::default()).expect("a plan");
    let text = made.to_json(&matrix, &known).expect("JSON");
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(value["expected_cost"], 2.0);
    assert_eq!(value["next_test"], "t");
    assert_eq!(value["tree"]["fail"]["state"], "a");
    assert_eq!(value["tree"]["pass"]["state"], "b");
}

#[test]
fn names_are_quoted_where_json_wants_it() {
    let states = r#"[{"id":"a \"1\"\n","p":0.5},{"id":"가","p":0.5}]"#;
    let text = file(states, TESTS, r#"{"t":{"a \"1\"\n":1}}"#);
    let matrix = Matrix::from_json(&text).expect("valid");
    let known = Posterior::prior(&matrix);
    let made = plan(&matrix, &known, PlanOptions::default()).expect("a plan");
    let text = made.to_json(&matrix, &known).expect("JSON");
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(value["tree"]["fail"]["state"], "a \"1\"\n");
    assert_eq!(value["tree"]["pass"]["state"], "가");
}

#[test]
fn wrong_probabilities_are_named() {
    let states = |a: &str, b: &str| format!(r#"[{{"id":"a","p":{a}}},{{"id":"b","p":{b}}}]"#);
    let read = |a: &str, b: &str, words: &[&str]| {
        refused(&file(&states(a, b), TESTS, OUTCOMES), words);
    };
    read("0.5", "0.6", &["sum to 1.1", "not 1"]);
    read("-0.5", "1.5", &["state \"a\"", "-0.5"]);
    read("1.5", "-0.5", &["state \"a\"", "1.5"]);
    read("NaN", "0.5", &["line 1 column"]);
    read("1e999", "0.5", &["out of range", "line 1"]);
    read("\"half\"", "0.5", &["half", "line 1"]);
    read("null", "0.5", &["null", "line 1"]);
    // Rounded to six digits is near enough.
    assert!(Matrix::from_json(&file(&states("0.333333", "0.666666"), TESTS, OUTCOMES)).is_ok());
}

#[test]
fn wrong_costs_are_named() {
    for cost in ["-1", "0", "-0.0"] {
        let tests = format!(r#"[{{"id":"t","cost":{cost}}}]"#);
        let text = file(STATES, &tests, OUTCOMES);
        refused(&text, &["test \"t\"", "cost", "above 0"]);
    }
    let text = file(STATES, r#"[{"id":"t"}]"#, OUTCOMES);
    refused(&text, &["missing field `cost`", "line 1"]);
}

#[test]
fn wrong_names_and_cells_are_named() {
    let twice = file(
        r#"[{"id":"a","p":0.5},{"id":"a","p":0.5}]"#,
        TESTS,
        OUTCOMES,
    );
    refused(&twice, &["state \"a\" is there twice"]);
    let twice = file(
        STATES,
        r#"[{"id":"t","cost":1},{"id":"t","cost":2}]"#,
        OUTCOMES,
    );
    refused(&twice, &["test \"t\" is there twice"]);
    let nameless = file(STATES, r#"[{"id":"","cost":1}]"#, "{}");
    refused(&nameless, &["empty id"]);
    let read = |outcomes: &str, words: &[&str]| refused(&file(STATES, TESTS, outcomes), words);
    read(r#"{"u":{"a":1}}"#, &["test \"u\""]);
    read(r#"{"t":{"c":1}}"#, &["test \"t\"", "state \"c\""]);
    read(
        r#"{"t":{"a":1,"a":0}}"#,
        &["test \"t\"", "state \"a\" twice"],
    );
    read(r#"{"t":{"a":1},"t":{}}"#, &["test \"t\"", "twice"]);
    read(r#"{"t":{"a":1.5}}"#, &["test \"t\"", "state \"a\"", "1.5"]);
    read(
        r#"{"t":{"a":-0.1}}"#,
        &["test \"t\"", "state \"a\"", "-0.1"],
    );
    read(r#"{"t":[1,0]}"#, &["an object", "line 1"]);
}

#[test]
fn empty_and_broken_files_are_named() {
    refused(&file("[]", TESTS, "{}"), &["\"states\" is empty"]);
    refused(&file(STATES, "[]", "{}"), &["\"tests\" is empty"]);
    refused("", &["line 1 column 0"]);
    refused("{\n\"states\": [\n", &["line 3"]);
    refused("{}", &["missing field"]);
    refused("[]", &["line 1"]);
    refused(
        r#"{"states":[],"states":[]}"#,
        &["duplicate field `states`"],
    );
    refused(&"[".repeat(100_000), &["line 1"]);
}

#[test]
fn outcomes_are_read_in_all_their_words() {
    let found = read_outcomes(r#"{"a":0,"b":1,"c":"pass","d":"fail"}"#).expect("valid");
    let outcomes: Vec<Outcome> = found.into_iter().map(|(_, outcome)| outcome).collect();
    use Outcome::{Fail, Pass};
    assert_eq!(outcomes, [Pass, Fail, Pass, Fail]);
    let error = read_outcomes(r#"{"a":0.5}"#)
        .expect_err("no outcome")
        .to_string();
    assert!(error.contains("\"a\"") && error.contains("0.5"), "{error}");
}

#[test]
fn outcomes_that_no_state_explains_are_refused() {
    let outcomes = r#"{"t":{"a":1},"u":{"a":1}}"#;
    let tests = r#"[{"id":"t","cost":1},{"id":"u","cost":1}]"#;
    let matrix = Matrix::from_json(&file(STATES, tests, outcomes)).expect("valid");
    let given = |text: &str| {
        let outcomes = read_outcomes(text).expect("outcomes");
        Posterior::given(&matrix, &outcomes).map_err(|error| error.to_string())
    };
    let error = given(r#"{"t":1,"u":0}"#).expect_err("contradiction");
    for word in ["contradict", "once \"t\" fails", "\"u\" passes"] {
        assert!(error.contains(word), "{error}");
    }
    let twice = given(r#"{"t":1,"t":0}"#).expect_err("twice");
    assert!(twice.contains("two outcomes"));
    assert!(given(r#"{"v":1}"#).expect_err("unknown").contains("\"v\""));
    assert_eq!(given(r#"{"t":1,"u":1}"#).expect("fits").probability(0), 1.0);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever numbers stand in a file, it is refused or answered.
    #[test]
    fn any_numbers_are_refused_or_answered(
        weights in prop::collection::vec(prop_oneof![0.0..1.0_f64, Just(0.0), -0.1..0.1_f64], 1..6),
        costs in prop::collection::vec(prop_oneof![1e-300..1e300_f64, -1.0..5.0_f64], 1..6),
        cells in prop::collection::vec(
            prop_oneof![Just(0.0), Just(1.0), 0.0..1.0_f64, Just(1e-300), Just(1.0 - 1e-16)], 36),
        found in prop::collection::vec((0..7_usize, any::<bool>()), 0..4),
    ) {
        let total: f64 = weights.iter().sum();
        let states: Vec<_> = weights.iter().enumerate()
            .map(|(i, w)| serde_json::json!({"id": format!("s{i}"), "p": w / total})).collect();
        let tests: Vec<_> = costs.iter().enumerate()
            .map(|(i, cost)| serde_json::json!({"id": format!("t{i}"), "cost": cost})).collect();
        let outcomes: serde_json::Map<_, _> = (0..tests.len()).map(|t| {
            let row: serde_json::Map<_, _> = (0..states.len())
                .map(|s| (format!("s{s}"), serde_json::json!(cells[t * 6 + s]))).collect();
            (format!("t{t}"), row.into())
        }).collect();
        let text = serde_json::json!({"states": states, "tests": tests, "outcomes": outcomes});
        let Ok(matrix) = Matrix::from_json(&text.to_string()) else { return Ok(()); };
        let found: Vec<_> = found.into_iter()
            .map(|(t, failed)| (format!("t{t}"), if failed { Outcome::Fail } else { Outcome::Pass }))
            .collect();
        let Ok(known) = Posterior::given(&matrix, &found) else { return Ok(()); };
        let made = plan(&matrix, &known, PlanOptions::default()).expect("a plan");
        let written = made.to_json(&matrix, &known).expect("JSON");
        let value: serde_json::Value = serde_json::from_str(&written).expect("one JSON document");
        prop_assert!(value["expected_cost"].as_f64().is_some_and(|cost| cost >= 0.0));
        let again = plan(&matrix, &known, PlanOptions::default()).expect("a plan");
        prop_assert_eq!(again, made);
    }

    /// Broken text is refused, whatever it is.
    #[test]
    fn any_text_is_refused_or_read(text in "[\\[\\]{}\",:a-t0-9. e-]{0,60}") {
        let _ = Matrix::from_json(&text);
        let _ = read_outcomes(&text);
    }
}
