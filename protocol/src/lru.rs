//! Identifiers of replaceable parts, and how "no part" is written.
//!
//! Inside the program no part is `None`. Two formats have a word for it: scripts, the event dictionary and the
//! window write `-` ([`shown`]); the database, its JSON and the fault dictionary write `unknown`
//! ([`stored`]). Neither word can be an identifier.

use alloc::borrow::{Cow, ToOwned};
use alloc::string::String;
use core::borrow::Borrow;
use core::fmt;
use core::str::FromStr;

use serde::{Deserialize, Serialize};

const SHOWN_NONE: &str = "-";
const STORED_NONE: &str = "unknown";

/// Identifier of a line-replaceable unit (LRU), for instance `eb_relay`: the smallest part that maintenance
/// exchanges. `scripts/units/faults.toml` lists them.
#[derive(
    Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(try_from = "String")]
pub struct LruId(Cow<'static, str>);

/// A text that names no part.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is not the identifier of a part")]
pub struct NotAnLru(String);

const fn names_none(text: &str) -> bool {
    matches!(text.as_bytes(), b"" | b"-" | b"unknown")
}

impl LruId {
    /// An identifier of the program's own text.
    ///
    /// # Panics
    /// The text names no part; in a constant this is an error of compilation.
    pub const fn from_static(text: &'static str) -> Self {
        assert!(!names_none(text), "this names no part");
        Self(Cow::Borrowed(text))
    }

    /// Part of a row in the table of events, where `-` is none.
    pub(crate) const fn listed(text: &'static str) -> Option<Self> {
        match text.as_bytes() {
            b"-" => None,
            _ => Some(Self::from_static(text)),
        }
    }

    /// The identifier's text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl TryFrom<String> for LruId {
    type Error = NotAnLru;

    fn try_from(text: String) -> Result<Self, NotAnLru> {
        match names_none(&text) {
            true => Err(NotAnLru(text)),
            false => Ok(Self(Cow::Owned(text))),
        }
    }
}

impl FromStr for LruId {
    type Err = NotAnLru;

    fn from_str(text: &str) -> Result<Self, NotAnLru> {
        text.to_owned().try_into()
    }
}

impl fmt::Display for LruId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

// Maps by part are searched by text.
impl Borrow<str> for LruId {
    fn borrow(&self) -> &str {
        &self.0
    }
}

impl PartialEq<str> for LruId {
    fn eq(&self, text: &str) -> bool {
        self.0 == text
    }
}

impl PartialEq<&str> for LruId {
    fn eq(&self, text: &&str) -> bool {
        self.0 == *text
    }
}

/// The part as scripts and the window write it; `-` is no part.
pub fn shown(lru: Option<&LruId>) -> &str {
    lru.map_or(SHOWN_NONE, LruId::as_str)
}

/// The part that a script names: an empty text or `-` is none.
///
/// # Errors
/// The text is the word that the database has for none.
pub fn from_shown(text: &str) -> Result<Option<LruId>, NotAnLru> {
    match text {
        "" | SHOWN_NONE => Ok(None),
        named => named.parse().map(Some),
    }
}

/// The part as the database and the fault dictionary write it; `unknown` is no part.
pub fn stored(lru: Option<&LruId>) -> &str {
    lru.map_or(STORED_NONE, LruId::as_str)
}

/// The part that a database or a fault dictionary names. Files of other programs may have any word for none.
pub fn from_stored(text: &str) -> Option<LruId> {
    text.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_and_none_are_read_back_from_both_formats() {
        for lru in [None, Some(LruId::from_static("eb_relay"))] {
            assert_eq!(from_shown(shown(lru.as_ref())), Ok(lru.clone()));
            assert_eq!(from_stored(stored(lru.as_ref())), lru);
        }
        assert_eq!((shown(None), stored(None)), ("-", "unknown"));
    }

    #[test]
    fn a_word_for_none_is_no_identifier() {
        for none in ["", "-", "unknown"] {
            assert_eq!(none.parse::<LruId>(), Err(NotAnLru(none.to_owned())));
            assert_eq!(from_stored(none), None);
        }
        assert_eq!(from_shown(""), Ok(None));
        assert!(from_shown("unknown").is_err());
    }
}
