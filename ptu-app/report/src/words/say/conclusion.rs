//! Conclusions of a diagnosis, and the next check: a sentence in both languages for each kind.

use diagnosis::{Conclusion, NextCheck};
use protocol::LruId;
use protocol::injection::Lru;

use super::super::names;
use super::both::{Both, checked};

/// Most parts that are named where nobody can tell which one has failed.
const MOST_NAMED: usize = 3;

pub(super) fn concluded(conclusion: &Conclusion, next: Option<&NextCheck>, names: &[Lru]) -> Both {
    let [said, said_ko] = answered(conclusion, next.is_some(), names);
    let then = match conclusion {
        Conclusion::Found { .. }
        | Conclusion::OfBench { .. }
        | Conclusion::NoFault { .. }
        | Conclusion::NotWeighed
        | Conclusion::BenchFailed { .. } => None,
        // Where no check is left, the measurement tells which.
        Conclusion::OneOf { measure, .. } if !measure.english.is_empty() => {
            next.map(|next| run_next(next, names))
        }
        Conclusion::OneOf { .. }
        | Conclusion::NothingSeen { .. }
        | Conclusion::CannotTell { .. }
        | Conclusion::BrokenOff => {
            Some(next.map_or_else(|| swap(conclusion, names), |next| run_next(next, names)))
        }
    };
    match then {
        None => [said, said_ko],
        Some([then, then_ko]) => [format!("{said}; {then}"), format!("{said_ko}; {then_ko}")],
    }
}

/// The conclusion without the next check.
fn answered(conclusion: &Conclusion, can_go_on: bool, names: &[Lru]) -> Both {
    match conclusion {
        Conclusion::Found { part, probability } => {
            let [part, part_ko] = named(part, Some(*probability), names);
            [format!("replace {part}"), format!("교체 대상: {part_ko}")]
        }
        Conclusion::OfBench { part, probability } => {
            let [part, part_ko] = named(part, Some(*probability), names);
            [
                format!("the unit is not at fault: examine {part}, and run the suite again"),
                format!(
                    "장치 고장이 아닙니다. 점검 대상: {part_ko}. 점검 후 전체 시험을 다시 합니다"
                ),
            ]
        }
        Conclusion::OneOf { parts, measure } => {
            let named = parts
                .iter()
                .map(|part| named(&part.lru, Some(part.probability), names));
            let [parts, parts_ko] = one_or_other(&named.collect::<Vec<_>>());
            match measure.english.is_empty() {
                true => [parts, parts_ko],
                false => [
                    format!("{parts}; to tell which, {}", measure.english),
                    format!("{parts_ko}; 판별 방법: {}", measure.korean),
                ],
            }
        }
        Conclusion::NoFault { probability } => {
            let sure = percent(*probability);
            [
                format!("no fault found ({sure})"),
                format!("고장이 발견되지 않았습니다 ({sure})"),
            ]
        }
        Conclusion::NothingSeen { made: 0, of } => [
            format!("nothing was tested: none of {of} checks was made"),
            format!("시험한 것이 없습니다: 점검 {of}개 중 0개 수행"),
        ],
        Conclusion::NothingSeen { made, of } => [
            format!("not enough was run: {made} of {of} checks were made and show nothing wrong"),
            format!(
                "시험 범위가 부족하여 판별할 수 없습니다: 점검 {of}개 중 {made}개 수행, 이상이 발견되지 않음"
            ),
        ],
        Conclusion::CannotTell {
            likely,
            is_unlike_any,
        } => {
            let shown = likely.iter().take(MOST_NAMED);
            let shown: Vec<_> = shown
                .map(|part| named(&part.lru, Some(part.probability), names))
                .collect();
            let said = cannot_tell(&shown, likely.len() - shown.len(), can_go_on);
            match is_unlike_any {
                true => unlike_any(&said),
                false => said,
            }
        }
        Conclusion::BrokenOff => [
            "not enough was run: the run was stopped before its end".to_owned(),
            "시험 범위가 부족하여 판별할 수 없습니다: 시험이 도중에 중단되었습니다".to_owned(),
        ],
        Conclusion::BenchFailed { bench } => [
            format!("the bench failed, not the unit: `ptu doctor --bench {bench}`"),
            format!("장치가 아니라 시험대의 이상입니다: `ptu doctor --bench {bench}`"),
        ],
        Conclusion::NotWeighed => [
            "cannot tell: the run did not pass, and what did not pass was not run to its end or is not in the dictionary".to_owned(),
            "판별할 수 없습니다: 합격하지 못한 시험이며, 합격하지 못한 항목은 끝까지 수행되지 않았거나 고장 사전에 없습니다".to_owned(),
        ],
    }
}

/// Sentence which says that one of these parts, or of `more` others, has failed.
fn cannot_tell(shown: &[Both], more: usize, can_go_on: bool) -> Both {
    let [more, more_ko] = match more {
        0 => [String::new(), String::new()],
        1 => [" or 1 more".to_owned(), " 외 1개".to_owned()],
        n => [format!(" or one of {n} more"), format!(" 외 {n}개")],
    };
    let [all, all_ko] = one_or_other(shown);
    match shown {
        // Too many parts are likely to choose from: none is named.
        [] if can_go_on => [
            "not enough was run to tell which part".to_owned(),
            "시험 범위가 부족하여 판별할 수 없습니다".to_owned(),
        ],
        [] => [
            "cannot tell which part".to_owned(),
            "부품을 판별할 수 없습니다".to_owned(),
        ],
        [[one, one_ko]] => [
            format!("not certain yet: {one}"),
            format!("아직 확실하지 않습니다: {one_ko}"),
        ],
        _ => [
            format!("cannot tell yet which: {all}{more}"),
            format!("아직 판별할 수 없습니다: {all_ko}{more_ko}"),
        ],
    }
}

fn unlike_any([said, said_ko]: &Both) -> Both {
    [
        format!(
            "like no fault that is known: examine cables, connectors and the bench first; {said}"
        ),
        format!("알려진 고장과 다릅니다. 케이블, 커넥터, 시험대를 먼저 점검하십시오; {said_ko}"),
    ]
}

/// Advice where no check tells the likely parts apart.
fn swap(conclusion: &Conclusion, names: &[Lru]) -> Both {
    let likeliest = conclusion.parts().into_iter().next();
    let of_bench = |part: &LruId| {
        names
            .iter()
            .any(|known| known.of_bench && known.id == *part)
    };
    match likeliest.map(|part| (of_bench(&part), called(&part, names))) {
        None => [
            "no check tells more".to_owned(),
            "더 알려 줄 점검이 없습니다".to_owned(),
        ],
        Some((true, [part, part_ko])) => [
            format!("no check tells more: examine {part} and run again what failed"),
            format!("더 알려 줄 점검이 없습니다: {part_ko} 점검 후 불합격 항목을 다시 시험합니다"),
        ],
        Some((false, [part, part_ko])) => [
            format!("no check tells more: swap {part} and run again what failed"),
            format!("더 알려 줄 점검이 없습니다: {part_ko} 교환 후 불합격 항목을 다시 시험합니다"),
        ],
    }
}

fn run_next(next: &NextCheck, names: &[Lru]) -> Both {
    let [again, again_ko] = if next.again {
        [" again", " 다시"]
    } else {
        [""; 2]
    };
    let tells = tells(next, names).map(|tells| match &*tells {
        "" => String::new(),
        tells => format!(": {tells}"),
    });
    let time_s = next.cost_s.ceil();
    let ([check, check_ko], [tells, tells_ko]) = (checked(&next.check), tells);
    [
        format!("next, run{again} {check} ({time_s:.0} s){tells}"),
        format!("다음 점검:{again_ko} {check_ko} ({time_s:.0}초){tells_ko}"),
    ]
}

/// Meaning of a check that passes where some parts have failed, and does not pass where others have.
pub(super) fn tells(next: &NextCheck, names: &[Lru]) -> Both {
    let all = |parts: &[LruId]| {
        let named: Vec<_> = parts.iter().map(|part| called(part, names)).collect();
        one_or_other(&named)
    };
    let (passes, fails) = (&next.passes_with, &next.fails_with);
    let ([passed, passed_ko], [failed, failed_ko]) = (all(passes), all(fails));
    match (passes.is_empty(), fails.is_empty()) {
        (true, true) => Both::default(),
        (false, true) => [
            format!("it passes if the fault is in {passed}"),
            format!("{passed_ko} 고장이면 합격합니다"),
        ],
        (true, false) => [
            format!("it fails if the fault is in {failed}, and passes if not"),
            format!("{failed_ko} 고장이면 불합격, 아니면 합격합니다"),
        ],
        (false, false) => [
            format!("it passes if the fault is in {passed}, and fails if it is in {failed}"),
            format!("{passed_ko} 고장이면 합격, {failed_ko} 고장이면 불합격합니다"),
        ],
    }
}

/// Named parts of which one has failed.
fn one_or_other(named: &[Both]) -> Both {
    joined(named, [" or ", " 또는 "])
}

/// Named parts with these words between them.
fn joined(named: &[Both], words: [&str; 2]) -> Both {
    [0, 1].map(|language| {
        let named: Vec<_> = named.iter().map(|part| &*part[language]).collect();
        named.join(words[language])
    })
}

/// Parts by their names alone, within a sentence.
pub(super) fn all_called(parts: &[LruId], names: &[Lru]) -> Both {
    let parts: Vec<_> = parts.iter().map(|part| called(part, names)).collect();
    joined(&parts, [" and ", ", "])
}

/// A part by its name alone, within a sentence.
fn called(part: &LruId, names: &[Lru]) -> Both {
    let known = names.iter().find(|known| known.id == *part);
    known.map_or_else(
        || [part.to_string(), part.to_string()],
        |known| [in_sentence(&known.name), known.name_ko.clone()],
    )
}

/// A part by its name, with the identifier that commands take and its probability; by the identifier alone where the
/// catalogue has no name.
fn named(part: &LruId, probability: Option<f64>, names: &[Lru]) -> Both {
    let sure = probability.map(percent);
    let Some(known) = names.iter().find(|known| known.id == *part) else {
        let id = sure.map_or_else(|| part.to_string(), |sure| format!("{part} ({sure})"));
        return [id.clone(), id];
    };
    let apart = sure.map_or_else(String::new, |sure| format!(", {sure}"));
    let with_id = |name: &str| format!("{name} ({part}{apart})");
    [with_id(&in_sentence(&known.name)), with_id(&known.name_ko)]
}

/// An English name within a sentence: "the EB relay", "speed sensor 1", "the VVVF inverter of car 2".
fn in_sentence(name: &str) -> String {
    let within = names::within_a_sentence(name);
    match name.ends_with(|last: char| last.is_ascii_digit()) && !name.contains(" of car ") {
        true => within,
        false => format!("the {within}"),
    }
}

fn percent(probability: f64) -> String {
    format!("{:.1} %", 100.0 * probability)
}

#[cfg(test)]
mod tests;
