use std::collections::BTreeSet;

use protocol::injection::FaultCatalogue;
use protocol::signal::Signal;

use super::*;

fn file() -> File {
    toml::from_str(KOREAN).expect("the file that is built in")
}

#[test]
fn numbers_stand_where_the_language_has_them() {
    let said = |wording: &str, text: &str| with_numbers(wording, &without_numbers(text).1);
    assert_eq!(
        without_numbers("code 25 at 3.5 km/h, PSM4, T1, 2nd").0,
        "code # at # km/h, PSM4, T1, 2nd"
    );
    assert_eq!(said("# 다음 #", "a 1 b 2.5"), "1 다음 2.5");
    assert_eq!(said("#2 앞 #1", "a 1 b 2.5"), "2.5 앞 1");
}

#[test]
fn a_text_is_told_in_its_parts_and_without_the_number_of_its_repetition() {
    let say = |text: &str| korean(text).into_owned();
    let step = "code 25: alarm, FSB, EB";
    assert_eq!(say(step), "속도 코드 25: 경보, FSB, EB 작동");
    let repeated = super::super::KOREAN.step(step, [2, 3], fault_db::StepKind::Again);
    assert_eq!(repeated, format!("{} (2/3) (반복)", say(step)));
    assert_eq!(
        say("a step of the depot's own"),
        "a step of the depot's own"
    );
    assert_eq!(say("TWC modem loop-back; x"), "TWC 모뎀 루프백; x");
}

/// Goal: no text is shown with a number lost or made up.
#[test]
fn both_languages_have_the_same_numbers() {
    for (english, korean) in &CONTENT.texts {
        let numbers: Vec<String> = (1..=english.matches('#').count())
            .map(|n| format!("<{n}>"))
            .collect();
        let numbers: Vec<_> = numbers.iter().map(String::as_str).collect();
        let said = with_numbers(korean, &numbers);
        let missing: Vec<_> = numbers
            .iter()
            .filter(|number| said.matches(*number).count() != 1)
            .collect();
        assert!(
            missing.is_empty() && !said.contains('#'),
            "{english}: {korean}"
        );
    }
}

/// Goal: no fault mode and no signal is told in English, and no entry stays behind one that is gone.
#[test]
fn the_fault_modes_and_signals_are_those_of_the_catalogues() {
    let file = file();
    let keys = |texts: &mut dyn Iterator<Item = String>| -> BTreeSet<String> {
        texts.map(|text| without_numbers(&text).0).collect()
    };
    let catalogue = include_str!("../../../../../scripts/units/faults.toml");
    let catalogue = FaultCatalogue::from_toml(catalogue).expect("the one that is delivered");
    let modes = keys(&mut catalogue.faults.iter().map(|mode| mode.mode.clone()));
    assert_eq!(file.modes.into_keys().collect::<BTreeSet<_>>(), modes);
    let signals = keys(
        &mut Signal::ALL
            .iter()
            .map(|signal| signal.definition().doc.to_owned()),
    );
    assert_eq!(file.signals.into_keys().collect::<BTreeSet<_>>(), signals);
}

/// Units and signs are the same in both languages.
#[test]
fn korean_is_korean() {
    for (english, korean) in &CONTENT.texts {
        let mut words = english.split(|c: char| !c.is_ascii_lowercase());
        let is_said = words.any(|word| word.len() > 2);
        let hangul = korean.chars().any(|c| ('가'..='힣').contains(&c));
        assert!(hangul || !is_said, "{english}: {korean}");
    }
}

/// Goal: what an event of a log says besides its text is told in Korean. Method: all events, with every code and bit.
#[test]
fn parameters_of_events_are_korean() {
    let numbers = (0..20).chain((5..16).map(|bit| 1 << bit));
    for (event, number) in Event::ALL
        .iter()
        .flat_map(|event| numbers.clone().map(move |number| (*event, number)))
    {
        let said = super::super::KOREAN.parameter(event, number);
        let mut words = said.split(|c: char| !c.is_ascii_lowercase());
        assert_eq!(
            words.find(|word| word.len() > 2),
            None,
            "{event:?} {number}: {said}"
        );
    }
}

#[test]
fn every_input_of_the_unit_that_a_bench_file_places_is_named() {
    let is_named = |name: &str| CONTENT.texts.contains_key(name);
    let inputs = ptu_runs::places::UnitInput::ALL.iter();
    let missing: Vec<_> = inputs.filter(|input| !is_named(input.name())).collect();
    assert!(
        missing.is_empty(),
        "not in scripts/korean.toml: {missing:?}"
    );
    assert_eq!(korean("reverser to -1"), "역전기 후진 위치로");
}
