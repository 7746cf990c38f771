//! Parts to replace.

use super::wordings;

wordings! {
    /// Parts to replace.
    Diagnosis {
        title: "Diagnosis", "진단";
        choose_run: "Choose a run in the list", "목록에서 시험을 고르십시오";
        of_run: "unit {unit}, run of {time}", "장치 {unit}, {time} 시험";
        no_answer: "This run cannot be diagnosed", "이 시험은 진단할 수 없습니다";
        speaks_for: "speaks for it", "근거";
        speaks_against: "speaks against it", "반대 근거";
        no_fault: "no fault", "고장 없음";
        next_check: "Next best check", "다음 권장 점검";
        gains: "{bits} bits for {time} of bench time", "시험대 시간 {time}에 {bits} bit";
        settled: "Nothing more needs to be run", "더 실행할 점검이 없습니다";
        run_it: "Run it", "실행";
        traces: "traces of its faults", "관련 신호 기록";
        dictionary: "dictionary: {from}", "고장 사전: {from}";
        report: "Report", "성적서";
        reasons: "reasons", "이유";
        more: "more ({n})", "더 보기 ({n})";
    }
}
