//! Statistics of the fault history.

use super::wordings;

wordings! {
    /// Statistics of the fault history.
    Statistics {
        title: "Statistics", "통계";
        not_read: "The statistics cannot be read", "통계를 읽을 수 없습니다";
        nothing: "No fault is recorded in this span.", "이 기간에 기록된 고장이 없습니다.";
        all_units: "all units", "모든 장치";
        of_unit: "unit {unit}", "장치 {unit}";
        cases: "Cases", "고장 건";
        cases_are: "{n} not closed", "미종결 {n}건";
        mtbf: "MTBF", "평균 고장 간격(MTBF)";
        mtbf_is: "since the first run of each unit", "장치별 첫 시험 이후";
        mttr: "MTTR", "평균 수리 시간(MTTR)";
        mttr_is: "repairs: {n}", "수리 {n}회";
        back: "Repairs that came back", "재발한 수리";
        back_is: "same fault within {days} days", "{days}일 안에 같은 고장";
        not_found: "No fault found", "고장 미발견";
        not_found_is: "closed without a repair", "수리 없이 종결";
        by_cause: "Cases by cause, share and running total", "원인 부품별 고장 건, 비율과 누계";
        by_month: "Faults first seen", "최초 발생 고장";
        per_10000_km: "faults first seen for each 10 000 km, by month", "월별 10 000 km당 최초 발생 고장";
        rate_is: "faults {n}, {km} km, trains {trains}", "고장 {n}건, {km} km, 열차 {trains}편성";
        rate_of: "computed of the faults of runs in trains whose odometer readings cover the time, and of what these trains ran; between two readings a train runs evenly", "주행거리 기록이 있는 기간의 해당 열차 고장과 주행거리로 계산. 두 기록 사이의 주행거리는 균등한 것으로 봄";
        no_distances: "Faults for each 10 000 km are told where distances are known: name a file with odometer readings.", "주행거리를 알면 10 000 km당 고장을 표시합니다. 주행거리 기록 파일을 지정하십시오.";
        no_distance_known: "No odometer reading of a train of this history covers these months.", "이 이력의 열차 중 이 기간의 주행거리 기록이 있는 열차가 없습니다.";
        distances_of_all: "Distances are of trains: choose all units to see faults for each 10 000 km.", "주행거리는 열차 단위입니다. 10 000 km당 고장을 보려면 모든 장치를 선택하십시오.";
        odometers: "odometer readings", "주행거리 기록";
        odometers_hint: "CSV file with the columns train, date, km: 612,2026-03-01,120345", "train, date, km 열이 있는 CSV 파일: 612,2026-03-01,120345";
        read_odometers: "Read the file", "파일 읽기";
        others: "others", "기타";
        of_all: "{share} %, together {sum} %", "{share} %, 누계 {sum} %";
        days: "{n} days", "{n}일";
        hours: "{n} h", "{n}시간";
        minutes: "{n} min", "{n}분";
        unknown: "–", "–";
        measured: "Measured value", "측정값";
        all_steps: "all steps", "모든 단계";
        nothing_measured: "Nothing has been measured yet.", "아직 측정한 값이 없습니다.";
        not_measured: "It was not measured so in this span.", "이 기간에 이 조건으로 측정한 값이 없습니다.";
        mean: "Values: {n}, mean {mean} {unit}", "값 {n}개, 평균 {mean} {unit}";
        control_limits: "Control limits (3 sigma) {low} … {high} {unit}", "관리 한계(3σ) {low} … {high} {unit}";
        limits_differ: "The steps have different limits: choose one to see them", "단계마다 허용값이 다릅니다. 허용값을 보려면 단계를 고르십시오";
        cpk: "Cpk {n}", "Cpk {n}";
        beyond_control: "Beyond the control limits: {n}", "관리 한계를 벗어난 값 {n}개";
        nine_on_one_side: "Nine or more on one side of the mean: {n}", "평균의 한쪽에 9개 이상 연속 {n}회";
        six_in_a_row: "Six or more rising or falling in a row: {n}", "6개 이상 연속 증가 또는 감소 {n}회";
        forecast: "Reaches its limit of {limit} {unit} on {day}", "{day}에 허용값 {limit} {unit}에 도달할 것으로 예상";
        questions: "saved questions", "저장한 조건";
        no_question: "none", "없음";
        question_name: "name", "이름";
        save_question: "Save this question", "이 조건 저장";
        forget_question: "Forget it", "저장한 조건 삭제";
        of_these: "{n} of {of}", "{of}건 중 {n}건";
        a_month: "a month", "월별";
        each_10000_km: "for each 10 000 km", "10 000 km당";
        mean_line: "mean {n}", "평균 {n}";
        control_line: "control limit {n}", "관리 한계 {n}";
        limit_line: "limit {n}", "허용값 {n}";
        chart_of: "values over time: {n}", "시간에 따른 값 {n}개";
    }
}

impl Statistics {
    /// Text of a sign that a process varies by more than chance.
    pub fn sign(&self, kind: &str) -> &'static str {
        match kind {
            "nine_on_one_side" => self.nine_on_one_side,
            "six_in_a_row" => self.six_in_a_row,
            _ => self.beyond_control,
        }
    }
}
