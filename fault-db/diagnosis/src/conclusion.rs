//! What a diagnosis comes to in one sentence, in both languages: the one that every place shows.

use protocol::LruId;
use serde::Serialize;

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
    fn then(self, next: Option<&NextCheck>) -> Self {
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
        let gain = format!("{:.2} bits in {:.0} s", next.gain_bits, next.cost_s);
        let gain_ko = format!("{:.0}초에 {:.2} bit", next.cost_s, next.gain_bits);
        self.and(
            &format!("next, run{again} {} ({gain})", next.check),
            &format!("다음 점검:{again_ko} {} ({gain_ko})", next.check),
        )
    }

    fn and(self, english: &str, korean: &str) -> Self {
        Self::new(
            format!("{}; {english}", self.english),
            format!("{}; {korean}", self.korean),
        )
    }

    /// One part is found.
    pub(crate) fn found(part: &LruId, probability: f64) -> Self {
        let part = named(part, probability);
        Self::new(format!("replace {part}"), format!("교체 대상: {part}"))
    }

    /// Two parts are found.
    pub(crate) fn two_found([one, other]: [&LruId; 2], probability: f64) -> Self {
        let both = percent(probability);
        Self::new(
            format!("two faults: replace {one} and {other} ({both})"),
            format!("복합 고장, 교체 대상: {one}, {other} ({both})"),
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

    /// No fault of the dictionary explains what was seen.
    pub(crate) fn unknown_fault(probability: f64, next: Option<&NextCheck>) -> Self {
        let sure = percent(probability);
        Self::new(
            format!("cannot tell: no fault mode of the dictionary explains this ({sure})"),
            format!(
                "판별할 수 없습니다: 고장 사전의 어떤 고장 모드로도 설명되지 않습니다 ({sure})"
            ),
        )
        .then(next)
    }

    /// Something is wrong, and these parts are the likely ones, the likeliest first.
    pub(crate) fn cannot_tell(likely: &[&PartProbability], next: Option<&NextCheck>) -> Self {
        let named: Vec<_> = likely
            .iter()
            .take(MOST_NAMED)
            .map(|part| named(&part.lru, part.probability))
            .collect();
        let more = likely.len() - named.len();
        let [more, more_ko] = match more {
            0 => [String::new(), String::new()],
            n => [format!(" or one of {n} more"), format!(" 외 {n}개")],
        };
        match &named[..] {
            // As many parts as nobody could choose from.
            [] if next.is_some() => Self::new(
                "not enough was run to tell which part",
                "시험 범위가 부족하여 판별할 수 없습니다",
            ),
            [] => Self::new("cannot tell which part", "부품을 판별할 수 없습니다"),
            [one] => Self::new(
                format!("not certain yet: {one}"),
                format!("아직 확실하지 않습니다: {one}"),
            ),
            several => Self::new(
                format!("cannot tell yet which: {}{more}", several.join(" or ")),
                format!(
                    "아직 판별할 수 없습니다: {}{more_ko}",
                    several.join(" 또는 ")
                ),
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

fn named(part: &LruId, probability: f64) -> String {
    format!("{part} ({})", percent(probability))
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
        let said = Sentence::cannot_tell(&parts.iter().collect::<Vec<_>>(), None);
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
}
