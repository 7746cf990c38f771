//! Names within English texts: as scripts write them, or in `{:#}` as people say them.

use std::fmt::{self, Display, Formatter};

/// Words that stand in capitals.
const CAPITALS: [&str; 9] = [
    "eb", "fsb", "atp", "ato", "cpu", "twc", "psm", "tcms", "tra",
];
/// Prefix of the names of self-test items.
const SELF_TEST: &str = "self_test.";

pub fn spoken(name: &str) -> String {
    if let Some(item) = name.strip_prefix(SELF_TEST) {
        return format!("Self-test: {}", spoken(item));
    }
    let word = |word: &str| match CAPITALS.contains(&word) {
        true => word.to_uppercase(),
        false => word.to_owned(),
    };
    let said: Vec<String> = name.split('_').map(word).collect();
    said.join(" ")
}

pub(super) struct Name<'a>(pub &'a str);

impl Display for Name<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match f.alternate() {
            true => f.write_str(&spoken(self.0)),
            false => f.write_str(self.0),
        }
    }
}

/// A part of a text; the flag says whether its names are given as people say them.
pub(super) struct Part<T>(pub T, pub bool);

impl<T: Display> Display for Part<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.1 {
            true => write!(f, "{:#}", self.0),
            false => write!(f, "{}", self.0),
        }
    }
}
