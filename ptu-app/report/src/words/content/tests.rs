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
fn a_message_is_told_with_what_it_holds() {
    let say = |text: &str| korean(text).into_owned();
    assert_eq!(
        say("eb_reaction = 500, allowed at most 250 ms"),
        "EB 반응 시간 = 500 (허용 250 ms 이하)"
    );
    assert_eq!(
        say("air_t_3 = 2, allowed 0 to 1 N"),
        "MT 쌍 3 부수차 공기제동 요구값 = 2 (허용 0 ~ 1 N)"
    );
    assert_eq!(
        say("not run, setup: nothing; not run, the bench"),
        "시험 안 함: 준비: nothing; 시험 안 함: the bench"
    );
    assert_eq!(
        say("atp/overspeed: code 25: alarm, FSB, EB failed (under this fault 100 %, healthy 0 %)"),
        "atp/overspeed: 속도 코드 25: 경보, FSB, EB 작동: 불합격 (이 고장일 때 100 %, 정상일 때 0 %)"
    );
    assert_eq!(
        say("a step of the depot's own"),
        "a step of the depot's own"
    );
}

#[test]
fn a_condition_is_told_by_the_names_of_its_signals_and_their_states() {
    let say = |text: &str| korean(text).into_owned();
    assert_eq!(
        say("eb = applied did not come within 5 s"),
        "5 s 이내에 성립하지 않음: 비상제동(EB) = 체결"
    );
    assert_eq!(
        say("(fsb = applied or (limit ≤ 25 km/h and hcr = off)) came true"),
        "성립해서는 안 되는 조건이 성립함: (상용전제동(FSB) 요구 = 체결 또는 \
         (적용 중인 제한 속도 ≤ 25 km/h 그리고 현 운전실의 전두계전기(HCR) = 꺼짐))"
    );
    assert_eq!(
        say("released: no value, eb = released did not come about in time"),
        "완해 시간: 값 없음, 시간 안에 성립하지 않음: 비상제동(EB) = 완해"
    );
    assert_eq!(say("no data for eb"), "비상제동(EB) 데이터 없음");
    assert_eq!(
        say("the unit logged marker_missing (301), which no step provoked"),
        "장치 고장 기록: 마커 누락 (301) (어느 단계에서도 유발하지 않음)"
    );
    assert_eq!(
        say("(eb or nothing) came true"),
        "성립해서는 안 되는 조건이 성립함: (eb or nothing)"
    );
}

/// Goal: no text is shown with a number lost or made up, and no entry is there twice.
#[test]
fn both_languages_have_the_same_numbers_and_places() {
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
    let mut known = BTreeSet::new();
    for [english, korean] in file().messages {
        let mut places: Vec<_> = Pattern::new(&english, String::new()).places;
        let mut of_korean = Pattern::new(&korean, String::new()).places;
        places.sort();
        of_korean.sort();
        assert_eq!(places, of_korean, "{english}");
        assert!(known.insert(english.clone()), "{english} twice");
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
