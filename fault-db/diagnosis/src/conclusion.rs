//! What a diagnosis comes to in one sentence, in both languages: the one that every place shows.

use protocol::LruId;
use protocol::injection::Lru;
use serde::Serialize;

use super::groups::{Group, Shared};
use super::next_check::NextCheck;
use super::verdict::PartProbability;

/// Parts named at most where it cannot be told which one has failed.
const MOST_NAMED: usize = 3;

/// A sentence in both languages.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Sentence {
    /// In English.
    pub english: String,
    /// In Korean.
    pub korean: String,
}

impl Sentence {
    fn new(english: impl Into<String>, korean: impl Into<String>) -> Self {
        Self {
            english: english.into(),
            korean: korean.into(),
        }
    }

    /// With what to run next, or that nothing in the suite would tell more.
    pub(crate) fn then(self, next: Option<&NextCheck>) -> Self {
        let Some(next) = next else {
            return self.and(
                "nothing in this suite would tell more",
                "더 알려 줄 점검이 없습니다",
            );
        };
        let [again, again_ko] = if next.again {
            [" again", " 다시"]
        } else {
            [""; 2]
        };
        let [tells, tells_ko] =
            [&next.tells.english, &next.tells.korean].map(|tells| match &**tells {
                "" => String::new(),
                tells => format!(": {tells}"),
            });
        let time_s = next.cost_s.ceil();
        self.and(
            &format!("next, run{again} {} ({time_s:.0} s){tells}", next.check),
            &format!(
                "다음 점검:{again_ko} {} ({time_s:.0}초){tells_ko}",
                next.check
            ),
        )
    }

    fn and(self, english: &str, korean: &str) -> Self {
        Self::new(
            format!("{}; {english}", self.english),
            format!("{}; {korean}", self.korean),
        )
    }

    /// One part is found.
    pub(crate) fn found(part: &LruId, probability: f64, names: &[Lru]) -> Self {
        let [part, part_ko] = named(part, Some(probability), names);
        Self::new(format!("replace {part}"), format!("교체 대상: {part_ko}"))
    }

    /// Two parts are found.
    pub(crate) fn two_found(parts: [&LruId; 2], probability: f64, names: &[Lru]) -> Self {
        let both = percent(probability);
        let [[one, one_ko], [other, other_ko]] = parts.map(|part| named(part, None, names));
        Self::new(
            format!("two faults ({both}): replace {one} and {other}"),
            format!("복합 고장 ({both}), 교체 대상: {one_ko}, {other_ko}"),
        )
    }

    /// What a check tells that passes where these parts have failed, and does not pass where those have; empty if that is
    /// not known.
    pub(crate) fn tells(passes: &[LruId], fails: &[LruId], names: &[Lru]) -> Self {
        let all = |parts: &[LruId]| {
            let named: Vec<_> = parts.iter().map(|part| called(part, names)).collect();
            one_or_other(&named)
        };
        let ([passed, passed_ko], [failed, failed_ko]) = (all(passes), all(fails));
        match (passes.is_empty(), fails.is_empty()) {
            (true, true) => Self::default(),
            (false, true) => Self::new(
                format!("it passes if the fault is in {passed}"),
                format!("{passed_ko} 고장이면 합격합니다"),
            ),
            (true, false) => Self::new(
                format!("it fails if the fault is in {failed}"),
                format!("{failed_ko} 고장이면 불합격합니다"),
            ),
            (false, false) => Self::new(
                format!("it passes if the fault is in {passed}, and fails if it is in {failed}"),
                format!("{passed_ko} 고장이면 합격, {failed_ko} 고장이면 불합격합니다"),
            ),
        }
    }

    /// One of the parts of a group is found, and this tells which.
    pub(crate) fn one_of(group: &Group, probability: f64, names: &[Lru]) -> Self {
        let sure = percent(probability);
        let parts: Vec<_> = group
            .parts
            .iter()
            .map(|part| named(part, None, names))
            .collect();
        let [parts, parts_ko] = one_or_other(&parts);
        Self::new(format!("{parts} ({sure})"), format!("{parts_ko} ({sure})"))
            .told_by(&group.measure)
    }

    /// With the measurement that tells which.
    fn told_by(self, measure: &Self) -> Self {
        self.and(
            &format!("to tell which, {}", measure.english),
            &format!("판별 방법: {}", measure.korean),
        )
    }

    /// One cause at two parts that share something, or a fault of each, and what tells.
    pub(crate) fn common(
        shared: &Shared,
        parts: [&LruId; 2],
        probability: f64,
        names: &[Lru],
    ) -> Self {
        let sure = percent(probability);
        let [places, places_ko] =
            joined(&parts.map(|part| named(part, None, names)), [" and ", ", "]);
        let [part, part_ko] = named(&shared.part, None, names);
        Self::new(
            format!("one cause at {places} ({sure}): {part}, its wiring, or a fault of each"),
            format!("{places_ko}에 공통된 원인 ({sure}): {part_ko}, 배선 또는 각각의 고장"),
        )
        .told_by(&shared.measure)
    }

    /// A part is found, or something that it shares with another that a sign names, and what tells.
    pub(crate) fn one_or_common(
        shared: &Shared,
        one: (&LruId, f64),
        other: &LruId,
        names: &[Lru],
    ) -> Self {
        let [found, found_ko] = named(one.0, Some(one.1), names);
        let [cause, cause_ko] = named(&shared.part, None, names);
        let [one, one_ko] = called(one.0, names);
        let [other, other_ko] = named(other, None, names);
        Self::new(
            format!("{found}, or one cause at {one} and {other}: {cause} or its wiring"),
            format!("{found_ko} 또는 {one_ko}, {other_ko}에 공통된 원인: {cause_ko} 또는 배선"),
        )
        .told_by(&shared.measure)
    }

    /// A part is found, and a sign that none of its faults shows names another, with which it shares nothing.
    pub(crate) fn not_alone(one: (&LruId, f64), other: &LruId, names: &[Lru]) -> Self {
        let [found, found_ko] = named(one.0, Some(one.1), names);
        let [other, other_ko] = named(other, None, names);
        Self::new(
            format!("not certain yet: {found}; a sign of a fault in {other} does not come from it"),
            format!(
                "아직 확실하지 않습니다: {found_ko}; {other_ko} 고장 징후는 이 고장으로 설명되지 않습니다"
            ),
        )
    }

    /// Nothing is wrong.
    pub(crate) fn no_fault(probability: f64) -> Self {
        let sure = percent(probability);
        Self::new(
            format!("no fault found ({sure})"),
            format!("고장이 발견되지 않았습니다 ({sure})"),
        )
    }

    /// Nothing wrong was seen in so many of all checks, which is not enough to say that nothing is wrong.
    pub(crate) fn nothing_seen([made, all]: [usize; 2], next: Option<&NextCheck>) -> Self {
        Self::new(
            format!("not enough was run: {made} of {all} checks were made and show nothing wrong"),
            format!(
                "시험 범위가 부족하여 판별할 수 없습니다: 점검 {all}개 중 {made}개 수행, 이상 없음"
            ),
        )
        .then(next)
    }

    /// Something is wrong, and these parts are the likely ones, the likeliest first.
    pub(crate) fn cannot_tell(
        likely: &[&PartProbability],
        next: Option<&NextCheck>,
        names: &[Lru],
    ) -> Self {
        let shown = likely.iter().take(MOST_NAMED);
        let shown: Vec<_> = shown
            .map(|part| named(&part.lru, Some(part.probability), names))
            .collect();
        let more = likely.len() - shown.len();
        let [more, more_ko] = match more {
            0 => [String::new(), String::new()],
            n => [format!(" or one of {n} more"), format!(" 외 {n}개")],
        };
        let [all, all_ko] = one_or_other(&shown);
        match &shown[..] {
            // As many parts as nobody could choose from.
            [] if next.is_some() => Self::new(
                "not enough was run to tell which part",
                "시험 범위가 부족하여 판별할 수 없습니다",
            ),
            [] => Self::new("cannot tell which part", "부품을 판별할 수 없습니다"),
            [[one, one_ko]] => Self::new(
                format!("not certain yet: {one}"),
                format!("아직 확실하지 않습니다: {one_ko}"),
            ),
            _ => Self::new(
                format!("cannot tell yet which: {all}{more}"),
                format!("아직 판별할 수 없습니다: {all_ko}{more_ko}"),
            ),
        }
        .then(next)
    }

    /// The run was broken off before anything was seen to be wrong.
    pub fn broken_off(next: &NextCheck) -> Self {
        Self::new(
            "not enough was run: the run was stopped before its end",
            "시험 범위가 부족하여 판별할 수 없습니다: 시험이 도중에 중단되었습니다",
        )
        .then(Some(next))
    }

    /// The run did not pass, and nothing that could be weighed was seen to be wrong.
    pub fn not_weighed() -> Self {
        Self::new(
            "cannot tell: the run did not pass, and what did not pass was not run to its end or is not in the dictionary",
            "판별할 수 없습니다: 합격하지 못한 시험이며, 합격하지 못한 항목은 끝까지 수행되지 않았거나 고장 사전에 없습니다",
        )
    }
}

/// Named parts, one of which it is, in both languages.
fn one_or_other(named: &[[String; 2]]) -> [String; 2] {
    joined(named, [" or ", " 또는 "])
}

/// Named parts with these words between them.
fn joined(named: &[[String; 2]], words: [&str; 2]) -> [String; 2] {
    [0, 1].map(|language| {
        let named: Vec<_> = named.iter().map(|part| &*part[language]).collect();
        named.join(words[language])
    })
}

/// A part by its name alone in both languages, within a sentence.
fn called(part: &LruId, names: &[Lru]) -> [String; 2] {
    let known = names.iter().find(|known| known.id == *part);
    known.map_or_else(
        || [part.to_string(), part.to_string()],
        |known| [in_sentence(&known.name), known.name_ko.clone()],
    )
}

/// A part by its name in both languages, with the identifier that commands take and its probability; by the identifier alone
/// where the catalogue has no name.
fn named(part: &LruId, probability: Option<f64>, names: &[Lru]) -> [String; 2] {
    let sure = probability.map(percent);
    let Some(known) = names.iter().find(|known| known.id == *part) else {
        let id = sure.map_or_else(|| part.to_string(), |sure| format!("{part} ({sure})"));
        return [id.clone(), id];
    };
    let apart = sure.map_or_else(String::new, |sure| format!(", {sure}"));
    let with_id = |name: &str| format!("{name} ({part}{apart})");
    [with_id(&in_sentence(&known.name)), with_id(&known.name_ko)]
}

/// An English name within a sentence: "the EB relay", "speed sensor 1".
fn in_sentence(name: &str) -> String {
    let mut letters = name.chars();
    let (first, second) = (letters.next(), letters.next());
    let begins = match (first, second) {
        (Some(first), Some(second)) if second.is_lowercase() => first.to_lowercase().to_string(),
        (first, _) => first.map_or_else(String::new, String::from),
    };
    let rest = &name[first.map_or(0, char::len_utf8)..];
    match name.ends_with(|last: char| last.is_ascii_digit()) {
        true => format!("{begins}{rest}"),
        false => format!("the {begins}{rest}"),
    }
}

fn percent(probability: f64) -> String {
    format!("{:.1} %", 100.0 * probability)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(name: &str, probability: f64) -> PartProbability {
        PartProbability {
            lru: name.parse().expect("a part"),
            probability,
        }
    }

    /// A sentence is for reading: three parts of five are named, the rest counted.
    #[test]
    fn no_more_parts_are_named_than_a_person_can_choose_from() {
        let parts: Vec<_> = ["a", "b", "c", "d", "e"].map(|name| part(name, 0.2)).into();
        let said = Sentence::cannot_tell(&parts.iter().collect::<Vec<_>>(), None, &[]);
        assert!(
            said.english.contains("c (20.0 %) or one of 2 more;"),
            "{}",
            said.english
        );
        assert!(
            said.korean.contains("c (20.0 %) 외 2개;"),
            "{}",
            said.korean
        );
        assert!(!said.english.contains("d (") && !said.korean.contains("d ("));
    }

    /// People know a part by its name, commands by its identifier.
    #[test]
    fn a_part_is_called_by_its_name_with_its_identifier() {
        let known = |id: &str, name: &str, name_ko: &str| Lru {
            id: id.parse().expect("a part"),
            name: name.into(),
            name_ko: name_ko.into(),
        };
        let names = [
            known("eb_relay", "EB relay", "비상제동 계전기"),
            known("speed_sensor_1", "Speed sensor 1", "속도센서 1"),
            known("master_controller", "Master controller", "주간제어기"),
        ];
        let id = |id: &str| id.parse::<LruId>().expect("a part");
        let one = Sentence::found(&id("eb_relay"), 0.996, &names);
        assert_eq!(one.english, "replace the EB relay (eb_relay, 99.6 %)");
        assert_eq!(one.korean, "교체 대상: 비상제동 계전기 (eb_relay, 99.6 %)");
        let both = [&id("speed_sensor_1"), &id("master_controller")];
        let two = Sentence::two_found(both, 0.96, &names);
        let said = "two faults (96.0 %): replace speed sensor 1 (speed_sensor_1) and the master controller (master_controller)";
        assert_eq!(two.english, said);
        let said = "복합 고장 (96.0 %), 교체 대상: 속도센서 1 (speed_sensor_1), 주간제어기 (master_controller)";
        assert_eq!(two.korean, said);
        let unnamed = Sentence::found(&id("relay"), 0.996, &names);
        assert_eq!(unnamed.english, "replace relay (99.6 %)");
    }
}
