//! Ends of automatic runs, and events on the way.

use btu_rig::drive::{Ending, Mark};
use btu_rig::procedure::describe::meanings;
use protocol::event::Event;
use protocol::message::Refusals;

use super::super::{Language, Words, content};
use super::condition;
use ptu_runs::words::link_korean;

impl Words {
    /// Sentence that says how a drive ended.
    pub fn ending(&self, ending: &Ending) -> String {
        match self.language {
            Language::English => ending.to_string(),
            Language::Korean => korean(ending),
        }
    }

    /// An event on the way of a train.
    pub fn mark(&self, mark: &Mark) -> String {
        match self.language {
            Language::English => mark.to_string(),
            Language::Korean => passed(mark),
        }
    }
}

fn told(label: &str) -> String {
    content::korean(&label.replace('_', " ")).into_owned()
}

fn behind(what: &str, why: Option<String>) -> String {
    why.map_or_else(|| what.to_owned(), |why| format!("{what}: {why}"))
}

fn korean(ending: &Ending) -> String {
    let lacking = |bits: &Option<u16>| bits.map(|bits| told(&meanings(&Refusals::SPEC, bits)));
    match ending {
        Ending::Stopped => "정차".to_owned(),
        Ending::Refused(why) => format!("시험대가 거부함: {}", told(why)),
        Ending::NeverReady { refusals } => behind(
            "출발 준비 안 됨: ATP가 자동 모드로 전환하지 않음",
            lacking(refusals),
        ),
        Ending::NeverStarted { refusals } => behind(
            "출발하지 않음: ATP가 자동 주행 모드로 전환하지 않음",
            lacking(refusals),
        ),
        Ending::NeverLeft => "출발하지 않음: 자동 주행 모드에서 움직이지 않음".to_owned(),
        Ending::EmergencyBrake { cause } => {
            behind("비상제동", cause.map(|cause| told(cause.label())))
        }
        Ending::LeftAutomatic { mode } => {
            let mode = mode.and_then(|mode| condition::state("mode", mode.label()));
            let mode = mode.map(|mode| format!("운전 모드 {mode}"));
            behind("주행 중 자동 주행 모드에서 벗어남", mode)
        }
        Ending::TimeLimit => "제한 시간 초과: 아직 주행 중".to_owned(),
        Ending::LinkLost(why) => format!("통신 두절: {}", link_korean(why)),
    }
}

fn passed(mark: &Mark) -> String {
    match mark {
        Mark::Psm(psm) => format!("PSM{psm} 통과"),
        Mark::Reached(kmh) => format!("{kmh:.0} km/h 도달"),
        Mark::Limit(kmh) => format!("제한 속도 {kmh:.0} km/h"),
        Mark::StopCurve => "정차 곡선으로 전환".to_owned(),
        Mark::Stop => "정차".to_owned(),
        Mark::Logged(entry) => {
            let who = condition::who(entry.source);
            let Some(event) = entry.event() else {
                return format!("{who}: 알 수 없는 이벤트 {}", entry.code);
            };
            let said = condition::parameter(event, entry.parameter);
            match event {
                Event::ModeChanged => format!("{who}: 운전 모드 {said}"),
                event => {
                    let text = event.definition().text_ko;
                    let said = Some(said).filter(|said| !said.is_empty());
                    behind(&format!("{who}: {text}"), said)
                }
            }
        }
    }
}
