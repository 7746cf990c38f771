//! What an adaptive run promises: few steps where a part has failed, no unit called healthy that was not looked at, and no
//! more time than the checks take.

use std::collections::BTreeMap;

use diagnosis::{Assessment, Model, Strategy, fixed_order, replayed};

use super::{dictionary, mode, run, settings};

#[test]
fn the_strategy_needs_fewer_steps_than_the_fixed_order() {
    let dictionary = dictionary();
    let settings = settings();
    let model = Model::new(&dictionary, &settings, &BTreeMap::new());
    let mut sums = [0.0; 2];
    for (fails, t, part) in [
        (vec!["a.s1"], Some(643.0), "relay"),
        (vec!["a.s2", "b.s1"], Some(240.0), "sensor"),
        (vec!["b.s1", "c.s1"], Some(240.0), "antenna"),
    ] {
        let full = run(&fails, t);
        let fixed = fixed_order(&model, &full);
        let (adaptive, seen) = replayed(&model, &full);
        assert_eq!(adaptive.settled, fixed.settled, "{part}");
        let found = Assessment::of(&model, &seen);
        let credible = found.credible_parts(0.9);
        assert!(credible.iter().any(|named| **named == part), "{part}");
        sums[0] += adaptive.time_s;
        sums[1] += fixed.time_s;
    }
    assert!(sums[0] < 0.8 * sums[1], "{sums:?}");
}

/// A procedure that ends before the check asked for must not be begun for ever.
#[test]
fn a_procedure_that_stops_early_ends_the_search() {
    let dictionary = dictionary();
    let settings = settings();
    let model = Model::new(&dictionary, &settings, &BTreeMap::new());
    let mut strategy = Strategy::new(&model, None);
    let mut begun = 0;
    while let Some(next) = strategy.begin() {
        begun += 1;
        assert!(begun <= 3, "asked again for {next}");
        strategy.ended(&next.procedure);
    }
}

/// A guard whose loss one check alone shows: the search ends with no healthy unit before that check was made.
#[test]
fn a_check_that_alone_shows_an_unsafe_mode_is_made_on_a_good_unit() {
    let settings = settings();
    let seen_of = |unsafe_: bool| {
        let mut dictionary = dictionary();
        let guard = diagnosis::ModeName {
            unsafe_,
            ..mode("guard.dead", 1e-6)
        };
        let runs: Vec<_> = (0..5).map(|_| run(&["c.s3"], Some(240.0))).collect();
        dictionary.add(&guard, "nominal".into(), &runs);
        let model = Model::new(&dictionary, &settings, &BTreeMap::new());
        let (effort, seen) = replayed(&model, &run(&[], Some(240.0)));
        assert!(effort.settled);
        seen
    };
    let made = |seen: &diagnosis::Observation| {
        seen.steps
            .iter()
            .any(|step| step.check.step == "s3" && step.check.procedure == "c")
    };
    assert!(made(&seen_of(true)));
    assert!(
        !made(&seen_of(false)),
        "rare and harmless: not worth its time"
    );
}

/// Going to and fro between procedures costs time: all in all no more than each once.
#[test]
fn a_search_takes_no_longer_than_the_suite() {
    let dictionary = dictionary();
    let never_sure = diagnosis::Settings {
        found_at: 1.0,
        healthy_at: 1.0,
        least_gain_bits: 0.0,
        ..settings()
    };
    let model = Model::new(&dictionary, &never_sure, &BTreeMap::new());
    let suite_s = 9.0 * 10.0 + 3.0 * never_sure.bring_up_s;
    for fails in [&["b.s2"][..], &["a.s1", "b.s3"], &["c.s1", "b.s1"], &[]] {
        let (effort, _) = replayed(&model, &run(fails, Some(240.0)));
        assert!(
            effort.time_s <= suite_s,
            "{fails:?}: {} s of {suite_s}",
            effort.time_s
        );
    }
}
