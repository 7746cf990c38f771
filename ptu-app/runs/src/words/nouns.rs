//! Korean words for the things, events and states that sentences name.

use fault_db::FaultState;

/// The Korean noun for an English one; a name without a Korean noun, as that of a table or an option, stays as it is.
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
