//! What people call parts and faults: "EB relay · code 25: EB reaction 640 ms, limit 472".

use protocol::event::Event;
use protocol::injection::Lru;
use protocol::lru::from_stored;

use crate::words::{Language, Words, fill};
use ptu_runs::data::ScriptsDirectory;

/// Between the parts of a name.
pub const DOT: &str = " · ";
/// What is written in capitals wherever it stands.
const CAPITALS: [&str; 8] = ["eb", "fsb", "atp", "ato", "twc", "psm", "tcms", "tra"];

/// What people call the parts.
#[derive(Clone, Debug, Default)]
pub struct PartNames(Vec<Lru>);

impl PartNames {
    /// Those of a scripts directory; none where its catalogue cannot be read, and parts go by their identifiers.
    pub fn of(scripts: &ScriptsDirectory) -> Self {
        Self(scripts.faults().map(|all| all.lrus).unwrap_or_default())
    }

    /// What a part is called in this language, or that it is not known which one it is.
    pub fn name<'a>(&'a self, id: &'a str, language: Language) -> &'a str {
        if !id.is_empty() && from_stored(id).is_none() {
            return language.words().common.no_part;
        }
        let known = self.0.iter().find(|part| part.id == id);
        known.map_or(id, |part| match language {
            Language::English => &part.name,
            Language::Korean => &part.name_ko,
        })
    }

    /// A fault that points at this part, in one line: the part, and what was seen.
    pub fn fault(&self, part: &str, message: &str, words: &Words) -> String {
        let part = self.name(part, words.language);
        match what_failed(message, words) {
            what if what.is_empty() => part.to_owned(),
            what => format!("{part}{DOT}{what}"),
        }
    }
}

/// Procedure and step of the message of a failed check, and what stands after them.
pub fn place(message: &str) -> Option<(&str, &str, &str)> {
    let (procedure, rest) = message.split_once(", ")?;
    let (left, value) = rest.split_once(" = ")?;
    let (step, name) = left.rsplit_once(": ")?;
    let after = &rest[rest.len() - value.len() - name.len() - " = ".len()..];
    procedure.contains('/').then_some((procedure, step, after))
}

/// A message in few words: the step, the measured value, and its limit, or why else it failed; as it is where it names no
/// step.
pub fn what_failed(message: &str, words: &Words) -> String {
    let Some((_, step, why)) = place(message) else {
        return words.content(message).into_owned();
    };
    let step = words.content(step);
    let step = step.split(": ").next().unwrap_or_default();
    let why = beyond_limit(why, words).unwrap_or_else(|| words.content(why).into_owned());
    format!("{step}: {why}")
}

/// A measured value with its limit; `None` for a condition.
fn beyond_limit(measured: &str, words: &Words) -> Option<String> {
    let (name, value) = measured.split_once(" = ")?;
    let (value, limits) = value.split_once(", allowed ")?;
    value.parse::<f64>().ok()?;
    let limits = limits.split_once("; ").map_or(limits, |(first, _)| first);
    let (limits, unit) = match limits.rsplit_once(' ') {
        Some((limits, unit)) if unit.parse::<f64>().is_err() => (limits, unit),
        _ => (limits, ""),
    };
    let limit = limits.replace("at most ", "").replace(" to ", "…");
    let limit = fill(
        words.common.limit_is,
        &[("limit", &limit.replace("at least ", "≥ "))],
    );
    let value = format!("{value} {unit}");
    let name = measurement(name, words);
    Some(format!("{name} {}, {limit}", value.trim_end()))
}

/// A measurement's name without what only scripts write.
pub fn measurement(name: &str, words: &Words) -> String {
    let known = words.measurement(name);
    if known != name {
        return known.into_owned();
    }
    spoken(name)
}

/// What a signal is called.
pub fn signal(name: &str, words: &Words) -> String {
    match words.language {
        Language::English => spoken(name),
        Language::Korean => words.signal(name).into_owned(),
    }
}

/// An identifier as words.
pub(crate) fn spoken(name: &str) -> String {
    let word = |word: &str| match CAPITALS.contains(&word) {
        true => word.to_uppercase(),
        false => word.to_owned(),
    };
    let said: Vec<String> = name.split('_').map(word).collect();
    said.join(" ")
}

/// What a fault's code means: the event's text, or the stored name as words for a fault that a tester found.
pub fn event(code: i64, name: &str, words: &Words) -> String {
    let known = u16::try_from(code).ok().and_then(Event::from_code);
    let text = known.map(|event| match words.language {
        Language::English => event.definition().text,
        Language::Korean => event.definition().text_ko,
    });
    let by_name = || words.content(&spoken(name)).into_owned();
    text.map_or_else(by_name, str::to_owned)
}

/// What a fault means, by its stored name.
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
    use super::*;

    #[test]
    fn a_failed_check_is_said_in_one_line_and_other_messages_as_they_are() {
        let words = Language::English.words();
        let said = |message: &str| what_failed(message, words);
        let relay =
            "atp/overspeed, code 25: alarm, FSB, EB: eb_reaction = 640, allowed at most 472 ms";
        assert_eq!(said(relay), "code 25: EB reaction 640 ms, limit 472");
        let proof = "atp/overspeed, FSB without effect is followed by EB: proof_time = 3400, allowed 2950 to 3050 ms";
        let expected = "FSB without effect is followed by EB: proof time 3400 ms, limit 2950…3050";
        assert_eq!(said(proof), expected);
        let condition = "twc/exchange, over the loop: twc_ok = off came true; received = 7, allowed 10 to 10 frames";
        let expected =
            "over the loop: TWC ok = off came true; received = 7, allowed 10 to 10 frames";
        assert_eq!(said(condition), expected);
        let korean = what_failed(condition, Language::Korean.words());
        assert!(korean.contains("TWC 통신 정상 = 꺼짐"), "{korean}");
        let event = "brake line at 3.0 km/h, limit 25.0 km/h";
        assert_eq!(said(event), event);
        let korean = what_failed(relay, Language::Korean.words());
        assert_eq!(korean, "속도 코드 25: EB 반응 시간 640 ms, 허용 472");
        let korean = Language::Korean.words().content(relay);
        let whole = "atp/overspeed, 속도 코드 25: 경보, FSB, EB 작동: EB 반응 시간 = 640 (허용 472 ms 이하)";
        assert_eq!(korean, whole);
        let place = place(relay).expect("a step");
        assert_eq!(
            (place.0, place.1),
            ("atp/overspeed", "code 25: alarm, FSB, EB")
        );
        assert_eq!(
            PartNames::default().fault("eb_relay", "", words),
            "eb_relay"
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
