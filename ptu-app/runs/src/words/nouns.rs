//! Words of this program that sentences are about.

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
