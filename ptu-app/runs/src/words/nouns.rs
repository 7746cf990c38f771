//! Words of this program that sentences are about.

use fault_db::FaultState;

use crate::places::UnitInput;

/// A thing by its name, in Korean; what has none stays, as a table or an option.
pub fn noun(english: &str) -> &str {
    match english {
        "run" => "시험",
        "unit" => "장치",
        "fault" => "고장",
        "fault occurrence" => "고장 발생",
        "trace" => "신호 기록",
        "event" | "events" | "fault event" => "이벤트",
        "note" | "notes" | "the note" | "run note" => "메모",
        "measurement" => "측정",
        "instrument" => "계측기",
        "table" => "테이블",
        "index" => "인덱스",
        "view" => "뷰",
        "trigger" => "트리거",
        "recording" => "기록",
        "unit configuration" => "장치 구성",
        "line" => "노선",
        "train" => "열차",
        "bench" => "시험대",
        "controller" => "제어기",
        "the name of who says it" => "작성자 이름",
        "the JUnit report" => "JUnit 보고서",
        "the PDF" => "PDF",
        "the calibrations of sound devices" => "음향 장치의 교정값",
        "play on" => "재생",
        "record from" => "녹음",
        other => other,
    }
}

/// An input of the unit that a bench file places, in Korean.
pub const fn input(input: UnitInput) -> &'static str {
    use UnitInput as U;
    match input {
        U::DoorsClosed => "전체 출입문 닫힘",
        U::Hcr => "HCR",
        U::MaintenanceKey => "정비 키",
        U::Acknowledge => "확인 버튼",
        U::Start => "ATO 출발 버튼",
        U::EbLoop => "비상제동 루프",
        U::Forward => "역전기 전진",
        U::Backward => "역전기 후진",
        U::EbLoopFed => "비상제동 루프 급전",
        U::DoorsBySide => "출입문 측별 표시",
        U::LeftClosed => "왼쪽 출입문 닫힘",
        U::LeftLocked => "왼쪽 출입문 잠김",
        U::RightClosed => "오른쪽 출입문 닫힘",
        U::RightLocked => "오른쪽 출입문 잠김",
        U::Code => "속도 코드",
        U::Crosstalk => "인접 궤도 코드",
        U::Tacho1 => "속도센서 1",
        U::Tacho2 => "속도센서 2",
        U::Marker => "마커",
        U::ModeSwitch => "모드 스위치",
        U::Controller => "주간제어기",
        U::Entries => "운전실 입력값",
        U::Twc => "TWC",
        U::Supply => "장치 전원",
    }
}

/// What happened to a fault, in Korean; a kind of another program stays as it is.
pub fn event_kind(kind: &str) -> &str {
    match kind {
        "opened" => "발생",
        "recurred" => "재발생",
        "acknowledged" => "확인",
        "repair" => "수리 기록",
        "repaired" => "수리",
        "passed" => "시험 합격",
        "confirmed" => "시험으로 입증",
        "verified" => "검증",
        "closed" => "종결",
        "reopened" => "다시 열림",
        "note" => "메모",
        "cause" => "원인 지정",
        "diagnosed" => "진단",
        other => other,
    }
}

/// A fault's state, in Korean.
pub const fn fault_state(state: FaultState) -> &'static str {
    match state {
        FaultState::Open => "미조치",
        FaultState::Acknowledged => "확인됨",
        FaultState::Repaired => "수리됨",
        FaultState::Verified => "검증됨",
        FaultState::Closed => "종결",
    }
}
