//! Texts of procedures that have no Korean: a Korean reader sees them in English until they are added to
//! `korean.toml`.

use std::collections::BTreeSet;

use btu_rig::procedure::Procedure;
use btu_rig::procedure::origin::{Origin, SEPARATOR, SourceKind};

use crate::words::Language;

/// Names of steps and measurements, notes, and reasons of limits that have no Korean.
pub fn without_korean(procedure: &Procedure) -> BTreeSet<String> {
    let words = Language::Korean.words();
    let is_missing = |text: &str| is_said(text) && words.content(text) == text;
    let mut missing = BTreeSet::new();
    for step in &procedure.steps {
        let lacks = step.lacks.as_ref().or(procedure.lacks.as_ref());
        let texts = [Some(&step.name), step.note.as_ref(), lacks];
        let texts = texts.into_iter().flatten().cloned();
        missing.extend(texts.filter(|text| is_missing(text)));
        let names = step.measures.iter().map(|measure| &measure.name);
        let is_unnamed = |name: &&String| is_said(name) && words.measurement(name) == **name;
        missing.extend(names.filter(is_unnamed).cloned());
        let measured = step.measures.iter().map(|measure| &measure.origin);
        let reasons = measured.chain([&step.origin]).flat_map(reasons);
        missing.extend(reasons.filter(|reason| is_missing(reason)));
    }
    missing
}

/// The reasons among the sources of a limit; the others name a paper, a file or a standard.
fn reasons(origin: &Origin) -> Vec<String> {
    let said = origin.text().unwrap_or_default();
    let sources = said.split(SEPARATOR).filter_map(SourceKind::split);
    let reasons = sources.filter(|(kind, _)| *kind == SourceKind::Default);
    reasons.map(|(_, reason)| reason.to_owned()).collect()
}

/// The text has words of English; numbers, units and signs are alike in both languages.
fn is_said(text: &str) -> bool {
    let mut words = text.split(|letter: char| !letter.is_ascii_lowercase());
    let is_korean = text.chars().any(|letter| ('가'..='힣').contains(&letter));
    !is_korean && words.any(|word| word.len() > 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_words_of_english_is_to_be_said_in_korean() {
        for said in ["code 25: alarm", "eb_reaction", "half a metre"] {
            assert!(is_said(said), "{said}");
        }
        for same in ["", "500 N", "50 mV", "PSM1", "속도 코드 25: alarm"] {
            assert!(!is_said(same), "{same}");
        }
    }
}
