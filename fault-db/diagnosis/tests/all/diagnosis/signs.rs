//! Signs: what the unit logs, and what the tester measures.

use diagnosis::Sign;

use super::*;

#[test]
fn a_unit_s_own_log_points_at_a_part_without_any_step() {
    let mut dictionary = Dictionary::new(Basis::default(), vec![1], checks());
    let logged = |signs: &[Sign]| {
        let mut run = run(&[], Some(240.0));
        run.steps[4].signs.extend(signs.iter().cloned());
        vec![run; 5]
    };
    dictionary.set_healthy(&logged(&[]));
    let dead = sign("tacho_dead_1", "sensor");
    let weak = sign("code_lost", "antenna");
    dictionary.add(
        &mode("sensor.dead", 1.0),
        "nominal".into(),
        &logged(std::slice::from_ref(&dead)),
    );
    dictionary.add(
        &mode("antenna.weak", 1.0),
        "nominal".into(),
        &logged(&[weak]),
    );
    let seen = Observation {
        steps: Vec::new(),
        signs: BTreeSet::from([dead]),
        ..Observation::default()
    };
    let found = diagnosed(&dictionary, &seen);
    assert_eq!(top(&found), "sensor.dead", "{:?}", found.conclusion);
}

/// Goal: what the tester measures outweighs checks that end otherwise than counted, as over another wire. Method: a clock
/// whose fault failed c.s1 in the campaign; in the run c.s1 passes and what fails is as of another part, whose sign shows,
/// too. A sign that the unit logs does not decide that.
#[test]
fn what_the_tester_measures_names_the_part() {
    let lost = sign("tacho_dead_1", "sensor");
    let shown = |fails: &[&str], signs: &[&Sign]| {
        let mut run = run(fails, Some(240.0));
        run.steps[3].signs = signs.iter().map(|sign| (*sign).clone()).collect();
        run
    };
    for (fault, decides) in [(diagnosis::CLOCK_WRONG, true), ("clock_told", false)] {
        let clock = sign(fault, "clock");
        let mut dictionary = dictionary();
        let counted = vec![shown(&["c.s1"], &[&clock]); 5];
        dictionary.add(&mode("clock.fast", 1.0), "nominal".into(), &counted);
        let found = diagnosed(&dictionary, &shown(&["a.s2", "b.s1"], &[&clock, &lost]));
        let named =
            |part: &diagnosis::PartProbability| part.lru == "clock" && part.probability > 0.9;
        let said = &found.conclusion;
        assert_eq!(found.parts.iter().any(named), decides, "{fault}: {said:?}");
    }
}

fn sign(fault: &str, lru: &str) -> Sign {
    Sign {
        fault: fault.into(),
        lru: from_stored(lru),
    }
}
