//! Verdicts, states, units and what every page says.

use btu_rig::procedure::{Outside, Verdict};

use super::wordings;
use ptu_runs::stored::from_stored;

wordings! {
    /// Verdicts, states and what every page says.
    Common {
        passed: "passed", "합격";
        failed: "failed", "불합격";
        error: "could not be tested", "판정 불가";
        skipped: "not run", "미실행";
        inconclusive: "inconclusive", "판정 보류";
        no_part: "unknown", "알 수 없음";
        aborted: "aborted", "중단";
        running: "running", "진행 중";
        interrupted: "interrupted", "미완료";
        bring_up: "bring-up", "기동";
        set_up: "set-up", "준비";
        clean_up: "clean-up", "종료 처리";
        safe_outputs: "safe outputs", "출력 안전화";
        unprovoked_event: "unprovoked event", "유발하지 않은 이벤트";
        self_test: "self-test", "자체시험";
        unit_log: "unit log", "장치 로그";
        bench: "bench", "시험대";
        stop: "stop", "정지 명령";
        not_begun: "not begun", "시작 안 함";
        as_a_whole: "as a whole", "전체";
        run_again: "repeated", "반복";
        attempt: "attempt", "시도";
        unit: "unit", "장치";
        run: "run", "시험";
        fault: "fault", "고장";
        part: "part", "부품";
        step: "step", "단계";
        procedure: "procedure", "절차";
        code: "code", "코드";
        number: "number", "번호";
        state: "state", "상태";
        severity: "severity", "심각도";
        time: "time", "시각";
        note: "note", "메모";
        value: "value", "값";
        low: "low", "하한";
        high: "high", "상한";
        verdict: "verdict", "판정";
        operator: "operator", "시험자";
        line: "line", "노선";
        train_no: "train number", "편성 번호";
        loading: "loading …", "불러오는 중 …";
        other_unit: "of another unit: {unit}, not {connected}", "다른 장치의 시험: {unit} (연결됨: {connected})";
        limit_is: "limit {limit}", "허용 {limit}";
        nothing: "nothing here yet", "아직 아무것도 없음";
        runs: "Recorded runs", "시험 기록";
        refresh: "Try again", "다시 시도";
        save: "save", "저장";
        cancel: "cancel", "취소";
        at_most: "at most {n}", "{n} 이하";
        at_least: "at least {n}", "{n} 이상";
        from_to: "{low} to {high}", "{low}~{high}";
        close: "close", "닫기";
        file: "file", "파일";
        saved: "saved: {file}", "저장됨: {file}";
    }
}

impl Common {
    pub fn verdict(&self, verdict: Verdict) -> &'static str {
        match verdict {
            Verdict::Passed => self.passed,
            Verdict::Failed => self.failed,
            Verdict::Error => self.error,
            Verdict::Skipped => self.skipped,
            Verdict::Inconclusive => self.inconclusive,
            Verdict::Aborted => self.aborted,
        }
    }

    pub fn stored_verdict(&self, verdict: fault_db::Verdict) -> &'static str {
        self.verdict(from_stored(verdict))
    }

    /// Name of the place outside steps at which something failed.
    pub fn outside(&self, place: Outside) -> &'static str {
        match place {
            Outside::BringUp => self.bring_up,
            Outside::SetUp => self.set_up,
            Outside::CleanUp => self.clean_up,
            Outside::SafeOutputs => self.safe_outputs,
            Outside::UnprovokedEvent => self.unprovoked_event,
            Outside::SelfTest => self.self_test,
            Outside::UnitLog => self.unit_log,
            Outside::Bench => self.bench,
            Outside::Stop => self.stop,
            Outside::NotBegun => self.not_begun,
            Outside::Whole => self.as_a_whole,
        }
    }
}
