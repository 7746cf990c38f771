//! Life of a unit, a train or a part by its serial number.

use fault_db::LifeOf;

use super::wordings;

wordings! {
    /// Life of a unit, a train or a part by its serial number.
    Life {
        title: "life by serial number", "일련번호별 이력";
        search: "serial number", "일련번호";
        show: "Show its life", "이력 보기";
        back: "Back to the statistics", "통계로 돌아가기";
        unit: "unit {serial}", "장치 {serial}";
        train: "train {serial}", "편성 {serial}";
        part: "part {serial}", "부품 {serial}";
        span: "{n} entries, {first} … {last}", "기록 {n}건, {first} … {last}";
        trains: "trains it was in", "편성된 열차";
        units_of_train: "units in it", "탑재된 장치";
        units_of_part: "units it was in", "장착된 장치";
        from: "from", "부터";
        until: "until", "까지";
        before: "earlier than stored", "기록 이전";
        now: "now", "현재";
        runs: "runs", "시험";
        stored: "what is stored", "저장된 기록";
        what: "what", "내용";
        run: "run: {verdict}, faults seen: {n}", "시험: {verdict}, 발생 고장 {n}건";
        log: "log of the unit read, faults in it: {n}", "장치 기록 읽음, 기록된 고장 {n}건";
        in_train: "train {train}", "편성 {train}";
        more_faults: "and {n} more of the case", "같은 건 {n}건 더";
        earlier: "{n} earlier entries are not listed", "이전 기록 {n}건은 표시하지 않음";
        nothing: "Nothing with the serial number {serial} is stored: no unit, no train, no part that a repair put in or took out", "일련번호 {serial}의 기록이 없습니다. 장치, 편성, 수리로 장착하거나 제거한 부품을 찾았습니다";
        not_read: "The life cannot be read", "이력을 읽을 수 없습니다";
        open: "Show everything about {serial}", "{serial}의 모든 기록 보기";
    }
}

impl Life {
    /// Kind of thing that has the serial number.
    pub fn of(&self, of: LifeOf) -> &'static str {
        match of {
            LifeOf::Unit => self.unit,
            LifeOf::Train => self.train,
            LifeOf::Part => self.part,
        }
    }

    /// Heading of the stays: trains of a unit, units of a train, or units of a part.
    pub fn stays(&self, of: LifeOf) -> &'static str {
        match of {
            LifeOf::Unit => self.trains,
            LifeOf::Train => self.units_of_train,
            LifeOf::Part => self.units_of_part,
        }
    }
}
