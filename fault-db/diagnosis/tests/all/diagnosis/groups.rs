//! Sets of parts: which parts an answer holds beside the likeliest, and what tells them apart.

use diagnosis::{Conclusion, Group, Measure, Relations, Shared, Sign};

use super::*;

fn measure(what: &str) -> Measure {
    Measure {
        english: what.into(),
        korean: what.into(),
    }
}

fn parts<const N: usize>(names: [&str; N]) -> Vec<LruId> {
    let part = |name: &str| name.parse().expect("a part");
    names.map(part).into()
}

fn said(dictionary: &Dictionary, seen: &Observation, relations: &Relations) -> Diagnosis {
    let settings = Settings {
        counted: CountedSettings::default(),
        ..settings()
    };
    let model = Model::new(dictionary, &settings, &BTreeMap::new()).with_relations(relations);
    Diagnosis::of(&model, seen)
}

fn grouped(names: [&str; 2]) -> Relations {
    let group = Group {
        parts: parts(names),
        measure: measure("measure between them"),
    };
    Relations {
        groups: vec![group],
        ..Relations::default()
    }
}

/// Goal: parts that act alike are named together, with what tells which where that is known. Method: antenna and cable have the
/// same effect; a group of both, and of one with another part.
#[test]
fn parts_that_act_alike_are_named_together_with_the_measurement() {
    let (dictionary, seen) = (dictionary(), run(&["b.s1", "c.s1"], Some(240.0)));
    for (group, told) in [
        (["antenna", "cable"], measure("measure between them")),
        (["antenna", "sensor"], Measure::default()),
    ] {
        let relations = grouped(group);
        let settings = settings();
        let model = Model::new(&dictionary, &settings, &BTreeMap::new()).with_relations(&relations);
        let found = Diagnosis::of(&model, &seen);
        comes_to(&found, Finding::OneOf);
        assert_eq!(found.conclusion.measure(), Some(&told));
        let named: BTreeSet<_> = found.conclusion.parts().into_iter().collect();
        assert_eq!(named, parts(["antenna", "cable"]).into_iter().collect());
    }
}

/// Goal: nothing is certain where the parts that are left have less in all than is asked for. Method: two parts with 98 %.
#[test]
fn few_parts_are_certain_with_enough_in_all_alone() {
    let (dictionary, seen) = (dictionary(), run(&["b.s1", "c.s1"], Some(240.0)));
    for (least_in_all, finding) in [(0.95, Finding::OneOf), (0.99, Finding::CannotTell)] {
        let mut settings = settings();
        settings.conclusion.least_in_all = least_in_all;
        let model = Model::new(&dictionary, &settings, &BTreeMap::new());
        comes_to(&Diagnosis::of(&model, &seen), finding);
    }
}

/// Goal: a part in a row with the likeliest stays in the answer where the run is not as counted. Method: what the sensor
/// fails, with two more checks; the cable is of its group or not.
#[test]
fn a_part_in_a_row_with_the_likeliest_is_named_beside_it() {
    let dictionary = dictionary();
    let seen = run(&["a.s2", "b.s1", "b.s2", "c.s2"], Some(240.0));
    let of = |relations: &Relations| {
        let found = said(&dictionary, &seen, relations).parts;
        let cable = found.iter().find(|part| part.lru == "cable");
        assert_eq!(found[0].lru, "sensor");
        cable.map_or(0.0, |part| part.probability)
    };
    let (near, far) = (of(&grouped(["sensor", "cable"])), of(&Relations::default()));
    assert!(near > 2.0 * far, "{near} against {far}");
}

/// Goal: what two parts share is named where signs name both of them, and where effects of both explain the run. Method: a
/// supply that reaches relay and antenna; a relay that fails alone, with signs of both, and with the antenna's checks.
#[test]
fn what_two_parts_share_is_named_where_both_are_wrong() {
    let mut dictionary = dictionary();
    dictionary.parts = parts(["supply"]);
    let shared = Shared {
        part: "supply".parse().expect("a part"),
        reaches: parts(["antenna", "relay"]),
        measure: measure("record the voltage"),
    };
    let relations = Relations {
        shared: vec![shared],
        ..Relations::default()
    };
    let supply = |fails: &[&str], named: &[&str]| {
        let mut seen = run(fails, Some(640.0));
        seen.steps[4].signs = named.iter().map(|part| sign_of(part)).collect();
        let found = said(&dictionary, &seen, &relations);
        let supply = found.parts.iter().find(|part| part.lru == "supply");
        supply.map_or(0.0, |part| part.probability)
    };
    let alone = supply(&["a.s1"], &[]);
    for (fails, named) in [
        (&["a.s1"][..], &["relay", "antenna"][..]),
        (&["a.s1", "b.s1", "c.s1"], &[]),
    ] {
        let both = supply(fails, named);
        assert!(
            both > 2.0 * alone,
            "{fails:?} {named:?}: {both}, {alone} alone"
        );
    }
    let one = supply(&["a.s1"], &["relay"]);
    assert!(one <= alone, "{one}, {alone} alone");
}

fn sign_of(part: &str) -> Sign {
    Sign {
        fault: "silent".into(),
        lru: from_stored(part),
    }
}

/// Goal: what comes from the bench cannot tell the bench from the part that it reaches. Method: the relay's fault as counted,
/// with the bench's input in a group with the relay: beside the relay where no trace was held against a sound unit, or one
/// deviates at what the bench reads, or at what is made of that; not where traces deviate at what else the unit makes, or at what
/// is made of what the bench gives to another part, or a check without the bench fails.
#[test]
fn a_part_of_the_bench_stays_in_the_answer_unless_something_speaks_against_it() {
    let mut dictionary = dictionary();
    dictionary.parts = parts(["bench"]);
    dictionary.suspects = dictionary
        .checks
        .iter()
        .map(|_| from_stored("relay"))
        .collect();
    let made = [
        ("contact", parts(["bench", "relay"])),
        ("order", parts(["relay"])),
        ("elsewhere", parts(["bench"])),
    ];
    let made = made.map(|(signal, by)| (signal.to_owned(), by.into_iter().collect()));
    let relations = |without_bench: &[&str]| Relations {
        of_bench: parts(["bench"]).into_iter().collect(),
        without_bench: without_bench
            .iter()
            .map(|name| (*name).to_owned())
            .collect(),
        makers: made.clone().into(),
        on_the_way: BTreeMap::from(
            [("use", "contact"), ("other", "elsewhere")]
                .map(|(signal, from)| (signal.to_owned(), [from.to_owned()].into())),
        ),
        ..grouped(["bench", "relay"])
    };
    let named = |deviates: &[&str], without_bench: &[&str]| {
        let mut seen = run(&["a.s1"], Some(640.0));
        seen.residuals = deviates.iter().map(|signal| (*signal).to_owned()).collect();
        let (settings, relations) = (settings(), relations(without_bench));
        let model = Model::new(&dictionary, &settings, &BTreeMap::new()).with_relations(&relations);
        Diagnosis::of(&model, &seen).conclusion.parts()
    };
    let (both, relay) = (parts(["relay", "bench"]), parts(["relay"]));
    assert_eq!(named(&[], &[]), both);
    assert_eq!(named(&["contact"], &["b"]), both);
    assert_eq!(named(&["use"], &[]), both);
    assert_eq!(named(&["order"], &[]), relay);
    assert_eq!(named(&["other"], &[]), relay);
    assert_eq!(named(&["contact"], &["a"]), relay);
}

/// Goal: what lasts speaks once against a fault that was counted, however often its check is made. Method: a run that fits no
/// mode, and the same with one of its failed checks made five times more.
#[test]
fn a_check_made_again_speaks_once_against_what_was_counted() {
    let (dictionary, relations) = (dictionary(), Relations::default());
    let mut seen = run(&["a.s2", "b.s1", "b.s2", "c.s2"], Some(240.0));
    let first = |seen: &Observation| said(&dictionary, seen, &relations).parts[0].clone();
    let once = first(&seen);
    let failed = seen.steps.iter().find(|step| step.check == name("c", "s2"));
    let failed = failed.cloned().expect("c.s2");
    seen.steps.extend(std::iter::repeat_n(failed, 5));
    let often = first(&seen);
    assert_eq!(once.lru, often.lru);
    let apart = (once.probability - often.probability).abs();
    assert!(apart < 0.01, "{once:?}, {often:?}");
}

/// Goal: a dictionary that knows parts and no fault of them gives probabilities. Method: all checks fail.
#[test]
fn parts_without_modes_have_probabilities() {
    let known = dictionary();
    let mut dictionary = Dictionary::new(Basis::default(), vec![1], known.checks.clone());
    dictionary.parts = parts(["relay", "antenna"]);
    let seen = run(&["a.s1", "b.s1", "c.s1"], Some(240.0));
    let found = said(&dictionary, &seen, &Relations::default());
    let all: f64 = found.parts.iter().map(|part| part.probability).sum();
    assert!((all + found.no_fault - 1.0).abs() < 1e-9, "{found:?}");
    assert!(found.next_check.is_none(), "{found:?}");
}

/// Goal: a run under no counted fault is told so. Method: all checks fail, with a sign that no fault shows.
#[test]
fn a_run_like_no_counted_fault_is_told_so() {
    let names: Vec<String> = checks()
        .iter()
        .map(|check| format!("{}.{}", check.procedure, check.step))
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let is_unlike = |fails: &[&str], sign: bool| {
        let mut seen = run(fails, Some(900.0));
        seen.steps[4].signs = sign.then(|| sign_of("antenna")).into_iter().collect();
        let conclusion = ConclusionSettings {
            unlike_any: 0.3,
            most_of_set: 1,
            ..ConclusionSettings::default()
        };
        let settings = Settings {
            conclusion,
            counted: CountedSettings::default(),
            ..settings()
        };
        let dictionary = dictionary();
        let model = Model::new(&dictionary, &settings, &BTreeMap::new());
        let found = Diagnosis::of(&model, &seen);
        match found.conclusion {
            Conclusion::CannotTell { is_unlike_any, .. } => is_unlike_any,
            _ => false,
        }
    };
    assert!(is_unlike(&names, true));
    assert!(!is_unlike(&["b.s1", "c.s1"], false));
}
