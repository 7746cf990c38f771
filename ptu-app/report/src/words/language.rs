//! Languages people read, and which of them this process shows.

use std::ffi::OsString;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use super::{ENGLISH, KOREAN, Words};

/// Language that the user of this process prefers, if it is known.
static PREFERRED: OnceLock<Language> = OnceLock::new();

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Language {
    #[default]
    English,
    Korean,
}

impl Language {
    pub const ALL: [Self; 2] = [Self::English, Self::Korean];

    pub fn name(self) -> &'static str {
        self.choose(["English", "한국어"])
    }

    /// Of an English and a Korean item, the one in this language.
    pub fn choose<T>(self, [english, korean]: [T; 2]) -> T {
        match self {
            Self::English => english,
            Self::Korean => korean,
        }
    }

    /// Code of the language on web pages (BCP 47).
    pub fn code(self) -> &'static str {
        self.choose(["en", "ko"])
    }

    /// The language of this process: that of `--lang` on its command line, or else the one that its user prefers, or else
    /// that of its locale, or else English.
    pub fn shown() -> Self {
        static SHOWN: OnceLock<Language> = OnceLock::new();
        *SHOWN.get_or_init(|| {
            let words = std::env::args_os().collect::<Vec<_>>();
            let preferred = || PREFERRED.get().copied();
            asked(&words).or_else(preferred).unwrap_or_else(of_locale)
        })
    }

    /// Sets this language as the one that the user prefers, before anything is shown.
    pub fn prefer(self) {
        let _ = PREFERRED.set(self);
    }

    /// The catalogue of wordings in this language.
    pub fn words(self) -> &'static Words {
        self.choose([&ENGLISH, &KOREAN])
    }
}

impl std::str::FromStr for Language {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::ALL
            .into_iter()
            .find(|language| language.code() == text);
        known.ok_or_else(|| "a language is en or ko".into())
    }
}

/// The language that the words of a command line ask for.
fn asked(words: &[OsString]) -> Option<Language> {
    let word = |at: usize| words.get(at).and_then(|word| word.to_str());
    (0..words.len()).find_map(|at| {
        let value = match word(at)? {
            "--lang" => word(at + 1),
            word => word.strip_prefix("--lang="),
        };
        value.and_then(|value| value.parse().ok())
    })
}

/// The language of messages by the system's locale (POSIX 8.2): the first variable that is not empty counts.
fn of_locale() -> Language {
    let variables = ["LC_ALL", "LC_MESSAGES", "LANG"];
    let mut said = variables.iter().filter_map(std::env::var_os);
    let locale = said.find(|value| !value.is_empty()).unwrap_or_default();
    match locale.to_string_lossy().starts_with("ko") {
        true => Language::Korean,
        false => Language::English,
    }
}
