//! What an adaptive run promises: few steps where a part has failed, no unit called healthy that was not looked at, and no
//! more time than the checks take.

use std::collections::BTreeMap;

use diagnosis::{Assessment, Finding, Model, Observation, Strategy, suite_s};

use super::{dictionary, mode, run, settings};

/// What the strategy would do, and what it would see, on a run that was made in full; with the time that it takes, s.
fn replayed(model: &Model<'_>, run: &Observation) -> (f64, Observation) {
    let mut strategy = Strategy::new(model, None);
    let mut seen = Observation::default();
    while let Some(next) = strategy.begin() {
        let mut steps = run.steps.iter();
        let left = steps.any(|step| {
            if step.check.procedure != next.procedure {
                return false;
            }
            if !seen.steps.contains(step) {
                seen.steps.push(step.clone());
            }
            !strategy.saw(step)
        });
        if !left {
            strategy.ended(&next.procedure);
        }
    }
    (strategy.time_s(), seen)
}

#[test]
fn the_strategy_needs_less_time_than_the_suite() {
    let dictionary = dictionary();
    let settings = settings();
    let model = Model::new(&dictionary, &settings, &BTreeMap::new());
    for (fails, t, part) in [
        (vec!["a.s1"], Some(643.0), "relay"),
        (vec!["a.s2", "b.s1"], Some(240.0), "sensor"),
        (vec!["b.s1", "c.s1"], Some(240.0), "antenna"),
    ] {
        let (time_s, seen) = replayed(&model, &run(&fails, t));
        let named = Assessment::of(&model, &seen).diagnosis().conclusion.parts();
        assert!(
            named.iter().any(|named| *named == part),
            "{part}: {named:?}"
        );
        let all_s = suite_s(&model, None);
        assert!(time_s < 0.8 * all_s, "{part}: {time_s} of {all_s} s");
    }
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
        let (_, seen) = replayed(&model, &run(&[], Some(240.0)));
        let found = Assessment::of(&model, &seen).diagnosis();
        assert_eq!(found.conclusion.finding(), Finding::NoFault);
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
    let all_s = suite_s(&model, None);
    for fails in [&["b.s2"][..], &["a.s1", "b.s3"], &["c.s1", "b.s1"], &[]] {
        let (time_s, _) = replayed(&model, &run(fails, Some(240.0)));
        assert!(time_s <= all_s, "{fails:?}: {time_s} s of {all_s}");
    }
}
