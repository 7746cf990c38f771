//! What a person is asked to do at a bench, in Korean.

use btu_rig::stimulus::{DoorLine, DoorState, Stimulus, number};

use super::condition;
use ptu_runs::places::UnitInput;
use ptu_runs::words::input;

/// The stimulus as a person does it; one that no person does, in English.
pub fn korean(stimulus: &Stimulus) -> String {
    let side = |left: bool| if left { "왼쪽" } else { "오른쪽" };
    let on_off = |on: bool| if on { "켬" } else { "끔" };
    let is = |what: UnitInput, on| format!("{} {}", input(what), on_off(on));
    match stimulus {
        Stimulus::Doors { closed: true } => "출입문 모두 닫힘".to_owned(),
        Stimulus::Doors { closed: false } => "출입문 모두 열림".to_owned(),
        Stimulus::SideDoors { left, state } => {
            let state = match state {
                DoorState::Open => "열림",
                DoorState::Unlocked => "닫힘, 잠기지 않음",
                DoorState::Locked => "닫힘",
            };
            format!("{} 출입문 {state}", side(*left))
        }
        Stimulus::DoorsFollow { on: true } => "출입문을 장치의 지령대로 조작".to_owned(),
        Stimulus::DoorsFollow { on: false } => "출입문을 그대로 둠".to_owned(),
        Stimulus::DoorObstacle { left, times: 0 } => {
            format!("{} 출입문의 장애물 제거", side(*left))
        }
        Stimulus::DoorObstacle { left, times } => {
            format!("{} 출입문에 장애물, 닫힘 {times}회 동안", side(*left))
        }
        Stimulus::DoorLine { line, on } => {
            let line = input(match line {
                DoorLine::All => UnitInput::DoorsClosed,
                DoorLine::LeftClosed => UnitInput::LeftClosed,
                DoorLine::LeftLocked => UnitInput::LeftLocked,
                DoorLine::RightClosed => UnitInput::RightClosed,
                DoorLine::RightLocked => UnitInput::RightLocked,
                DoorLine::BySide => UnitInput::DoorsBySide,
            });
            match on {
                None => format!("{line} 인통선: 출입문 상태대로"),
                Some(on) => format!("{line} 인통선 {}", if *on { "가압" } else { "무가압" }),
            }
        }
        Stimulus::Hcr { on } => is(UnitInput::Hcr, *on),
        Stimulus::MaintenanceKey { on } => is(UnitInput::MaintenanceKey, *on),
        Stimulus::TrainNumber { number: 0 } => "열차 번호를 설정값으로".to_owned(),
        Stimulus::TrainNumber { number } => format!("열차 번호 {number} 입력"),
        Stimulus::WheelDiameter { diameter_mm } if *diameter_mm == 0.0 => {
            "차륜 직경을 설정값으로".to_owned()
        }
        Stimulus::WheelDiameter { diameter_mm } => {
            format!("차륜 직경 {} mm 입력", number(*diameter_mm))
        }
        Stimulus::ModeSwitch(mode) => {
            let label = mode.label();
            let mode = condition::state("mode_switch", label).unwrap_or_else(|| label.to_owned());
            format!("모드 스위치: {mode}")
        }
        Stimulus::Controller { lever } => format!("주간제어기: {lever}"),
        Stimulus::ControllerVolts { volts: None } => "주간제어기 전압: 위치대로".to_owned(),
        Stimulus::ControllerVolts { volts: Some(volts) } => {
            format!("주간제어기 전압 {} V", number(*volts))
        }
        Stimulus::ControllerContacts { contacts: None } => "주간제어기 접점: 위치대로".to_owned(),
        Stimulus::ControllerContacts {
            contacts: Some((power, brake)),
        } => format!("주간제어기 접점 P {}, B {}", on_off(*power), on_off(*brake)),
        Stimulus::Reverser { position } => {
            let position = match position {
                1 => "전진",
                0 => "중립",
                _ => "후진",
            };
            format!("역전기: {position}")
        }
        Stimulus::Acknowledge => "확인 버튼 누름".to_owned(),
        Stimulus::Start => "ATO 출발 버튼 누름".to_owned(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: who is asked in Korean reads no English.
    #[test]
    fn what_a_person_does_is_told_in_korean() {
        use protocol::message::ModeSwitch;
        let by_hand = [
            Stimulus::Doors { closed: false },
            Stimulus::SideDoors {
                left: true,
                state: DoorState::Unlocked,
            },
            Stimulus::DoorLine {
                line: DoorLine::BySide,
                on: Some(true),
            },
            Stimulus::Hcr { on: true },
            Stimulus::MaintenanceKey { on: false },
            Stimulus::TrainNumber { number: 12 },
            Stimulus::WheelDiameter { diameter_mm: 780.0 },
            Stimulus::ModeSwitch(ModeSwitch::Driverless),
            Stimulus::ControllerContacts {
                contacts: Some((true, false)),
            },
            Stimulus::Reverser { position: -1 },
            Stimulus::Acknowledge,
            Stimulus::Start,
        ];
        for stimulus in by_hand {
            let said = korean(&stimulus);
            let mut words = said.split(|c: char| !c.is_ascii_alphabetic());
            assert!(words.all(|word| word.len() < 4), "{stimulus}: {said}");
        }
    }
}
