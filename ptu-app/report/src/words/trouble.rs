//! What the store of the history says of trouble, in words for the window: without commands, and in Korean.
//!
//! The store makes its messages once, in English, for who has a command line; `trouble.toml` has what the window says of
//! each. What is not in it is said as it is.

use std::borrow::Cow;
use std::sync::LazyLock;

use serde::Deserialize;

use super::{Language, Words};

static TROUBLE: LazyLock<Vec<Said>> =
    LazyLock::new(|| read(include_str!("trouble.toml")).expect("a test reads what is built in"));

/// How a command line says which file; the window has one.
const OPTION: &str = " with --db";
/// Texts within texts go no deeper.
const DEEPEST: usize = 3;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    messages: Vec<[String; 3]>,
}

/// A message, and what is said in its place.
struct Said {
    stored: Pattern,
    english: String,
}

/// A message with places for what differs.
struct Pattern {
    /// What stands before, between and after the places; one more than there are places.
    between: Vec<String>,
    places: Vec<String>,
    korean: String,
}

impl Pattern {
    fn new(english: &str, korean: String) -> Self {
        let (mut between, mut places) = (Vec::new(), Vec::new());
        let mut rest = english;
        while let Some((before, after)) = rest.split_once('{') {
            let (place, after) = after.split_once('}').unwrap_or((after, ""));
            between.push(before.to_owned());
            places.push(place.to_owned());
            rest = after;
        }
        between.push(rest.to_owned());
        Self {
            between,
            places,
            korean,
        }
    }

    /// What stands in the places of a text of this pattern; `None` for another text, or one that leaves a place empty. A
    /// place ends where what comes after it begins first.
    fn places_in<'a>(&self, text: &'a str) -> Option<Vec<&'a str>> {
        let (first, between) = self.between.split_first()?;
        let mut rest = text.strip_prefix(first.as_str())?;
        let mut found = Vec::with_capacity(self.places.len());
        for (place, literal) in (1..).zip(between) {
            let end = match place == between.len() {
                true => rest.strip_suffix(literal.as_str())?.len(),
                false => rest.find(literal.as_str())?,
            };
            found.push(rest.get(..end).filter(|part| !part.is_empty())?);
            rest = &rest[end + literal.len()..];
        }
        rest.is_empty().then_some(found)
    }
}

fn read(text: &str) -> Result<Vec<Said>, toml::de::Error> {
    let file: File = toml::from_str(text)?;
    let said = file.messages.into_iter().map(|[stored, window, korean]| {
        let english = if window.is_empty() {
            stored.clone()
        } else {
            window
        };
        Said {
            stored: Pattern::new(&stored, korean),
            english,
        }
    });
    Ok(said.collect())
}

impl Words {
    /// Trouble with the history as a window says it.
    pub fn trouble<'a>(&self, text: &'a str) -> Cow<'a, str> {
        let text = text.strip_suffix(OPTION).unwrap_or(text);
        self.told(text, DEEPEST)
            .map_or_else(|| self.content(text), Cow::Owned)
    }

    fn told(&self, text: &str, deepest: usize) -> Option<String> {
        let deeper = deepest.checked_sub(1)?;
        let fits = |said: &Said| {
            let found = said.stored.places_in(text)?;
            let mut told = match self.language {
                Language::English => said.english.clone(),
                Language::Korean => said.stored.korean.clone(),
            };
            for (place, part) in said.stored.places.iter().zip(found) {
                let deeper = self.told(part, deeper);
                let part = deeper.as_deref().unwrap_or(part);
                told = told.replace(&format!("{{{place}}}"), part);
            }
            Some(told)
        };
        TROUBLE.iter().find_map(fits)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use fault_db::StoreError;

    use super::*;

    /// The messages of a file's errors, with `X7` in each place.
    fn messages(source: &str) -> Vec<String> {
        let of_one = |rest: &str| {
            let rest = rest.split_once('"')?.1;
            let end = rest
                .find("\")")
                .into_iter()
                .chain(rest.find("\","))
                .chain(rest.find("\"\n"));
            let text = rest.get(..end.min()?)?;
            // A literal goes on behind a backslash and the blanks after it.
            let lines: Vec<_> = text.split("\\\n").map(str::trim_start).collect();
            let text = lines.concat();
            let mut parts = text.split('{');
            let mut message = parts.next()?.to_owned();
            for part in parts {
                message += "X7";
                message += part.split_once('}')?.1;
            }
            Some(message)
        };
        source
            .split("#[error(")
            .skip(1)
            .filter_map(of_one)
            .collect()
    }

    fn is_for_people(text: &str) -> bool {
        !["`", "--", "ptu ", "db "]
            .iter()
            .any(|sign| text.contains(sign))
    }

    fn check(message: &str) {
        let [english, korean] = Language::ALL.map(|language| {
            let said = language.words().trouble(message);
            said.into_owned()
        });
        assert!(is_for_people(&english), "{message}: {english}");
        assert!(is_for_people(&korean), "{message}: {korean}");
        let words = korean.split(|c: char| !c.is_ascii_lowercase());
        let words: Vec<_> = words.filter(|word| word.len() > 2).collect();
        let of_addresses = ["postgres", "sslmode", "disable", "sslrootcert"];
        let left: Vec<_> = words
            .iter()
            .filter(|word| !of_addresses.contains(word))
            .collect();
        assert!(left.is_empty(), "{message}: {korean}: {left:?}");
        for said in [&english, &korean] {
            let places = message.matches("X7").count();
            assert!(said.matches("X7").count() >= places, "{message}: {said}");
        }
    }

    /// Goal: an error that is added to the store is told in both languages, or this fails.
    #[test]
    fn every_error_of_the_store_is_told_without_commands_and_in_korean() {
        let all = messages(include_str!("../../../../fault-db/src/error/mod.rs"));
        assert!(all.len() > 40, "{all:#?}");
        // A transition and a withdrawal are told whole, below.
        for message in all.iter().filter(|message| *message != "fault X7: X7") {
            check(message);
        }
        for message in messages(include_str!(
            "../../../../fault-db/src/values/withdrawal_error.rs"
        ))
        .into_iter()
        .chain(messages(include_str!(
            "../../../../fault-db/src/values/fault_state.rs"
        ))) {
            check(&format!("fault X7: {message}"));
        }
    }

    #[test]
    fn findings_of_a_check_are_told_in_korean() {
        for message in [
            "row 7 of step points at a missing row of run",
            "the table \"X7\" is not of this program",
            "seal 7 of file X7: its run was taken out",
            "seal 7 of file X7 (run X7) does not fit the one before: it was changed",
            "event X7 was changed after it was sealed",
            "the signature at seal 7 of file X7: its signature does not fit its content: one of them was changed",
            "the signature at seal 7 of file X7: the seal of run X7 was taken out",
            "the chain of file X7 was rewritten: entry 7 is not the one that was known at 2026-03-01 00:00:00 UTC",
            "the chain of file X7 was rewritten: entry 7 is not the one that was known here",
            "the chain of file X7 was cut: entry 7, which was known here, is not there",
            "the clock went backward: run X7 is dated 2026-03-01 00:00:00 UTC, and was sealed after note X7, dated 2026-03-02 00:00:00 UTC",
            "the signature at seal 7 of file X7: it is of another: it signs run X7",
            "the signature at seal 7 of file X7: a \"fault\" is not signed there",
            "the signature at seal 7 of file X7: it is not in the one form in which it was signed: it was changed",
            "recording 7 of run X7 was taken out: no seal says that it was pruned",
            "one of the notes, X7, has no seal: it was put in by hand, or its seal was taken out",
            "run X7 was finished and has no seal: its seal was taken out, or it was put in by hand",
            "7 sums of measured values by day are not what the history says",
            "fault X7 is not as its occurrences and events say: state, times, line or counts",
            "trace X7: damaged at byte 7: X7",
        ] {
            let said = Language::Korean.words().trouble(message);
            let hangul = said.chars().any(|c| ('가'..='힣').contains(&c));
            let english = ["was", "not", "has", "row"]
                .iter()
                .any(|word| said.split(' ').any(|of| of == *word));
            assert!(hangul && !english, "{message}: {said}");
        }
    }

    #[test]
    fn an_error_keeps_its_file_and_loses_its_option() {
        let path = Path::new("/data/history.db").to_path_buf();
        let failure = ptu_runs::failure::Failure::from(StoreError::Corrupt {
            path: path.clone(),
            detail: "database disk image is malformed".into(),
        });
        let said = Language::Korean.words().trouble(&failure.message);
        assert_eq!(
            said,
            "파일이 손상되었습니다: /data/history.db (데이터베이스 내용이 손상됨). 이력을 검사한 후 백업으로 계속하십시오"
        );
        let failure = ptu_runs::failure::Failure::from(StoreError::Missing { path });
        let said = Language::English.words().trouble(&failure.message);
        assert_eq!(
            said,
            "there is no database /data/history.db; a first run creates it, or choose another file"
        );
    }
}
