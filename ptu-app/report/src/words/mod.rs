//! Texts that people read, in both languages: the one catalogue of the window and of printed reports.
//!
//! A missing wording does not compile. Technical words (ATP, EB, FSB, PSM1, signal names …) stay as
//! technicians write them. What scripts, catalogues and the runner say is looked up by [`Words::content`].

mod bench;
mod care;
mod case;
mod common;
mod content;
mod counts;
mod diagnosis;
mod doctor;
mod drive;
mod faults;
mod fill;
mod frame;
mod language;
mod life;
mod memory;
mod names;
mod procedures;
mod report;
mod say;
mod signals;
mod statistics;
mod terminal;
mod traces;
mod verify;

pub use bench::Bench;
pub use case::Case;
pub use content::take_own;
pub use diagnosis::Diagnosis;
pub use doctor::Doctor;
pub use faults::Faults;
pub use fill::fill;
pub use frame::Frame;
pub use language::Language;
pub use say::tell;
pub use traces::Traces;

use std::borrow::Cow;

use btu_rig::procedure::Procedure;
use protocol::signal::Signal;

/// Declares one part of the catalogue: `key: "English", "한국어";` per wording. `{name}` in a wording
/// is filled in by [`fill`].
macro_rules! wordings {
    ($(#[$doc:meta])* $part:ident { $($key:ident: $english:literal, $korean:literal;)* }) => {
        $(#[$doc])*
        #[derive(Debug)]
        pub struct $part { $(#[doc = $english] pub $key: &'static str,)* }

        impl $part {
            pub(super) const ENGLISH: Self = Self { $($key: $english,)* };
            pub(super) const KOREAN: Self = Self { $($key: $korean,)* };

            #[cfg(test)]
            pub(super) fn all() -> Vec<$crate::words::Wording> {
                vec![$((stringify!($key), $english, $korean),)*]
            }
        }
    };
}
use wordings;

/// Declares the catalogue: its parts by name, each of which [`wordings`] declares.
macro_rules! catalogue {
    ($($(#[$doc:meta])* $name:ident: $part:ty,)*) => {
        /// All wordings in one language.
        #[derive(Debug)]
        pub struct Words {
            pub language: Language,
            $($(#[$doc])* pub $name: $part,)*
        }

        static ENGLISH: Words = Words {
            language: Language::English,
            $($name: <$part>::ENGLISH,)*
        };
        static KOREAN: Words = Words {
            language: Language::Korean,
            $($name: <$part>::KOREAN,)*
        };

        /// Parts by name, each with its wordings.
        #[cfg(test)]
        fn parts() -> Vec<(&'static str, Vec<Wording>)> {
            vec![$((stringify!($name), <$part>::all()),)*]
        }
    };
}

/// Key of a wording, and its text in English and in Korean.
#[cfg(test)]
type Wording = (&'static str, &'static str, &'static str);

catalogue! {
    /// Verdicts, states, units and what every page says.
    common: common::Common,
    /// Connection bar, navigation, messages.
    frame: frame::Frame,
    /// Live view and stimuli.
    bench: bench::Bench,
    /// One case, from the symptom to the signed sheet.
    case: case::Case,
    /// Choosing and running procedures.
    procedures: procedures::Procedures,
    /// Automatic runs of a whole train.
    drive: drive::Drive,
    /// Recorded traces.
    traces: traces::Traces,
    /// Fault history.
    faults: faults::Faults,
    /// Statistics of the fault history.
    statistics: statistics::Statistics,
    /// Maintenance of the fault history.
    care: care::HistoryMaintenance,
    /// Life of units, trains and parts by serial number.
    life: life::Life,
    /// Stored memory of a unit.
    memory: memory::Memory,
    /// Parts to replace.
    diagnosis: diagnosis::Diagnosis,
    /// Test sheet.
    report: report::Report,
    /// Waveforms: read, made, recorded and played.
    signals: signals::Signals,
    /// Answers of the command line.
    terminal: terminal::Terminal,
    /// Counts, trends and records in them.
    counts: counts::Counts,
    /// Needs of this computer for testing units.
    doctor: doctor::Doctor,
    /// Signatures and changes that a verification found.
    verify: verify::Verify,
}

impl Words {
    /// Of an English and a Korean text, the one in this language.
    pub(crate) fn choose<T>(&self, both: [T; 2]) -> T {
        self.style(false).choose(both)
    }

    /// A text of scripts, catalogues or the runner, which is made and stored in English: a step's name, a fault mode, a
    /// message. A text without a translation stays as it was written.
    pub fn content<'a>(&self, text: &'a str) -> Cow<'a, str> {
        match self.language {
            Language::English => Cow::Borrowed(text),
            Language::Korean => content::korean(text),
        }
    }

    /// The English text, or in Korean the wording that `korean` returns, if it returns one.
    fn or_korean<'a>(
        &self,
        text: &'a str,
        korean: impl FnOnce() -> Option<String>,
    ) -> Cow<'a, str> {
        match self.language {
            Language::English => Cow::Borrowed(text),
            Language::Korean => korean().map_or(Cow::Borrowed(text), Cow::Owned),
        }
    }

    /// Title of a procedure, in this language if the script has it.
    pub fn title<'a>(&self, procedure: &'a Procedure) -> &'a str {
        match (self.language, &procedure.title_ko) {
            (Language::Korean, Some(korean)) => korean,
            _ => &procedure.title,
        }
    }

    /// Name of a recorded signal in few words; in English its name in scripts and tables.
    pub fn signal<'a>(&self, name: &'a str) -> Cow<'a, str> {
        self.or_korean(name, || Signal::from_name(name).map(say::condition::name))
    }

    /// Name of a line-replaceable part, by its identifier.
    pub fn part<'a>(&self, id: &'a str) -> &'a str {
        self.choose(names::part(id))
    }

    /// A state of a signal, as it is stored.
    pub fn state<'a>(&self, signal: &str, label: &'a str) -> Cow<'a, str> {
        self.or_korean(label, || say::condition::state(signal, label))
    }

    /// Unit of a measured value: SI units as they are, words in this language.
    pub fn unit<'a>(&self, unit: &'a str) -> &'a str {
        match unit {
            "bytes" => self.bench.unit_bytes,
            "errors" => self.bench.unit_errors,
            "answers" => self.bench.unit_answers,
            "frames" => self.bench.unit_frames,
            same => same,
        }
    }

    /// Name of a measurement: an item of the unit's self-test, or else as a script calls the measurement.
    pub fn measurement<'a>(&self, name: &'a str) -> Cow<'a, str> {
        match self.bench.self_test_item(name) {
            Some(item) => Cow::Owned(item),
            None => self.or_korean(name, || content::measurement(name)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parts that tell readers of a command line what to type. Sheets use only the wordings of `verify` that do not.
    const OF_TERMINAL: [&str; 4] = ["terminal", "counts", "doctor", "verify"];

    /// All wordings of the catalogue, and those of refusals.
    fn all_told() -> Vec<Wording> {
        let refused = ptu_runs::words::all().map(|[key, english, korean]| (key, english, korean));
        let parts = parts().into_iter().flat_map(|(_, wordings)| wordings);
        parts.chain(refused).collect()
    }

    #[test]
    fn no_wording_is_missing_in_either_language() {
        for (key, english, korean) in all_told() {
            assert!(!english.trim().is_empty(), "{key} has no English");
            assert!(!korean.trim().is_empty(), "{key} has no Korean");
        }
    }

    /// Readers of the window or of a sheet have no command line before them.
    #[test]
    fn no_wording_speaks_of_the_command_line() {
        let mut parts = parts();
        parts.retain(|(name, _)| !OF_TERMINAL.contains(name));
        for (key, english, korean) in parts.into_iter().flat_map(|part| part.1) {
            for text in [english, korean] {
                assert!(
                    !text.contains("`ptu ") && !text.contains("--"),
                    "{key}: {text}"
                );
            }
        }
    }

    #[test]
    fn both_languages_have_the_same_placeholders() {
        for (key, english, korean) in all_told() {
            assert_eq!(places(english), places(korean), "{key}");
        }
    }

    /// A word in capitals (EB, FSB, TCMS) is the field's and has no translation.
    #[test]
    fn technical_words_stay_as_the_field_writes_them() {
        let technical = |text: &'static str| {
            let words = text.split(|c: char| !c.is_ascii_alphanumeric());
            words.filter(|word| {
                word.len() > 1
                    && word
                        .chars()
                        .all(|c| c.is_ascii_uppercase() || c.is_ascii_digit())
                    && word.chars().any(|c| c.is_ascii_uppercase())
            })
        };
        // These wordings have words in capitals for emphasis, or as headings of columns.
        let otherwise = "armed|changed|not_verified|wrong|back_is|course_is|rate_is|stand_out";
        let is_otherwise = |key: &str| otherwise.split('|').any(|of| key.starts_with(of));
        let named = all_told()
            .into_iter()
            .filter(|(key, ..)| !is_otherwise(key));
        for (key, english, korean) in named {
            for word in technical(english) {
                assert!(
                    korean.contains(word),
                    "{key}: \"{word}\" is not in \"{korean}\""
                );
            }
        }
    }

    #[test]
    fn the_shipped_font_has_every_letter() {
        let font = ttf_parser::Face::parse(crate::fonts::PRETENDARD, 0).expect("a font");
        for (key, english, korean) in all_told() {
            for letter in english.chars().chain(korean.chars()) {
                assert!(font.glyph_index(letter).is_some(), "{key}: no \"{letter}\"");
            }
        }
    }

    #[test]
    fn korean_texts_are_not_english() {
        let left: Vec<_> = all_told()
            .into_iter()
            .filter(|(_, english, korean)| english == korean)
            .filter(|(_, english, _)| english.split(' ').count() > 2)
            .map(|(key, ..)| key)
            .collect();
        assert!(left.is_empty(), "{left:?}");
    }

    fn places(text: &str) -> Vec<&str> {
        let mut places: Vec<_> = text
            .split('{')
            .skip(1)
            .filter_map(|rest| rest.split_once('}').map(|(name, _)| name))
            .collect();
        places.sort_unstable();
        places.dedup();
        places
    }
}
