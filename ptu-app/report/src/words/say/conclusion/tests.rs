use diagnosis::{CheckName, PartProbability};

use super::*;

/// A sentence is for reading: three parts of five are named, the rest counted.
#[test]
fn no_more_parts_are_named_than_a_person_can_choose_from() {
    let part = |name: &&str| PartProbability {
        lru: name.parse().expect("a part"),
        probability: 0.2,
    };
    let likely: Vec<_> = ["a", "b", "c", "d", "e"].iter().map(part).collect();
    let cannot_tell = |is_unlike_any| Conclusion::CannotTell {
        likely: likely.clone(),
        is_unlike_any,
    };
    let [english, korean] = concluded(&cannot_tell(false), None, &[]);
    assert!(
        english.contains("c (20.0 %) or one of 2 more;"),
        "{english}"
    );
    assert!(korean.contains("c (20.0 %) 외 2개;"), "{korean}");
    assert!(!english.contains("d (") && !korean.contains("d ("));
    let [unlike, unlike_ko] = concluded(&cannot_tell(true), None, &[]);
    let examine = "like no fault that is known: examine cables, connectors and the bench first; ";
    assert_eq!(unlike, format!("{examine}{english}"));
    assert!(unlike_ko.ends_with(&korean), "{unlike_ko}");
}

/// People know a part by its name, commands by its identifier.
#[test]
fn a_part_is_called_by_its_name_with_its_identifier() {
    let known = |id: &str, name: &str, name_ko: &str| Lru {
        id: id.parse().expect("a part"),
        name: name.into(),
        name_ko: name_ko.into(),
        of_bench: false,
    };
    let names = [
        known("eb_relay", "EB relay", "비상제동 계전기"),
        known("speed_sensor_1", "Speed sensor 1", "속도센서 1"),
        known("master_controller", "Master controller", "주간제어기"),
    ];
    let id = |id: &str| id.parse::<LruId>().expect("a part");
    let found = |part: &str, names: &[Lru]| {
        let (part, probability) = (id(part), 0.996);
        concluded(&Conclusion::Found { part, probability }, None, names)
    };
    let [english, korean] = found("eb_relay", &names);
    assert_eq!(english, "replace the EB relay (eb_relay, 99.6 %)");
    assert_eq!(korean, "교체 대상: 비상제동 계전기 (eb_relay, 99.6 %)");
    assert_eq!(found("relay", &names)[0], "replace relay (99.6 %)");
}

/// Where parts cannot be told apart, the sentence names all of them, and the measurement that tells.
#[test]
fn parts_that_are_not_told_apart_are_named_with_the_measurement() {
    let id = |id: &str| id.parse::<LruId>().expect("a part");
    let measure = diagnosis::Measure {
        english: "record the frames".into(),
        korean: "전문을 기록합니다".into(),
    };
    let one_of = |measure| Conclusion::OneOf {
        parts: [("sensor", 0.9), ("relay", 0.05)]
            .map(|(part, probability)| PartProbability {
                lru: id(part),
                probability,
            })
            .into(),
        measure,
    };
    let said = concluded(&one_of(measure), None, &[]);
    let expected = [
        "sensor (90.0 %) or relay (5.0 %); to tell which, record the frames",
        "sensor (90.0 %) 또는 relay (5.0 %); 판별 방법: 전문을 기록합니다",
    ];
    assert_eq!(said, expected);
    let [swapped, _] = concluded(&one_of(diagnosis::Measure::default()), None, &[]);
    let expected = "sensor (90.0 %) or relay (5.0 %); no check tells more: swap sensor and run again what failed";
    assert_eq!(swapped, expected);
    let next = NextCheck {
        check: CheckName {
            procedure: "a/b".into(),
            step: "c".into(),
        },
        gain_bits: 1.0,
        cost_s: 11.2,
        again: true,
        passes_with: vec![id("relay")],
        fails_with: Vec::new(),
    };
    let nothing = Conclusion::NothingSeen { made: 0, of: 40 };
    let [english, korean] = concluded(&nothing, None, &[]);
    assert!(english.starts_with("nothing was tested: none of 40 checks was made"));
    assert!(korean.starts_with("시험한 것이 없습니다"));
    let (made, of) = (3, 40);
    let said = concluded(&Conclusion::NothingSeen { made, of }, Some(&next), &[]);
    let expected = [
        "not enough was run: 3 of 40 checks were made and show nothing wrong; next, run again a/b: c (12 s): it passes if the fault is in relay",
        "시험 범위가 부족하여 판별할 수 없습니다: 점검 40개 중 3개 수행, 이상이 발견되지 않음; 다음 점검: 다시 a/b: c (12초): relay 고장이면 합격합니다",
    ];
    assert_eq!(said, expected);
}
