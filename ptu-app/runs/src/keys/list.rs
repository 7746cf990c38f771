//! A list of public keys: text that can be read, signed off on paper and copied.

use std::path::{Path, PathBuf};

use chrono::{DateTime, NaiveDate, Utc};
use fault_db::read_regular_file;
use protocol::display_text;
use serde::{Deserialize, Serialize};
use unicode_normalization::UnicodeNormalization as _;

use crate::failure::{Failure, FileTrouble, KeyTrouble, Why};

/// Longest list that is read, bytes.
const LONGEST: u64 = 4 << 20;
const DAY: &str = "%Y-%m-%d";

/// A public key, whose it is, and when it holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeyEntry {
    /// The name it signs by.
    pub who: String,
    /// `technician` or `bench`.
    pub kind: String,
    /// The public key, in hex.
    pub key: String,
    /// The first day on which it holds (UTC).
    pub from: String,
    /// The first day on which it holds no more; none: without an end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<String>,
    /// The day from which on it is revoked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub revoked: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Public keys, as the files say that were read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeyList {
    #[serde(default, rename = "key")]
    pub keys: Vec<KeyEntry>,
}

/// Standing of a key at a time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Standing {
    /// The list has the key under this name, and the key was valid then.
    Held,
    /// The list does not have the key.
    Unknown,
    /// The list has the key under another name, or as another kind of key.
    OtherName(String),
    /// The key was not valid yet; the day from which on it is.
    NotYet(String),
    /// The key had expired; the day from which on.
    Expired(String),
    /// The key was revoked; the day from which on.
    Revoked(String),
}

impl Standing {
    /// The list has the key, valid then.
    pub fn is_good(&self) -> bool {
        *self == Self::Held
    }

    /// Standing in words, after "the key".
    pub fn text(&self) -> String {
        match self {
            Self::Held => "is in the list and was valid then".to_owned(),
            Self::Unknown => {
                "is not in the list of keys; `ptu key trust FILE.pub` adds one that you know"
                    .to_owned()
            }
            Self::OtherName(name) => format!("belongs to {name} in the list of keys"),
            Self::NotYet(day) => format!("is valid from {day} only"),
            Self::Expired(day) => format!("expired on {day}"),
            Self::Revoked(day) => format!("was revoked from {day}"),
        }
    }
}

impl KeyList {
    /// Reads a file, or all `.pub` and `.keys` files of a folder. An end or revocation in any of them holds.
    ///
    /// # Errors
    /// The file cannot be read, or an entry is wrong.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let mut list = Self::default();
        for file in Self::files(path)? {
            for entry in Self::of_file(&file)?.keys {
                let added = list.add(entry);
                added.map_err(|why| {
                    let list = FileTrouble::OfKeys(path.display().to_string());
                    Failure::bench(why).because_of(list)
                })?;
            }
        }
        Ok(list)
    }

    /// The file itself, or all `.pub` and `.keys` files of a folder, by name.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn files(path: &Path) -> Result<Vec<PathBuf>, Failure> {
        if !path.is_dir() {
            return Ok(vec![path.to_path_buf()]);
        }
        let cannot = |error| Failure::bench(FileTrouble::unread(path, error));
        let mut files: Vec<PathBuf> = Vec::new();
        for entry in std::fs::read_dir(path).map_err(cannot)? {
            let file = entry.map_err(cannot)?.path();
            let ending = file.extension().unwrap_or_default();
            if ending == "pub" || ending == "keys" {
                files.push(file);
            }
        }
        files.sort();
        Ok(files)
    }

    fn of_file(path: &Path) -> Result<Self, Failure> {
        let shown = path.display().to_string();
        let no_list = |why| Failure::bench(KeyTrouble::NoKeyList(shown.clone(), why));
        let bytes = read_regular_file(path, LONGEST)
            .map_err(|error| Failure::bench(FileTrouble::unread(path, error)))?;
        let text = String::from_utf8(bytes).map_err(|_| no_list(Why::NoText))?;
        Self::of_text(&text).map_err(|why| no_list(Why::Said(why)))
    }

    fn of_text(text: &str) -> Result<Self, String> {
        let list: Self = toml::from_str(text).map_err(|error| error.message().to_owned())?;
        for entry in &list.keys {
            entry.check()?;
        }
        Ok(list)
    }

    /// The list as a file has it.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for entry in &self.keys {
            text += "[[key]]\n";
            // Text in JSON is text in TOML, but for this one sign.
            let mut line = |name: &str, value: &str| {
                let quoted = serde_json::Value::from(value).to_string();
                text += &format!("{name} = {}\n", quoted.replace('\u{7f}', "\\u007f"));
            };
            line("who", &entry.who);
            line("kind", &entry.kind);
            line("key", &entry.key);
            line("from", &entry.from);
            for (name, value) in [
                ("until", &entry.until),
                ("revoked", &entry.revoked),
                ("reason", &entry.reason),
            ] {
                if let Some(value) = value {
                    line(name, value);
                }
            }
            text += "\n";
        }
        text
    }

    /// Adds a key, and returns its entry: a key known before is then valid only on days that both entries allow.
    ///
    /// # Errors
    /// The list has the key under another name.
    pub fn add(&mut self, entry: KeyEntry) -> Result<KeyEntry, KeyTrouble> {
        let Some(known) = self.keys.iter_mut().find(|known| known.key == entry.key) else {
            self.keys.push(entry.clone());
            return Ok(entry);
        };
        if known.name() != entry.name() {
            return Err(KeyTrouble::OfTwo(known.name(), entry.name()));
        }
        let earliest = |a: &Option<String>, b| [a.clone(), b].into_iter().flatten().min();
        *known = KeyEntry {
            from: known.from.clone().max(entry.from),
            until: earliest(&known.until, entry.until),
            revoked: earliest(&known.revoked, entry.revoked),
            reason: known.reason.clone().or(entry.reason),
            ..known.clone()
        };
        Ok(known.clone())
    }

    pub fn find(&self, key: &str) -> Option<&KeyEntry> {
        self.keys.iter().find(|entry| entry.key == key)
    }

    /// The keys that are meant by a name, or by the beginning of a key of at least four digits.
    pub fn named<'a>(&'a self, asked: &'a str) -> impl Iterator<Item = &'a KeyEntry> {
        let by_key = move |entry: &KeyEntry| asked.len() >= 4 && entry.key.starts_with(asked);
        (self.keys.iter()).filter(move |entry| entry.who == asked || by_key(entry))
    }

    /// Standing of a key at a time under a name, as the key of a technician or a bench.
    pub fn standing(&self, key: &str, who: &str, kind: &str, at_us: i64) -> Standing {
        match self.find(key) {
            None => Standing::Unknown,
            Some(entry) if (&*entry.who, &*entry.kind) != (who, kind) => {
                Standing::OtherName(entry.name())
            }
            Some(entry) => entry.standing(at_us),
        }
    }
}

impl KeyEntry {
    /// The first digits of the key, as lists and sheets show it.
    pub fn short(&self) -> &str {
        self.key.get(..16).unwrap_or(&self.key)
    }

    /// State of the key at this time, µs UTC.
    pub fn standing(&self, at_us: i64) -> Standing {
        let day = day_of(at_us);
        let is_from = |start: &&String| ***start <= *day;
        match (&self.revoked, &self.until) {
            (Some(revoked), _) if is_from(&revoked) => Standing::Revoked(revoked.clone()),
            _ if *self.from > *day => Standing::NotYet(self.from.clone()),
            (_, Some(until)) if is_from(&until) => Standing::Expired(until.clone()),
            _ => Standing::Held,
        }
    }

    /// Owner of the key, in words.
    pub fn name(&self) -> String {
        format!("{} ({})", self.who, self.kind)
    }

    /// Checks the name, the digits of the key and the days.
    ///
    /// # Errors
    /// Name, key or day has another form, in words.
    pub fn check(&self) -> Result<(), String> {
        name_argument(&self.who)?;
        let hex = self
            .key
            .bytes()
            .all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
        if self.key.len() != 64 || !hex {
            return Err(format!(
                "the key of {} is no 64 digits of 0 to 9, a to f",
                self.who
            ));
        }
        for day in [Some(&self.from), self.until.as_ref(), self.revoked.as_ref()]
            .into_iter()
            .flatten()
        {
            day_argument(day)?;
        }
        Ok(())
    }
}

/// Name of a key's owner: composed (NFC), and without invisible characters.
///
/// # Errors
/// The name is empty or in another form.
pub fn name_argument(text: &str) -> Result<String, String> {
    let hidden = |c: char| {
        (c != ' ' && c.is_whitespace()) || matches!(c, '\u{fe00}'..='\u{fe0f}' | '\u{2800}')
    };
    let is_plain = text.split(' ').all(|word| !word.is_empty()) && !text.contains(hidden);
    let is_plain = is_plain && text.nfc().eq(text.chars());
    match is_plain && display_text::line(text) == text {
        true => Ok(text.to_owned()),
        false => Err(format!(
            "{text:?} is no name: write words with one space between them, composed letters (NFC), and nothing that cannot be seen"
        )),
    }
}

/// A day, as 2026-11-26.
///
/// # Errors
/// The text is no day.
pub fn day_argument(text: &str) -> Result<String, String> {
    let day = NaiveDate::parse_from_str(text, DAY)
        .ok()
        .map(|day| day.format(DAY).to_string());
    day.filter(|day| day == text)
        .ok_or_else(|| format!("\"{text}\" is no day; write it as 2026-11-26"))
}

/// The day of a time, UTC.
pub fn day_of(at_us: i64) -> String {
    let at = DateTime::<Utc>::from_timestamp_micros(at_us).unwrap_or_default();
    at.format(DAY).to_string()
}

/// The day a number of years after a time.
pub fn day_text(at_us: i64, years: u32) -> String {
    let at = DateTime::<Utc>::from_timestamp_micros(at_us).unwrap_or_default();
    let later = at
        .date_naive()
        .checked_add_months(chrono::Months::new(12 * years));
    later.unwrap_or_default().format(DAY).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(who: &str, digit: &str) -> KeyEntry {
        KeyEntry {
            who: who.to_owned(),
            kind: "technician".to_owned(),
            key: digit.repeat(64),
            from: "2026-03-01".to_owned(),
            until: Some("2028-03-01".to_owned()),
            revoked: None,
            reason: None,
        }
    }

    fn at(day: &str) -> i64 {
        let day = NaiveDate::parse_from_str(day, DAY).expect("a day");
        day.and_hms_opt(12, 0, 0)
            .expect("noon")
            .and_utc()
            .timestamp_micros()
    }

    #[test]
    fn a_list_is_read_as_it_was_written() {
        let mut odd = entry("Kim \"K\" [[key]] who = 김", "a");
        odd.reason = Some("lost\\\n[[key]]\nwho = 'Lee'".to_owned());
        odd.revoked = Some("2027-01-01".to_owned());
        let list = KeyList {
            keys: vec![odd, entry("Lee", "b")],
        };
        assert_eq!(KeyList::of_text(&list.text()), Ok(list));
        assert_eq!(KeyList::of_text(""), Ok(KeyList::default()));
        for wrong in [
            "x",
            "[[key]]\nwho = 'a'",
            "[[key]]\nwho='a'\nkind='b'\nkey='zz'\nfrom='2026-01-01'",
        ] {
            assert!(KeyList::of_text(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_key_holds_from_its_first_day_until_it_ends_or_is_revoked() {
        let mut list = KeyList {
            keys: vec![entry("Kim", "a")],
        };
        let key = "a".repeat(64);
        let standing = |list: &KeyList, day| list.standing(&key, "Kim", "technician", at(day));
        assert_eq!(
            standing(&list, "2026-02-28"),
            Standing::NotYet("2026-03-01".to_owned())
        );
        assert_eq!(standing(&list, "2026-03-01"), Standing::Held);
        assert_eq!(standing(&list, "2028-02-29"), Standing::Held);
        assert_eq!(
            standing(&list, "2028-03-01"),
            Standing::Expired("2028-03-01".to_owned())
        );
        list.keys[0].revoked = Some("2027-01-01".to_owned());
        assert_eq!(standing(&list, "2026-12-31"), Standing::Held);
        assert_eq!(
            standing(&list, "2027-01-01"),
            Standing::Revoked("2027-01-01".to_owned())
        );
        assert_eq!(
            list.standing(&key, "Lee", "technician", at("2026-04-01")),
            Standing::OtherName("Kim (technician)".to_owned())
        );
        assert_eq!(
            list.standing("b", "Lee", "technician", 0),
            Standing::Unknown
        );
    }

    #[test]
    fn a_revocation_is_not_undone_by_another_file() {
        let mut list = KeyList::default();
        let mut revoked = entry("Kim", "a");
        revoked.revoked = Some("2027-01-01".to_owned());
        list.add(revoked.clone()).expect("added");
        list.add(entry("Kim", "a")).expect("added");
        assert_eq!(list.keys, [revoked]);
    }
}
