//! Findings of a run in Korean: one sentence for each kind; a kind without a sentence does not
//! compile.

use btu_rig::procedure::EventSource;
use btu_rig::procedure::describe::meanings;
use btu_rig::procedure::event_text;
use btu_rig::procedure::finding::{
    Before, Finding, Findings, LimitMissed, LoggedEvent, MissingData, WaitedFor, WhyNoValue,
};
use btu_rig::procedure::plan::Condition;
use btu_rig::procedure::runner::ATTEMPTS;
use btu_rig::stimulus::number;
use fault_db::StepKind;
use protocol::event::{Event, LOG_ENTRIES};
use protocol::message::{ArmRefusal, SelfTest};

use super::super::{KOREAN, content};
use super::condition;
use ptu_runs::words::link_korean;

pub fn findings(all: &Findings) -> String {
    let said: Vec<_> = all
        .iter()
        .map(|found| match found.times {
            1 => korean(&found.finding),
            times => format!("{} ({times}회)", korean(&found.finding)),
        })
        .collect();
    said.join("; ")
}

/// A measurement by its name in Korean.
fn measured(name: &str) -> String {
    KOREAN.measurement(name).into_owned()
}

/// Korean of a text of scripts, catalogues or the runner, if it is known, else the text.
fn told(text: &str) -> String {
    content::korean(text).into_owned()
}

fn missing(data: &MissingData) -> String {
    match data {
        MissingData::Signal(signal) => format!("{} 데이터 없음", condition::name(*signal)),
        MissingData::Measurement => "앞선 측정에 값이 없음".to_owned(),
    }
}

/// The reason, as an addition to a sentence.
fn because(why: Option<String>) -> String {
    why.map_or_else(String::new, |why| format!(". {why}"))
}

pub fn korean(finding: &Finding) -> String {
    match finding {
        Finding::LimitMissed(missed) => limit_missed(missed),
        Finding::NeverBecame {
            condition: never,
            within,
            seen,
            missing: data,
            said,
        } => {
            let seen = seen.map_or_else(String::new, |bits| seen_bits(never, bits));
            let why = data.as_ref().map(missing).or(said.as_deref().map(told));
            let never = condition::korean(never);
            format!(
                "{within} 이내에 성립하지 않음: {never}{seen}{}",
                because(why)
            )
        }
        Finding::HeldOnlyFor {
            condition: held_true,
            held,
            missing: data,
        } => {
            let why = because(data.as_ref().map(missing));
            format!(
                "{held} 동안만 유지됨: {}{why}",
                condition::korean(held_true)
            )
        }
        Finding::CameTrue { condition: came } => {
            format!(
                "성립해서는 안 되는 조건이 성립함: {}",
                condition::korean(came)
            )
        }
        Finding::Unknown {
            condition: never,
            missing: data,
        } => format!(
            "{}: 다음 조건이 성립했는지 판정할 수 없음: {}",
            missing(data),
            condition::korean(never)
        ),
        Finding::NotLogged {
            event,
            parameter,
            within,
        } => format!(
            "{within} 이내에 {} 고장 기록에 {} 없음",
            condition::who(EventSource::of(*event)),
            condition::logged(*event, *parameter)
        ),
        Finding::Logged { event } => format!(
            "{} 고장 기록: {}",
            condition::who(EventSource::of(*event)),
            event.definition().text_ko
        ),
        Finding::Unprovoked(event) => {
            format!("{} (어느 단계에서도 유발하지 않음)", logged(event))
        }
        Finding::BrakeApplied => "이 단계에서 요구하지 않은 비상제동이 체결됨".to_owned(),
        Finding::SaidNo { question } => format!("시험자가 아니라고 응답함: {}", told(question)),
        Finding::NoAnswer { question } => format!("시험자가 응답하지 않음: {}", told(question)),
        Finding::NeedsOperator { question } => format!("시험자가 필요함: {}", told(question)),
        Finding::NoValue {
            measurement,
            others,
            why,
        } => no_value(measurement, *others, why),
        Finding::LimitUnknown { measurement } => {
            format!("{}: 값이 없는 측정을 한계로 참조함", measured(measurement))
        }
        Finding::Refused { why } | Finding::Told(why) => told(why),
        Finding::Prevented { korean, .. } => korean.clone(),
        Finding::NotToldByUnit { software, signals } => {
            let software = software
                .iter()
                .map(|version| format!(" (소프트웨어 {version})"));
            let signals: Vec<_> = signals.iter().map(|name| told(name)).collect();
            format!(
                "이 장치{}가 알리지 않는 신호: {}",
                software.collect::<String>(),
                signals.join(", ")
            )
        }
        Finding::StartedAgain => "장치가 다시 시작됨: 전원이 차단되었음".to_owned(),
        Finding::TestModeEnded { refusal } => {
            let label = ArmRefusal::from_code(*refusal).label();
            let why = condition::state("arm_refusal", label);
            format!(
                "장치가 시험을 스스로 종료함: {}",
                why.unwrap_or_else(|| label.to_owned())
            )
        }
        Finding::NotFinished { within } => {
            format!("{within} 이내에 주행 또는 시험기 요청이 끝나지 않음")
        }
        Finding::LineDisturbed { event } => {
            let what = event.as_ref().map(logged);
            let what = what.unwrap_or_else(|| "비상제동이 체결됨".to_owned());
            format!(
                "시험기와 장치 사이의 전문이 전달되지 않는 동안 발생: {what}. 회선을 점검하고 다시 시험하십시오"
            )
        }
        Finding::FramesLost { frames } => format!(
            "그동안 시험기와 장치 사이의 전문 {frames}개가 전달되지 않음. 회선을 점검하고 다시 시험하십시오"
        ),
        Finding::LogNotRead { within } => {
            format!("{within} 이내에 장치의 고장 기록을 읽지 못하여 기록 내용을 알 수 없음")
        }
        Finding::LogNotReadToEnd { within } => {
            format!("{within} 이내에 장치의 고장 기록을 끝까지 읽지 못함")
        }
        Finding::TimeLimit { limit, waiting } => match waiting {
            None => format!("제한 시간 {limit} 초과"),
            Some(WaitedFor::Actions) => format!("제한 시간 {limit} 초과: 동작이 끝나지 않음"),
            Some(WaitedFor::Expectation(expected)) => {
                let expected = condition::expectation(expected);
                format!("제한 시간 {limit} 초과: 기다린 조건 {expected}")
            }
        },
        Finding::LinkLost { why } if why.is_of_the_bench() => link_korean(why),
        Finding::LinkLost { why } => format!("장치와의 통신: {}", link_korean(why)),
        Finding::StoodStill { by, attempt } => {
            let by = by.as_secs();
            let then = match *attempt < ATTEMPTS {
                true => format!("단계를 다시 시험합니다 ({}/{ATTEMPTS})", attempt + 1),
                false => "다른 프로그램을 종료하고 연결을 점검한 뒤 다시 시험하십시오".to_owned(),
            };
            format!(
                "{ATTEMPTS}회 중 {attempt}회째 시도에서 시험하지 못함: 시험기 PC 또는 연결이 {by:.2} s 동안 멈춤 (장치의 결함이 아님); {then}"
            )
        }
        Finding::BeforeStandstill(what) => {
            format!("시험기 PC 또는 연결이 멈추기 전: {}", korean(what))
        }
        Finding::InSetUp(what) => format!("준비: {}", korean(what)),
        Finding::InCleanUp(what) => format!("종료 처리: {}", korean(what)),
        Finding::CleanUpTooLong { within } => format!("종료 처리가 {within} 이내에 끝나지 않음"),
        Finding::CleanUpCutShort => "시험자가 종료 처리를 단축함".to_owned(),
        Finding::NotSafe { within } => {
            format!("{within}이 지나도 출력 안전화가 확인되지 않음")
        }
        Finding::Stopped => "시험자가 정지함".to_owned(),
        Finding::NotRun(why) => format!("시험 안 함: {}", korean(why)),
        Finding::NotBegun(why) => format!("시작 안 함: {}", korean(why)),
        Finding::NotPassed { step } => format!("\"{}\" 단계가 합격하지 못함", told(step)),
        Finding::NotTestedBefore { step } => {
            format!("앞 단계 \"{}\"을(를) 시험하지 못함", told(step))
        }
        Finding::NeedsHarness => "시험대 하네스가 필요하며, 정비 포트만 연결되어 있음".to_owned(),
        Finding::ConditionFalse { said } => {
            let said = said.as_deref().map(told);
            said.unwrap_or_else(|| "시험 조건이 성립하지 않음".to_owned())
        }
        Finding::ConditionUnknown { missing: data } => format!("시험 조건: {}", missing(data)),
        Finding::NoStepToRun => "시험할 단계 없음".to_owned(),
        Finding::NoStepRun => "수행한 단계 없음".to_owned(),
        Finding::ProgramFailed => "시험 중 프로그램 오류가 발생함".to_owned(),
        Finding::LinkLostAt {
            run,
            of,
            left,
            instrument,
            bench,
        } => {
            let bench = bench
                .as_ref()
                .map_or_else(String::new, |name| format!("{name} "));
            let what = instrument.as_ref().map_or_else(
                || "연결 끊김".to_owned(),
                |name| format!("시험대 {bench}계측기 {name} 고장"),
            );
            match run {
                0 => format!("{of}개 단계 시작 전에 {what}"),
                _ => format!("{of}개 단계 중 {run}번째에서 {what}; {left}개 미실행"),
            }
        }
        Finding::NotAcceptance { run, of } => {
            format!("인수 판정이 아님: {of}개 단계 중 {run}개 수행, 모두 합격")
        }
        Finding::SelfTestFailed { items } => {
            let items = told(&meanings(&SelfTest::SPEC, *items));
            format!("장치가 자체시험 불합격을 알림: {items}")
        }
        Finding::TooManyEvents { more } => format!(
            "어느 단계에서도 유발하지 않은 이벤트가 장치에 {LOG_ENTRIES}건 넘게 기록됨. 저장하지 않은 기록 {more}건 더 있음"
        ),
        Finding::ClockWrong { by_permille } => {
            let way = if *by_permille > 0 { "빠름" } else { "느림" };
            let percent = f64::from(by_permille.abs()) / 10.0;
            format!("장치의 시계가 시험기보다 {percent:.1} % {way}")
        }
        Finding::FoundBefore { fault, before } => {
            let before = match before {
                Before::FirstStep => "첫 단계 전에",
                Before::RepeatedStep => "단계를 다시 시험하기 전에",
                Before::Repetition => "다음 반복 전에",
            };
            let named = Event::from_name(fault).map(|event| event.definition().text_ko.to_owned());
            let fault = named.unwrap_or_else(|| told(&fault.replace('_', " ")));
            format!("{before} 발견: {fault}")
        }
        Finding::Event {
            event,
            speed_kmh,
            limit_kmh,
            time_s,
        } => {
            let (what, who) = (happened(event), condition::who(event.source));
            format!(
                "{what}, 속도 {speed_kmh:.1} km/h, 제한 속도 {limit_kmh:.1} km/h, {who} 시각 {time_s:.3} s"
            )
        }
        Finding::CheckFailed {
            procedure,
            step,
            turn,
            turns,
            findings: found,
        } => {
            let step = KOREAN.step(step, [*turn, *turns], StepKind::Step);
            format!("{procedure}, {step}: {}", findings(found))
        }
        Finding::More { n } => format!("그 외 {n}건"),
    }
}

fn limit_missed(missed: &LimitMissed) -> String {
    let in_unit = |value: f64| match KOREAN.unit(&missed.unit) {
        "" => number(value),
        unit => format!("{} {unit}", number(value)),
    };
    let allowed = match (missed.low, missed.high) {
        (None, None) => String::new(),
        (Some(low), None) => format!(" (허용 {} 이상)", in_unit(low)),
        (None, Some(high)) => format!(" (허용 {} 이하)", in_unit(high)),
        (Some(low), Some(high)) => format!(" (허용 {} ~ {})", number(low), in_unit(high)),
    };
    let off = missed.uncertainty.map(|off| format!(" ± {}", number(off)));
    let (name, value) = (measured(&missed.measurement), number(missed.value));
    format!("{name} = {value}{}{allowed}", off.unwrap_or_default())
}

fn no_value(measurement: &str, others: u32, why: &WhyNoValue) -> String {
    let name = match others {
        0 => measured(measurement),
        others => format!("{} 외 {others}개", measured(measurement)),
    };
    match why {
        WhyNoValue::Missing(data) => format!("{name}: {}", missing(data)),
        WhyNoValue::NotMeasured => format!("{name}: 값 없음"),
        WhyNoValue::NeverEnded(end) => {
            format!(
                "{name}: 값 없음, 시간 안에 성립하지 않음: {}",
                condition::korean(end)
            )
        }
    }
}

fn seen_bits(of: &Condition, bits: u16) -> String {
    let Condition::Compare { signal, .. } = of else {
        return String::new();
    };
    condition::bits(*signal, bits).map_or_else(String::new, |bits| format!(" (실제 {bits})"))
}

/// Sentence on a logged event: who logged it, and which it is.
fn logged(entry: &LoggedEvent) -> String {
    let (who, code) = (condition::who(entry.source), entry.code);
    let Some(event) = entry.event() else {
        return format!("{who} 고장 기록: 알 수 없는 이벤트 ({code})");
    };
    let named = event_text::named(event, entry.parameter);
    let named = named.map_or_else(String::new, |named| format!(", {}", told(&named)));
    format!(
        "{who} 고장 기록: {} ({code}{named})",
        event.definition().text_ko
    )
}

/// Event, with its parameter, as text.
fn happened(entry: &LoggedEvent) -> String {
    let Some(event) = entry.event() else {
        return format!("알 수 없는 이벤트 {} (값 {})", entry.code, entry.parameter);
    };
    let text = event.definition().text_ko;
    match condition::parameter(event, entry.parameter) {
        said if said.is_empty() => text.to_owned(),
        said => format!("{text} ({said})"),
    }
}

#[cfg(test)]
mod tests;
