//! Reasons and warnings of a diagnosis, in both languages.

use btu_rig::procedure::{Finding, spoken};
use diagnosis::{FaultText, Known, Repaired, Sign, StepReason};
use fault_db::RunDetail;
use protocol::event::Event;
use ptu_runs::clock::local_day;
use ptu_runs::stored::findings;

use super::super::{Language, content, names};
use super::both::{Both, checked};
use super::finding;

pub(super) fn fault_text(text: &FaultText) -> Both {
    match text {
        FaultText::Mode(text) => [text.clone(), content::korean(text).into_owned()],
        FaultText::Confirmed { cases, units } => [
            match cases {
                1 => format!("as in 1 confirmed case, of {units}"),
                n => format!("as in {n} confirmed cases, of {units}"),
            },
            format!("입증된 수리 {cases}건과 같은 양상 (장치 {units})"),
        ],
        FaultText::Unseen { like: None } => [
            "in a way that is not in the dictionary".to_owned(),
            "사전에 없는 형태의 고장".to_owned(),
        ],
        FaultText::Unseen {
            like: Some((mode, text)),
        } => {
            let [text, text_ko] = fault_text(text);
            [
                format!("in a way that is not in the dictionary, which acts like {mode}: {text}"),
                format!("사전에 없는 형태의 고장, {mode}와(과) 비슷함: {text_ko}"),
            ]
        }
    }
}

/// The step with its value beyond a limit, or else with its first finding, or else with its result.
pub(super) fn step_found(step: &StepReason, run: &RunDetail) -> Both {
    let is_it = |record: &&fault_db::StepRecord| {
        record.procedure == step.check.procedure && record.name == step.check.step
    };
    let record = run.steps.iter().find(is_it);
    let found = record
        .map(|record| findings(&record.findings))
        .unwrap_or_default();
    let missed = |found: &&btu_rig::procedure::finding::Found| {
        matches!(found.finding, Finding::LimitMissed(_))
    };
    let first = found.iter().find(missed).or(found.iter().next());
    let [found, found_ko] = match first {
        Some(found) => [
            format!("{:#}", found.finding),
            finding::korean(&found.finding),
        ],
        None => result(step),
    };
    let check = &step.check.step;
    let check_ko = content::korean(check);
    [
        format!("{check} — {found}"),
        format!("{check_ko} — {found_ko}"),
    ]
}

fn result(step: &StepReason) -> Both {
    let korean = super::super::KOREAN.common.verdict(step.result);
    [step.result.label().to_owned(), korean.to_owned()]
}

/// A step with its result, and what the dictionary expects under the fault and on a healthy unit.
pub(super) fn step_expected(step: &StepReason) -> Both {
    let [under, healthy] = step.shares.map(|share| format!("{:.0} %", 100.0 * share));
    let ([check, check_ko], [came, came_ko]) = (checked(&step.check), result(step));
    let mut said = format!("{check} {came} (under this fault {under}, healthy {healthy})");
    let mut said_ko = format!("{check_ko}: {came_ko} (이 고장일 때 {under}, 정상일 때 {healthy})");
    for sign in &step.signs {
        let ([sign, sign_ko], [part, part_ko]) = (sign_named(sign), points_at(sign));
        said += &format!(", with {sign}, which points at {part}");
        said_ko += &format!(", {sign_ko} (지목 부품: {part_ko})");
    }
    for value in &step.values {
        let seen = value.value.map(|value| value.to_string());
        let range = |none: &str, between: &str| {
            value.ranges.map(|range| match range {
                None => none.to_owned(),
                Some([low, high]) => format!("{low}{between}{high}"),
            })
        };
        let ([own, good], [own_ko, good_ko]) = (range("none", " to "), range("없음", " ~ "));
        let name = crate::naming::measurement(&value.name, Language::English.words());
        let name_ko = crate::naming::measurement(&value.name, Language::Korean.words());
        let [seen, seen_ko] = [
            seen.clone().unwrap_or_else(|| "none".to_owned()),
            seen.unwrap_or_else(|| "없음".to_owned()),
        ];
        said += &format!("; {name} = {seen} (under this fault {own}, healthy {good})");
        said_ko += &format!("; {name_ko} = {seen_ko} (이 고장일 때 {own_ko}, 정상일 때 {good_ko})");
    }
    [said, said_ko]
}

pub(super) fn logged(sign: &Sign) -> Both {
    let ([sign, sign_ko], [part, part_ko]) = (sign_named(sign), points_at(sign));
    [
        format!("the unit's log has {sign}, which points at {part}"),
        format!("장치 고장 기록: {sign_ko} (지목 부품: {part_ko})"),
    ]
}

/// Sentence on the signal that is the first to leave the trace of a sound unit.
pub(super) fn deviated(signal: &str) -> Both {
    let name = crate::naming::signal(signal, Language::English.words());
    let name_ko = crate::naming::signal(signal, Language::Korean.words());
    [
        format!("traces leave a sound unit's first at the signal \"{name}\""),
        format!("신호 기록이 정상 장치와 처음 달라진 신호: {name_ko}"),
    ]
}

/// Sentence on a deviation, with the shares of traces in which the signal deviates first: under the
/// fault, and under any fault.
pub(super) fn deviated_share(signal: &str, shares: [f64; 2]) -> Both {
    let [said, said_ko] = deviated(signal);
    let [own, any] = shares.map(|share| format!("{:.0} %", 100.0 * share));
    [
        format!("{said} (under this fault {own} of traces, under any {any})"),
        format!("{said_ko} (이 고장일 때 기록의 {own}, 모든 고장에서 {any})"),
    ]
}

/// Name of the fault that a sign of the diagnosis consists in.
fn sign_named(sign: &Sign) -> Both {
    match Event::from_name(&sign.fault).map(Event::definition) {
        Some(event) => [
            names::within_a_sentence(event.text),
            event.text_ko.to_owned(),
        ],
        None => {
            let spoken = spoken(&sign.fault);
            let korean = content::korean(&spoken).into_owned();
            [spoken, korean]
        }
    }
}

/// The part that a sign names.
fn points_at(sign: &Sign) -> Both {
    match &sign.lru {
        Some(part) => {
            let [name, name_ko] = names::part(part.as_str());
            [format!("the {name}"), name_ko.to_owned()]
        }
        None => ["no part".to_owned(), "없음".to_owned()],
    }
}

pub(super) fn told(known: &Known) -> Both {
    match known {
        Known::Recurred { runs, since } => {
            let s = if *runs == 1 { "" } else { "s" };
            let since = since.as_ref().map(repaired);
            let [since, since_ko] = since.map_or_else(Both::default, |[since, since_ko]| {
                [
                    format!(" since it was {since}"),
                    format!(" ({since_ko} 이후)"),
                ]
            });
            [
                format!("named by faults in {runs} earlier run{s}{since}"),
                format!("이전 시험 {runs}회의 고장이 지목함{since_ko}"),
            ]
        }
        Known::CameBack(repair) => {
            let [repair, repair_ko] = repaired(repair);
            [
                format!("{repair}, and the fault came back"),
                format!("{repair_ko} 후 고장 재발"),
            ]
        }
        Known::BroughtWith { symptom } => [
            format!("brought with: {symptom}"),
            format!("들어올 때의 증상: {}", content::korean(symptom)),
        ],
        Known::WasRight { right, named } => [
            format!(
                "repaired in {right} of the {named} confirmed repairs for which a diagnosis found it"
            ),
            format!("진단이 지목한 입증된 수리 {named}건 중 {right}건에서 실제 원인"),
        ],
        Known::OftenRepaired { of_part, all } => [
            format!("{of_part} of {all} confirmed repairs were of this part"),
            format!("입증된 수리 {all}건 중 {of_part}건이 이 부품"),
        ],
    }
}

fn repaired(repair: &Repaired) -> Both {
    let day = local_day(repair.at_us);
    match repair.replaced {
        true => [format!("replaced on {day}"), format!("{day} 교체")],
        false => [format!("worked on on {day}"), format!("{day} 수리")],
    }
}
