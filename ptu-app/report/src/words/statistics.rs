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
        cases: "cases", "고장 건";
        cases_are: "first seen in the span; what one part explains is one case. Not closed: {n}", "기간 내 최초 발생. 한 부품으로 설명되는 고장은 1건. 미종결 {n}건";
        mtbf: "MTBF", "평균 고장 간격(MTBF)";
        mtbf_is: "days of the calendar since the first run of each unit, by cases", "장치별 첫 시험 이후의 달력 일수를 고장 건수로 나눈 값";
        mttr: "MTTR", "평균 수리 시간(MTTR)";
        mttr_is: "from the opening of a fault to its repair; repairs: {n}", "고장 발생부터 수리까지, 수리 {n}회의 평균";
        back: "repairs that came back", "재발한 수리";
        back_is: "the same fault again within {days} days; repairs that are old enough to tell: {n}", "{days}일 안에 같은 고장 재발. 판단할 수 있는 수리 {n}회 중";
        not_found: "no fault found", "고장 미발견";
        not_found_is: "closed without a repair; closed: {n}", "수리 없이 종결. 종결 {n}건 중";
        by_cause: "cases by cause, share and running total", "원인 부품별 고장 건, 비율과 누계";
        by_month: "faults first seen, by month", "월별 최초 발생 고장";
        others: "others", "기타";
        of_all: "{share} %, together {sum} %", "{share} %, 누계 {sum} %";
        days: "{n} days", "{n}일";
        hours: "{n} h", "{n}시간";
        percent: "{n} %", "{n} %";
        unknown: "–", "–";
    }
}
