//! Ambiguity groups: one part of a group is named only where what was seen tells it from the others.

use diagnosis::{ConclusionSettings, Group, Measure, Relations, Shared};

use super::*;

fn group(parts: [&str; 2]) -> Group {
    Group {
        parts: parts.map(|part| part.parse().expect("a part")).into(),
        measure: Measure {
            english: "measure between them".into(),
            korean: "그 사이를 측정합니다".into(),
        },
    }
}

fn with_groups(dictionary: &Dictionary, seen: &Observation, groups: &[Group]) -> Diagnosis {
    let settings = Settings {
        found_at: 0.7,
        ..settings()
    };
    let relations = Relations {
        groups: groups.to_vec(),
        ..Relations::default()
    };
    let model = Model::new(dictionary, &settings, &BTreeMap::new()).with_relations(&relations);
    Diagnosis::of(&model, seen)
}

/// Goal: parts that act alike are named together, with what tells which. Method: antenna and cable have the same effect; a
/// group without one of them changes nothing.
#[test]
fn parts_that_act_alike_are_named_together_with_the_measurement() {
    let (dictionary, seen) = (dictionary(), run(&["b.s1", "c.s1"], Some(240.0)));
    let one_of = with_groups(&dictionary, &seen, &[group(["antenna", "cable"])]);
    assert_eq!(one_of.conclusion.finding(), Finding::OneOf);
    let alike = group(["antenna", "cable"]);
    assert_eq!(one_of.conclusion.group(), Some(alike));
    let other = with_groups(&dictionary, &seen, &[group(["antenna", "sensor"])]);
    assert_eq!(
        other.conclusion.finding(),
        Finding::CannotTell,
        "{:?}",
        other.conclusion
    );
    assert_eq!(other.conclusion.group(), None);
}

/// Goal: a fault that acts as it was counted is named alone; the same part is not where its fault acts otherwise, as a fault
/// of another part of the group may. Method: the sensor as counted; then with two more checks that fail.
#[test]
fn one_part_of_a_group_is_named_where_its_fault_acts_as_counted() {
    let dictionary = dictionary();
    let groups = [group(["sensor", "cable"])];
    for (fails, finding) in [
        (&["a.s2", "b.s1"][..], Finding::Found),
        (&["a.s2", "b.s1", "b.s2", "c.s2"], Finding::OneOf),
    ] {
        let seen = run(fails, Some(240.0));
        let alone = with_groups(&dictionary, &seen, &[]);
        assert_eq!(
            alone.conclusion.finding(),
            Finding::Found,
            "{:?}",
            alone.conclusion
        );
        let said = with_groups(&dictionary, &seen, &groups);
        assert_eq!(
            said.conclusion.finding(),
            finding,
            "{fails:?}: {:?}",
            said.conclusion
        );
        assert_eq!(said.lrus, alone.lrus);
    }
}

/// Goal: a sign parts a group where the dictionary says so. Method: two modes of the sensor log that it is dead; then a mode
/// of the cable does, too.
#[test]
fn a_sign_that_only_one_part_of_a_group_shows_names_it() {
    let dead = diagnosis::Sign {
        fault: "tacho_dead".into(),
        lru: protocol::lru::from_stored("sensor"),
    };
    let logged = |fails: &[&str]| {
        let mut run = run(fails, Some(240.0));
        run.steps[1].signs.insert(dead.clone());
        run
    };
    let mut dictionary = dictionary();
    for (id, fails) in [
        ("sensor.loose", ["a.s2", "c.s2"]),
        ("sensor.worn", ["a.s2", "c.s3"]),
    ] {
        dictionary.add(&mode(id, 1.0), "nominal".into(), &vec![logged(&fails); 20]);
    }
    let groups = [group(["sensor", "cable"])];
    let seen = logged(&["a.s2", "c.s2", "c.s3", "b.s2"]);
    let said = with_groups(&dictionary, &seen, &groups);
    assert_eq!(
        said.conclusion.finding(),
        Finding::Found,
        "{:?}",
        said.conclusion
    );
    dictionary.add(
        &mode("cable.worn", 1.0),
        "nominal".into(),
        &vec![logged(&["b.s1", "a.s3"]); 20],
    );
    let said = with_groups(&dictionary, &seen, &groups);
    assert_eq!(
        said.conclusion.finding(),
        Finding::OneOf,
        "{:?}",
        said.conclusion
    );
}

/// Goal: a part of the unit and the part of the bench that feeds it are named together, though the run is as counted under
/// one of them, unless a step that judges the part failed without the bench. Method: the sensor as counted, whose cable is
/// the bench's; then no part of the bench is likely enough to be named; then the script of a step without the bench
/// suspects the sensor.
#[test]
fn a_part_of_the_bench_is_told_from_the_units_by_a_step_without_the_bench_alone() {
    let mut dictionary = dictionary();
    let seen = run(&["a.s2", "b.s1"], Some(240.0));
    let named_at = |named_at| Settings {
        found_at: 0.7,
        conclusion: ConclusionSettings {
            named_at,
            ..ConclusionSettings::default()
        },
        ..settings()
    };
    let (any, likely) = (named_at(0.0), named_at(0.5));
    let relations = Relations {
        groups: vec![group(["sensor", "cable"])],
        of_bench: ["cable".parse().expect("a part")].into(),
        without_bench: vec!["b".into()],
        ..Relations::default()
    };
    let finding = |dictionary: &Dictionary, settings: &Settings| {
        let model = Model::new(dictionary, settings, &BTreeMap::new()).with_relations(&relations);
        Diagnosis::of(&model, &seen).conclusion.finding()
    };
    assert_eq!(finding(&dictionary, &any), Finding::OneOf);
    assert_eq!(finding(&dictionary, &likely), Finding::Found);
    let judges = |check: &CheckName| {
        let judged = check.procedure == "b" && check.step == "s1";
        judged.then(|| "sensor".parse().expect("a part"))
    };
    dictionary.suspects = dictionary.checks.iter().map(judges).collect();
    assert_eq!(finding(&dictionary, &any), Finding::Found);
}

/// Goal: two parts that are found to have failed and share something are told as one cause, with what they share; one alone
/// is not. Method: what the relay and the antenna show at once, in a unit where a supply reaches both; then the relay's.
#[test]
fn one_cause_at_two_parts_is_told_with_what_they_share() {
    let dictionary = dictionary();
    let part = |name: &str| name.parse().expect("a part");
    let shared = |name: &str, reaches: [&str; 2]| Shared {
        part: part(name),
        reaches: reaches.map(part).into(),
        measure: Measure {
            english: "record the voltage".into(),
            korean: "전압을 기록합니다".into(),
        },
    };
    let relations = Relations {
        shared: vec![
            shared("link", ["sensor", "relay"]),
            shared("supply", ["antenna", "relay"]),
        ],
        ..Relations::default()
    };
    let settings = Settings {
        found_at: 0.7,
        common_cause: 0.1,
        ..settings()
    };
    let mut seen = run(&["a.s1", "b.s1", "c.s1"], Some(640.0));
    // Only the antenna is named in the log.
    seen.steps[3].signs.insert(diagnosis::Sign {
        fault: "silent".into(),
        lru: protocol::lru::from_stored("antenna"),
    });
    let mut dictionary = dictionary;
    dictionary.modes.retain(|mode| mode.name.id != "cable.open");
    let model = Model::new(&dictionary, &settings, &BTreeMap::new()).with_relations(&relations);
    let one = Diagnosis::of(&model, &run(&["a.s1"], Some(640.0)));
    assert_eq!(
        one.conclusion.finding(),
        Finding::Found,
        "{:?}",
        one.conclusion
    );
    let both = Diagnosis::of(&model, &seen);
    assert_eq!(
        both.conclusion.finding(),
        Finding::OneOf,
        "{:?}",
        both.conclusion
    );
    let group = both.conclusion.group().expect("a group");
    assert_eq!(group.parts, ["supply", "antenna", "relay"].map(part));
    let said = &both.conclusion;
    let is_common = matches!(said, Conclusion::Common { parts, .. } if *parts == ["antenna", "relay"].map(part));
    assert!(is_common, "{said:?}");
}

/// Goal: a part is not named for certain where a sign names another that its fault does not show: what both share may be
/// the cause, or it is not certain. Method: the relay as counted, beside a sign of a part that shares a link with it; of one
/// that does not; and of the relay itself.
#[test]
fn a_sign_of_another_part_keeps_a_part_from_being_named_for_certain() {
    let dictionary = dictionary();
    let part = |name: &str| name.parse().expect("a part");
    let relations = Relations {
        shared: vec![Shared {
            part: part("link"),
            reaches: ["sensor", "relay"].map(part).into(),
            measure: Measure {
                english: "record the frames".into(),
                korean: "전문을 기록합니다".into(),
            },
        }],
        ..Relations::default()
    };
    let mut settings = settings();
    settings.signs.of_other_part = 0.3;
    settings.found_at = 0.9;
    let model = Model::new(&dictionary, &settings, &BTreeMap::new()).with_relations(&relations);
    let with_sign_of = |lru: &str| {
        let mut seen = run(&["a.s1"], Some(640.0));
        seen.steps[4].signs.insert(diagnosis::Sign {
            fault: "silent".into(),
            lru: protocol::lru::from_stored(lru),
        });
        Diagnosis::of(&model, &seen)
    };
    let shared = with_sign_of("sensor");
    let said = &shared.conclusion;
    assert_eq!(said.finding(), Finding::OneOf, "{said:?}");
    let group = shared.conclusion.group().expect("a group");
    assert_eq!(group.parts, ["link", "relay", "sensor"].map(part));
    let is_one = matches!(said, Conclusion::OneOrCommon { part, other, .. } if *part == "relay" && *other == "sensor");
    assert!(is_one, "{said:?}");
    let apart = with_sign_of("antenna");
    let said = &apart.conclusion;
    assert_eq!(apart.conclusion.finding(), Finding::CannotTell, "{said:?}");
    assert_eq!(apart.lrus[0].lru, "relay");
    let names_other = matches!(said, Conclusion::NotAlone { other, .. } if *other == "antenna");
    assert!(names_other, "{said:?}");
    assert_eq!(with_sign_of("relay").conclusion.finding(), Finding::Found);
}
