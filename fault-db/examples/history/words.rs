//! What people write down, in English and Korean.

use crate::chance::Chance;

pub const PEOPLE: [&str; 10] = [
    "Kim",
    "Lee",
    "Park",
    "Choi",
    "Jung",
    "김민수",
    "이서연",
    "박지훈",
    "Kang",
    "Yoon",
];

const SEEN: [&str; 12] = [
    "seen only when cold, not on the bench",
    "driver reports a jerk before the stop",
    "cable chafed at the bogie, taped for now",
    "connector X12 was loose, reseated",
    "same as last month on this train",
    "waits for a spare part",
    "추운 날 아침에만 발생, 시험대에서는 정상",
    "커넥터 X12 접촉 불량, 재체결함",
    "운전자 보고: 정차 직전 충격",
    "지난달과 같은 증상, 계속 관찰",
    "예비품 대기 중",
    "배선 피복 손상, 임시 조치함",
];

const NOTHING: [&str; 7] = [
    "no fault found",
    "no fault found, three passes on the bench",
    "not reproduced; wet rails that day",
    "wayside was being worked on",
    "재현 안됨",
    "이상 없음, 시험대 3회 합격",
    "지상 신호장치 작업 중이었음",
];

const REPAIRED: [&str; 9] = [
    "replaced",
    "replaced, old one has burnt contacts",
    "replaced, adjusted and sealed",
    "cleaned and put back",
    "swapped with the spare",
    "교체함",
    "부품 교체, 접점 소손 확인",
    "교체 후 조정 완료",
    "청소 후 재장착",
];

const RUN: [&str; 6] = [
    "test leads changed after step 3",
    "repeated because the key was off",
    "bench supply at 104 V",
    "시험 전 전원 재투입",
    "정기 검사",
    "야간 작업, 키 위치 확인함",
];

pub fn person(chance: &mut Chance) -> &'static str {
    chance.one_of(&PEOPLE)
}

pub fn seen(chance: &mut Chance) -> &'static str {
    chance.one_of(&SEEN)
}

pub fn nothing(chance: &mut Chance) -> &'static str {
    chance.one_of(&NOTHING)
}

pub fn repaired(chance: &mut Chance) -> &'static str {
    chance.one_of(&REPAIRED)
}

pub fn of_run(chance: &mut Chance) -> &'static str {
    chance.one_of(&RUN)
}

/// A part's serial number.
pub fn part_serial(part: &str, chance: &mut Chance) -> String {
    let letters: String = part
        .split('_')
        .filter_map(|word| word.chars().next())
        .collect();
    format!("{}-{:05}", letters.to_uppercase(), chance.below(100_000))
}
