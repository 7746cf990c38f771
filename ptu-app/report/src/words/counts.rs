//! Counts, trends and records in answers of the command line.

use super::{Words, wordings};
use ptu_runs::clock::{Span, local_day};

wordings! {
    /// Counts, trends and records in answers of the command line.
    Counts {
        all: "all", "전체";
        cases: "cases", "건";
        their_faults: "their faults", "해당 고장";
        kilometres: "km", "km";
        per_10000_km: "per 10000 km", "10000 km당";
        trains: "trains", "편성";
        units: "units", "장치";
        month: "month", "월";
        mttr: "MTTR", "MTTR";
        mtbf: "MTBF", "MTBF";
        not_found: "NFF", "NFF";
        worse: " worse", " 악화";
        better: " better", " 개선";
        earlier_months: "… {n} earlier months; see --limit", "… 이전 {n}개월 더 있음. --limit 참조";
        n_more: "… and {n} more; see --limit", "… {n}건 더 있음. --limit 참조";
        back_is: "; BACK: within {n} days of the repair", "; 재발: 수리 후 {n}일 이내";
        course_is: "; course by day or month, the last 24; LATER/EARLIER: occurrences of the later half of the course over the earlier half, with what it is in 95 of 100 cases; \"worse\" or \"better\" where that is above or below 1",
            "; 추이: 일 또는 월 단위 최근 24개; 후반/전반: 추이 후반의 발생 횟수를 전반으로 나눈 값과 95 % 구간, 구간이 1보다 크면 \"악화\", 작으면 \"개선\"";
        rate_is: "; PER 10000 KM: faults first seen in runs in trains whose odometer readings cover the time, over what these trains ran; between two readings a train runs evenly",
            "; 10000 KM당: 주행거리 기록이 있는 열차의 시험에서 최초 발생한 고장을 그 열차의 주행거리로 나눈 값. 두 기록 사이는 일정하게 주행한 것으로 봄";
        span_all: "all of history", "전체 기간";
        nothing_measured: "no value could be measured", "측정된 값이 없음";
        by_several: "measured by {names}, each with limits of its own: choose one with --procedure", "{names}에서 허용값을 달리하여 측정함. --procedure로 선택";
        several_limits: "measured with several limits: choose a step with --step", "단계마다 허용값이 다름. --step으로 선택";
        earlier_values: "… {n} earlier values; see --limit", "… 이전 값 {n}개 더 있음. --limit 참조";
        least: "least", "최소";
        most: "most", "최대";
        not_passed: "not passed", "미합격";
        n_values: "{n} values, mean {mean}", "값 {n}개, 평균 {mean}";
        sigma: ", sigma {sigma}", ", 표준편차 {sigma}";
        control: "control limits {low} .. {high}", "관리 한계 {low} .. {high}";
        allowed: "allowed {low} .. {high}", "허용 {low} .. {high}";
        allowed_from: "allowed from {low}", "허용 {low} 이상";
        allowed_to: "allowed up to {high}", "허용 {high} 이하";
        limits_differ: "limits differ from step to step", "단계마다 허용값이 다름";
        no_limits: "no limits", "허용값 없음";
        no_drift: ": no drift for certain", ": 뚜렷한 변화 없음";
        slope: "slope {slope} ± {reach} {unit} in 30 days{certain}", "30일간 변화 {slope} ± {reach} {unit}{certain}";
        never: "never", "없음";
        reaches: "reaches {limit} about {day} (95 %: {from} .. {until})", "{day}경 {limit}에 도달 (95 %: {from} .. {until})";
        beyond_control: "beyond a control limit", "관리 한계를 벗어남";
        nine_on_one_side: "nine in a row on one side of the mean", "평균의 한쪽에 9개 연속";
        six_in_a_row: "six in a row each beyond the one before", "6개 연속 증가 또는 감소";
        once: "once", "1회";
        several: "{n} times, first {day}", "{n}회, 처음 {day}";
        more_than_chance: "more than chance: {what}, {times}, last {day}", "우연이 아님: {what}, {times}, 마지막 {day}";
        none_stands_out: "no unit of {n} stands out", "장치 {n}대 중 벗어난 장치 없음";
        off: "off", "편차";
        in_30_days: "in 30 days", "30일간";
        stand_out: "{n} of {of} units stand out (OFF: standard deviations from the middle of the fleet)", "장치 {of}대 중 {n}대가 벗어남 (편차: 전체 중앙값과의 차이, 표준편차 단위)";
        withdrawn: "withdrawn: {kind} of {at}{by}", "되돌림: {at} {kind}{by}";
        by_whom: " by {who}", " ({who})";
        log_read: "unit {unit} on {place}, {n} log entries read", "장치 {unit} ({place}), 고장 기록 {n}건 읽음";
        not_kept: "and {n} more entries, not stored", "저장하지 못한 기록 {n}건 더 있음";
        imported: "{n} faults imported as run {run}; `ptu diagnose {run}` says what they come to", "고장 {n}건을 시험 {run}(으)로 가져옴. 진단: `ptu diagnose {run}`";
        nothing_new: "nothing new", "새 기록 없음";
        left_out: "left out: {n} {why}", "제외 {n}건: {why}";
        known_already: "known already", "이미 있음";
        information: "information only", "정보 기록";
        too_old: "before the time asked for", "지정한 기간 이전";
        under_test: "of runs in this history, which judged them", "이 이력의 시험에서 판정함";
        of_tester: "of a tester: made while it had the unit armed, or its own line", "시험기가 시험 중이거나 시험기 회선에서 생긴 기록";
        alone: "silence of a unit with nothing connected", "연결 없이 켜진 장치의 무응답";
        bad_line: "of a bad line: frames of several partners refused at once, and their silence", "불량 회선: 여러 상대의 프레임이 함께 거부됨, 그 무응답";
        remark: "note: {text}", "참고: {text}";
        record_read: "unit {unit} on {place}, {n} rows of its run record read", "장치 {unit} ({place}), 주행 기록 {n}행 읽음";
        pulled: "{n} runs pulled as traces of run {run}", "주행 {n}건을 시험 {run}의 신호 기록으로 가져옴";
    }
}

impl Words {
    /// A span of time by its days.
    pub fn span(&self, span: Span) -> String {
        let counts = &self.counts;
        let until = |until: Option<i64>| {
            until.map_or_else(|| self.life.now.to_owned(), |until| local_day(until - 1))
        };
        match (span.since_us, span.until_us) {
            (None, None) => counts.span_all.to_owned(),
            (None, end) => format!(" .. {}", until(end)),
            (Some(since), end) => format!("{} .. {}", local_day(since), until(end)),
        }
    }
}

impl Counts {
    /// Text of a sign that a process varies by more than chance.
    pub fn sign(&self, kind: &str) -> &'static str {
        match kind {
            "beyond_control" => self.beyond_control,
            "nine_on_one_side" => self.nine_on_one_side,
            _ => self.six_in_a_row,
        }
    }
}
