//! Names of parts and faults: "EB relay · code 25: EB reaction 640 ms, limit 472".

use btu_rig::procedure::finding::{Finding, Findings, LimitMissed};
use btu_rig::procedure::spoken;
use btu_rig::stimulus::number;
use protocol::event::Event;
use protocol::injection::Lru;
use protocol::lru::from_stored;

use crate::words::{Language, Words, fill};
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::stored::findings;

/// Between the parts of a name.
pub const DOT: &str = " · ";

/// Names of the parts, for people.
#[derive(Clone, Debug, Default)]
pub struct PartNames(Vec<Lru>);

impl PartNames {
    /// Names of the parts in a scripts directory; none where its catalogue cannot be read, and parts go by their
    /// identifiers.
    pub fn of(scripts: &ScriptsDirectory) -> Self {
        Self(scripts.faults().map(|all| all.lrus).unwrap_or_default())
    }

    /// Name of a part in this language, or words for an unknown part.
    pub fn name<'a>(&'a self, id: &'a str, language: Language) -> &'a str {
        if !id.is_empty() && from_stored(id).is_none() {
            return language.words().common.no_part;
        }
        let known = self.0.iter().find(|part| part.id == id);
        known.map_or(id, |part| language.choose([&part.name, &part.name_ko]))
    }

    /// A fault of this part in one line: the name of the part, and what was seen, from the stored data and message.
    pub fn fault(&self, part: &str, stored: (&Option<String>, &str), words: &Words) -> String {
        let part = self.name(part, words.language);
        let what = seen_in_short(stored, words);
        match what.is_empty() {
            true => part.to_owned(),
            false => format!("{part}{DOT}{what}"),
        }
    }
}

/// Finding of a fault in few words.
pub fn seen_in_short((data, message): (&Option<String>, &str), words: &Words) -> String {
    let seen = findings(data);
    match seen.is_empty() {
        true => words.content(message).into_owned(),
        false => what_failed(&seen, words),
    }
}

/// Number of the repetition of this step that failed, if the finding is such a failure.
pub fn failed_turn(seen: &Findings, procedure: &str, step: &str) -> Option<u32> {
    seen.iter().find_map(|found| match &found.finding {
        Finding::CheckFailed {
            procedure: of,
            step: name,
            turn,
            ..
        } if of == procedure && name == step => Some(*turn),
        _ => None,
    })
}

/// Finding in few words: the step, the measured value and its limit, or why else the step failed.
fn what_failed(seen: &Findings, words: &Words) -> String {
    let failed = seen.iter().find_map(|found| match &found.finding {
        Finding::CheckFailed { step, findings, .. } => Some((step, findings)),
        _ => None,
    });
    let Some((step, why)) = failed else {
        return words.findings(seen);
    };
    let step = words.content(step);
    let step = step.split(": ").next().unwrap_or_default();
    let why = match why.iter().next().map(|found| &found.finding) {
        Some(Finding::LimitMissed(missed)) => beyond_limit(missed, words),
        _ => words.findings(why),
    };
    format!("{step}: {why}")
}

/// A measured value with its limit.
fn beyond_limit(missed: &LimitMissed, words: &Words) -> String {
    let LimitMissed {
        measurement: name,
        value,
        low,
        high,
        unit,
        ..
    } = missed;
    let limit = match (low.map(number), high.map(number)) {
        (Some(low), Some(high)) => format!("{low}…{high}"),
        (Some(low), None) => format!("≥ {low}"),
        (None, high) => high.unwrap_or_default(),
    };
    let limit = fill(words.common.limit_is, &[("limit", &limit)]);
    let value = format!("{} {}", number(*value), words.unit(unit));
    let name = measurement(name, words);
    format!("{name} {}, {limit}", value.trim_end())
}

/// A measurement's name for people; without a wording, the name in the script as plain words.
pub fn measurement(name: &str, words: &Words) -> String {
    let known = words.measurement(name);
    if known != name {
        return known.into_owned();
    }
    spoken(name)
}

/// Name of a signal for people.
pub fn signal(name: &str, words: &Words) -> String {
    match words.language {
        Language::English => spoken(name),
        Language::Korean => words.signal(name).into_owned(),
    }
}

/// Meaning of a fault's code: the event's text, or the stored name as words for a fault that a tester found.
pub fn event(code: i64, name: &str, words: &Words) -> String {
    let known = u16::try_from(code).ok().and_then(Event::from_code);
    let text = known.map(Event::definition);
    let text = text.map(|event| words.choose([event.text, event.text_ko]));
    let by_name = || words.content(&spoken(name)).into_owned();
    text.map_or_else(by_name, str::to_owned)
}

/// Meaning of a fault, by its stored name.
pub fn event_named(name: &str, words: &Words) -> String {
    let code = Event::from_name(name).map(|event| event.definition().code);
    event(code.unwrap_or_default().into(), name, words)
}

/// A fault's code with what it means.
pub fn code(code: i64, name: &str, words: &Words) -> String {
    format!("{code} {}", event(code, name, words))
}

#[cfg(test)]
mod tests {
    use btu_rig::procedure::plan::{Comparison, Condition, Operand};
    use protocol::signal::Signal;

    use super::*;

    fn failed(procedure: &str, step: &str, found: Vec<Finding>) -> Findings {
        let mut findings = Findings::default();
        findings.extend(found);
        Finding::CheckFailed {
            procedure: procedure.into(),
            step: step.into(),
            turn: 1,
            turns: 1,
            findings,
        }
        .into()
    }

    fn missed(name: &str, value: f64, limits: [Option<f64>; 2], unit: &str) -> Finding {
        Finding::LimitMissed(LimitMissed {
            measurement: name.into(),
            value,
            uncertainty: None,
            low: limits[0],
            high: limits[1],
            unit: unit.into(),
        })
    }

    #[test]
    fn a_failed_check_is_said_in_one_line_and_other_findings_as_they_are() {
        let [english, korean] = Language::ALL.map(Language::words);
        let reaction = missed("eb_reaction", 640.0, [None, Some(472.0)], "ms");
        let relay = failed("atp/overspeed", "code 25: alarm, FSB, EB", vec![reaction]);
        let said = what_failed(&relay, english);
        assert_eq!(said, "code 25: EB reaction 640 ms, limit 472");
        let said = what_failed(&relay, korean);
        assert_eq!(said, "속도 코드 25: EB 반응 시간 640 ms, 허용 472");
        let whole = "atp/overspeed, 속도 코드 25: 경보, FSB, EB 작동: EB 반응 시간 = 640 (허용 472 ms 이하)";
        assert_eq!(korean.findings(&relay), whole);
        let proof = missed("proof_time", 3400.0, [Some(2950.0), Some(3050.0)], "ms");
        let proof = failed(
            "atp/overspeed",
            "FSB without effect is followed by EB",
            vec![proof],
        );
        let expected = "FSB without effect is followed by EB: proof time 3400 ms, limit 2950…3050";
        assert_eq!(what_failed(&proof, english), expected);
        let condition = Condition::Compare {
            signal: Signal::TwcOk,
            comparison: Comparison::Equal,
            operand: Operand::Literal(0.0),
        };
        let lost = vec![
            Finding::CameTrue { condition },
            missed("received", 7.0, [Some(10.0), Some(10.0)], "frames"),
        ];
        let lost = failed("twc/exchange", "over the loop", lost);
        let expected =
            "over the loop: TWC ok = off came true; received = 7, allowed 10 to 10 frames";
        assert_eq!(what_failed(&lost, english), expected);
        let said = what_failed(&lost, korean);
        assert!(
            said.contains("TWC 통신 정상 = 꺼짐") && said.contains("전문"),
            "{said}"
        );
        let turn = |step| failed_turn(&relay, "atp/overspeed", step);
        assert_eq!(turn("code 25: alarm, FSB, EB"), Some(1));
        assert_eq!(turn("another"), None);
        let none = (&None, "brake line at 3.0 km/h");
        assert_eq!(
            PartNames::default().fault("x", none, english),
            "x · brake line at 3.0 km/h"
        );
    }

    #[test]
    fn a_code_is_said_by_what_it_means() {
        let [english, korean] = Language::ALL.map(Language::words);
        assert_eq!(event(9000, "check_failed", english), "check failed");
        assert_eq!(event(9000, "check_failed", korean), "점검 불합격");
        assert_eq!(code(9000, "check_failed", english), "9000 check failed");
        let dead = "221 속도센서 1 무신호";
        assert_eq!(code(221, "tacho1_dead", korean), dead);
    }
}
