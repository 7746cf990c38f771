use btu_rig::procedure::plan::{Comparison, Operand};
use protocol::Duration;
use protocol::signal::Signal;

use super::*;

fn compare(signal: Signal, comparison: Comparison, operand: f64) -> Condition {
    Condition::Compare {
        signal,
        comparison,
        operand: Operand::Literal(operand),
    }
}

fn missed(name: &str, value: f64, limits: [Option<f64>; 2], unit: &str) -> Finding {
    Finding::LimitMissed(LimitMissed {
        measurement: name.into(),
        value,
        uncertainty: None,
        low: limits[0],
        high: limits[1],
        unit: unit.into(),
    })
}

#[test]
fn a_value_beyond_its_limits_is_told_with_these() {
    let late = missed("eb_reaction", 500.0, [None, Some(250.0)], "ms");
    assert_eq!(korean(&late), "EB 반응 시간 = 500 (허용 250 ms 이하)");
    let force = missed("air_t_3", 2.0, [Some(0.0), Some(1.0)], "N");
    let said = "MT 쌍 3 부수차 공기제동 요구값 = 2 (허용 0 ~ 1 N)";
    assert_eq!(korean(&force), said);
    let count = missed("received", 3.0, [Some(7.0), None], "");
    assert!(
        korean(&count).ends_with(" = 3 (허용 7 이상)"),
        "{}",
        korean(&count)
    );
}

#[test]
fn a_condition_is_told_by_the_names_of_its_signals_and_their_states() {
    let eb = || compare(Signal::Eb, Comparison::Equal, 1.0);
    let never = Finding::NeverBecame {
        condition: eb(),
        within: Duration::from_ms(5_000),
        seen: None,
        missing: None,
        said: None,
    };
    assert_eq!(
        korean(&never),
        "5.000 s 이내에 성립하지 않음: 비상제동(EB) = 체결"
    );
    let condition = Condition::Any(vec![
        compare(Signal::Fsb, Comparison::Equal, 1.0),
        Condition::All(vec![
            compare(Signal::Limit, Comparison::AtMost, 25.0),
            compare(Signal::Hcr, Comparison::Equal, 0.0),
        ]),
    ]);
    assert_eq!(
        korean(&Finding::CameTrue { condition }),
        "성립해서는 안 되는 조건이 성립함: (상용전제동(FSB) 요구 = 체결 또는 \
         (적용 중인 제한 속도 ≤ 25 km/h 그리고 현 운전실의 전두계전기(HCR) = 꺼짐))"
    );
    let no_value = Finding::NoValue {
        measurement: "released".into(),
        others: 0,
        why: WhyNoValue::NeverEnded(compare(Signal::Eb, Comparison::Equal, 0.0)),
    };
    assert_eq!(
        korean(&no_value),
        "완해 시간: 값 없음, 시간 안에 성립하지 않음: 비상제동(EB) = 완해"
    );
    let unknown = Finding::ConditionUnknown {
        missing: MissingData::Signal(Signal::Eb),
    };
    assert_eq!(korean(&unknown), "시험 조건: 비상제동(EB) 데이터 없음");
}

#[test]
fn what_came_more_than_once_is_counted_and_what_is_in_another_is_told() {
    let event = LoggedEvent {
        source: EventSource::Unit,
        code: 301,
        parameter: 0,
    };
    let mut all = Findings::default();
    all.add(Finding::Unprovoked(event), 2);
    all.add(
        Finding::InSetUp(Box::new(Finding::NeedsHarness)).not_run(),
        1,
    );
    assert_eq!(
        findings(&all),
        "장치 고장 기록: 마커 누락 (301) (어느 단계에서도 유발하지 않음) (2회); \
         시험 안 함: 준비: 시험대 하네스가 필요하며, 정비 포트만 연결되어 있음"
    );
    let stored = Findings::from_json(&all.to_json().expect("stored"));
    assert_eq!(stored, Some(all));
}

/// Goal: what others do to a unit on a train is told in Korean with its reason. Method: each reason a unit gives.
#[test]
fn the_end_of_test_mode_is_told_with_its_reason() {
    for (refusal, label) in (0..).zip(ArmRefusal::LABELS) {
        let said = korean(&Finding::TestModeEnded { refusal });
        assert!(!said.contains(label), "{said}");
    }
    assert!(korean(&Finding::TestModeEnded { refusal: 9 }).ends_with(": 차량 이동"));
}
