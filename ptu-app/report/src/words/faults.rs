//! Fault history.

use super::wordings;

wordings! {
    /// Fault history.
    Faults {
        title: "Faults", "고장 이력";
        any: "any", "전체";
        since: "since", "기간";
        days: "{n} days", "{n}일";
        always: "all", "전체 기간";
        find: "text", "검색어";
        shown: "{n} of {of} faults", "고장 {of}건 중 {n}건";
        seen: "seen", "횟수";
        last_seen: "last seen", "최근 발생";
        cause: "cause", "원인";
        with_cause: "{part}; cause {cause}", "{part}; 원인 {cause}";
        case_of: "{cause}, {n} more faults follow", "{cause}, 함께 처리되는 고장 {n}건";
        first_seen_in: "first seen in {month}", "{month} 최초 발생";
        show_all: "Show all again", "모두 다시 표시";
        not_read: "The fault history cannot be read", "고장 이력을 읽을 수 없습니다";
        times_seen: "seen {n} times, {first} … {last}", "{n}회, {first} … {last}";
        acknowledge: "Acknowledge", "확인";
        repair: "Repaired …", "수리 …";
        verify: "Verified", "검증";
        close: "Close …", "종결 …";
        close_unrepaired: "Close without a repair? Faults: {n}", "수리 없이 종결하시겠습니까? 고장 {n}건";
        close_repaired: "Close? Faults: {n}", "종결하시겠습니까? 고장 {n}건";
        close_together: "They have one cause, {part}, and close together.", "원인 부품이 같아 함께 종결됩니다: {part}";
        close_why: "Why are they closed?", "종결 사유";
        close_not_found: "no fault found in the part", "부품에서 고장이 발견되지 않음";
        close_elsewhere: "repaired elsewhere, see note", "다른 곳에서 수리, 비고 참조";
        close_bench: "fault of the bench or of the train", "시험대 또는 차량의 고장";
        close_other: "other, see note", "기타, 비고 참조";
        close_looked: "What was looked at", "확인한 내용";
        close_reason: "Choose a reason and write what was looked at", "사유를 고르고 확인한 내용을 적으십시오";
        close_n: "Close faults: {n}", "고장 {n}건 종결";
        reopen: "Open again", "다시 열기";
        add_note: "Add note", "메모 추가";
        serial_old: "serial number taken out", "제거한 부품 일련번호";
        serial_new: "serial number put in", "장착한 부품 일련번호";
        verify_reason: "Runs verify a repair. Write in the note why it is verified without one", "수리는 시험으로 검증됩니다. 시험 없이 검증하는 이유를 메모에 적으십시오";
        repair_asked: "Record a repair? Faults: {n}", "수리를 기록하시겠습니까? 고장 {n}건";
        repair_together: "They have one cause, {part}, and its repair is recorded for each.", "원인 부품이 같아 수리가 함께 기록됩니다: {part}";
        note_first: "Write the note first", "먼저 메모를 적으십시오";
        repair_reason: "Write a serial number, or in the note what was done", "일련번호를 적거나, 조치 내용을 메모에 적으십시오";
        recorded: "Recorded: {what}", "기록 완료: {what}";
        not_changed: "The fault was not changed", "고장 상태를 바꾸지 못했습니다";
        withdrawn: "withdrawn {at} by {who}:", "{at} {who} 되돌림:";
        what_was_done: "what was done", "조치 이력";
        occurrences: "occurrences", "발생 기록";
        freeze_frame: "freeze frame: every signal", "프리즈 프레임: 발생 순간의 모든 신호";
        freeze: "freeze frame", "프리즈 프레임";
        same_case: "same case", "같은 건";
        seen_at: "seen at", "발생 시각";
        and_earlier: "… and {n} earlier", "… 그 이전 {n}건";
        once: "once, {last}", "1회, {last}";
        n_times: "{n} times, {first} .. {last}", "{n}회, {first} .. {last}";
        at: "at", "시각";
        event: "event", "내용";
        who: "who", "담당자";
        not_known: "not known", "알 수 없음";
        to_trace: "Trace", "신호 기록";
        to_run: "Run", "시험";
        to_diagnosis: "Diagnosis", "진단";
    }
}
