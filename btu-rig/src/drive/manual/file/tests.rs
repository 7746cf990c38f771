//! Sequence files: what is read, written back and refused.

use super::*;
use crate::drive::manual::keys::{names, stimulus, toml};
use crate::drive::manual::words;
use crate::lever::Lever;
use crate::stimulus::{CutOut, Stimulus};

const GOOD: &str = r#"title = "one \"stop\""
load = "full"
code = "75"

[[steps]]
after_s = 1
lever = "P4"

[[steps]]
at_kmh = 40.5
regeneration = false
brake_cut_out = 4
lever = "b7"

[[steps]]
at_standstill = true
emergency_button_2 = true
"#;

#[test]
fn a_file_is_read_and_written_back() {
    let sequence = Sequence::from_toml(GOOD).unwrap();
    assert_eq!(sequence.load, Load::Full);
    let steps: Vec<_> = sequence.steps.iter().map(|s| (s.line, s.when)).collect();
    assert_eq!(
        steps,
        [
            (5, When::After(1.0)),
            (9, When::AtKmh(40.5)),
            (15, When::AtStandstill)
        ]
    );
    let found: Vec<_> = sequence.steps[1].actions.iter().map(words).collect();
    assert_eq!(
        found,
        ["brake of car 4 cut out", "regeneration cut-out", "B7"]
    );
    let mut again = Sequence::from_toml(&sequence.to_toml()).unwrap();
    for (step, before) in again.steps.iter_mut().zip(&sequence.steps) {
        step.line = before.line;
    }
    assert_eq!(again, sequence);
}

/// Every action is written with a key that is read again as the same.
#[test]
fn every_action_comes_back_from_its_own_words() {
    let switched: Vec<_> = names()
        .filter_map(|name| stimulus(name, &false.into()).ok())
        .collect();
    assert_eq!(switched.len(), 14, "11 switches, and the doors");
    let levers = Lever::ALL.map(|lever| Stimulus::Controller { lever });
    let reverser = [1, 0, -1].map(|position| Stimulus::Reverser { position });
    let cut = |what, on| Stimulus::CutOut { what, car: 3, on };
    let others = [
        Stimulus::Doors { closed: false },
        cut(CutOut::Brake, true),
        cut(CutOut::Brake, false),
        cut(CutOut::Inverter, true),
        cut(CutOut::Inverter, false),
    ];
    for action in (switched.into_iter().chain(levers).chain(reverser)).chain(others) {
        let text = format!(
            "title = \"x\"\n[[steps]]\nafter_s = 0\n{}\n",
            toml(&action).unwrap()
        );
        let sequence = Sequence::from_toml(&text).unwrap();
        assert_eq!(sequence.steps[0].actions, [action], "{text}");
    }
}

#[test]
fn an_error_names_its_line() {
    let replaced = |from: &str, to: &str| {
        assert!(GOOD.contains(from), "{from}");
        GOOD.replacen(from, to, 1)
    };
    for (text, line, words) in [
        (replaced("\"P4\"", "\"P5\""), 7, "no lever position \"P5\""),
        (replaced("after_s = 1\n", ""), 5, "says not when"),
        (
            replaced("at_kmh = 40.5", "at_kmh = 40.5\nafter_s = 2"),
            9,
            "after_s and at_kmh",
        ),
        (
            replaced("after_s = 1", "after_s = -1"),
            6,
            "after_s = -1 is outside 0 .. 3600",
        ),
        (replaced("after_s = 1", "after_s = nan"), 6, "after_s = NaN"),
        (replaced("40.5", "900"), 10, "at_kmh = 900 is outside"),
        (replaced("40.5", "-3"), 10, "at_kmh = -3 is outside"),
        (
            replaced("at_standstill = true", "at_standstill = false"),
            16,
            "can only be true",
        ),
        (
            replaced("emergency_button_2 = true", ""),
            15,
            "does nothing",
        ),
        (replaced("\"P4\"", "\"N\""), 9, "no step before it powers"),
        (replaced("lever = \"P4\"", "levr = \"P4\""), 7, "levr"),
        (replaced("\"full\"", "\"half\""), 2, "no load \"half\""),
        (replaced("\"full\"", "-4"), 2, "no load \"-4\""),
        (
            replaced("brake_cut_out = 4", "brake_cut_out = 400"),
            12,
            "400",
        ),
        (
            replaced("lever = \"b7\"", "reverser = \"up\""),
            13,
            "\"up\"",
        ),
        (replaced("title", "tilte"), 1, "tilte"),
        ("title = \"x\"\n".into(), 2, "no [[steps]]"),
        ("title = ".into(), 1, ""),
    ] {
        let error = Sequence::from_toml(&text).unwrap_err();
        assert_eq!(error.line, line, "{error}\n{text}");
        assert!(error.to_string().contains(words), "{error}\n{text}");
    }
}

/// A train that stands on a gradient may roll by itself.
#[test]
fn on_a_gradient_a_step_may_wait_for_a_train_nobody_powers() {
    let rolls = "title = \"x\"\ngradient_permille = 35\n[[steps]]\nat_kmh = 3\nlever = \"B7\"\n";
    assert!(Sequence::from_toml(rolls).is_ok());
}

#[test]
fn there_is_an_end_to_steps() {
    let step = "[[steps]]\nafter_s = 0\nlever = \"N\"\n";
    let text = format!("title = \"x\"\n{}", step.repeat(MAX_STEPS + 1));
    let error = Sequence::from_toml(&text).unwrap_err();
    assert_eq!(error.message, format!("more than {MAX_STEPS} steps"));
}
