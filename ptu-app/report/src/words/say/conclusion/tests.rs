use diagnosis::{CheckName, PartProbability};

use super::*;

/// A sentence is for reading: three parts of five are named, the rest counted.
#[test]
fn no_more_parts_are_named_than_a_person_can_choose_from() {
    let part = |name: &&str| PartProbability {
        lru: name.parse().expect("a part"),
        probability: 0.2,
    };
    let likely = ["a", "b", "c", "d", "e"].iter().map(part).collect();
    let [english, korean] = concluded(&Conclusion::CannotTell { likely }, None, &[]);
    assert!(
        english.contains("c (20.0 %) or one of 2 more;"),
        "{english}"
    );
    assert!(korean.contains("c (20.0 %) 외 2개;"), "{korean}");
    assert!(!english.contains("d (") && !korean.contains("d ("));
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
    let two = Conclusion::TwoFound {
        parts: [id("speed_sensor_1"), id("master_controller")],
        probability: 0.96,
    };
    let [english, korean] = concluded(&two, None, &names);
    let said = "perhaps two faults (96.0 %): replace speed sensor 1 (speed_sensor_1) and run again what failed; the master controller (master_controller) if something still fails";
    assert_eq!(english, said);
    let said = "복합 고장 추정 (96.0 %): 속도센서 1 (speed_sensor_1) 교체 후 불합격 항목을 다시 시험하고, 다시 불합격하면 주간제어기 (master_controller) 교체";
    assert_eq!(korean, said);
    assert_eq!(found("relay", &names)[0], "replace relay (99.6 %)");
}

/// Where parts cannot be told apart, the sentence names all of them, and the measurement that tells.
#[test]
fn parts_that_are_not_told_apart_are_named_with_the_measurement() {
    let id = |id: &str| id.parse::<LruId>().expect("a part");
    let measure = || diagnosis::Measure {
        english: "record the frames".into(),
        korean: "전문을 기록합니다".into(),
    };
    let cause = || diagnosis::Shared {
        part: id("link"),
        reaches: vec![id("sensor"), id("relay")],
        measure: measure(),
    };
    let group = diagnosis::Group {
        parts: vec![id("sensor"), id("relay")],
        measure: measure(),
    };
    let probability = 0.9;
    let all = [
        (
            Conclusion::OneOf { group, probability },
            "sensor or relay (90.0 %); to tell which, record the frames",
            "sensor 또는 relay (90.0 %); 판별 방법: 전문을 기록합니다",
        ),
        (
            Conclusion::Common {
                cause: cause(),
                parts: [id("sensor"), id("relay")],
                probability,
            },
            "one cause at sensor and relay (90.0 %): link, its wiring, or a fault of each; to tell which, record the frames",
            "sensor, relay에 공통된 원인 (90.0 %): link, 배선 또는 각각의 고장; 판별 방법: 전문을 기록합니다",
        ),
        (
            Conclusion::OneOrCommon {
                cause: cause(),
                part: id("relay"),
                probability,
                other: id("sensor"),
            },
            "relay, or one cause at relay and sensor: link or its wiring; to tell which, record the frames",
            "relay 또는 relay, sensor에 공통된 원인: link 또는 배선; 판별 방법: 전문을 기록합니다",
        ),
        (
            Conclusion::NotAlone {
                part: id("relay"),
                probability,
                other: id("antenna"),
            },
            "not certain yet: relay (90.0 %); a sign of a fault in antenna does not come from it",
            "아직 확실하지 않습니다: relay (90.0 %); antenna 고장 징후는 이 고장으로 설명되지 않습니다",
        ),
    ];
    for (conclusion, english, korean) in all {
        assert_eq!(concluded(&conclusion, None, &[]), [english, korean]);
    }
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
