//! Where a limit comes from: the papers, the configuration, a standard, or nothing but a default.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

/// Where the numbers of a limit come from.
///
/// Quantities read from the configuration carry their origin, and keep it through sums and products; a number
/// that a script writes gets its origin from the script's `source`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Each as a script writes it, for instance `S3 eq. 4` or `default: half the stop tolerance`.
    sources: BTreeSet<String>,
    /// At least one of the limit's numbers has no source.
    pub lacks: bool,
}

impl Origin {
    /// Origin of a number that names no source.
    pub(super) fn lacking() -> Self {
        Self {
            lacks: true,
            ..Self::default()
        }
    }

    pub(super) fn of(source: impl Into<String>) -> Self {
        Self {
            sources: BTreeSet::from([source.into()]),
            lacks: false,
        }
    }

    /// Adds the origin of another number from which this number was computed, too.
    pub(super) fn join(&mut self, other: &Self) {
        self.sources.extend(other.sources.iter().cloned());
        self.lacks |= other.lacks;
    }

    /// Gives `sources` to the numbers that have no source so far.
    pub(super) fn fill(&mut self, sources: &[String]) {
        if self.lacks && !sources.is_empty() {
            self.give(sources);
        }
    }

    /// Adds `sources`; no number is without a source then.
    pub(super) fn give(&mut self, sources: &[String]) {
        self.sources.extend(sources.iter().cloned());
        self.lacks = false;
    }

    /// Adds a source of the limit, such as a change by the bench.
    pub fn add(&mut self, source: String) {
        self.sources.insert(source);
    }

    /// The sources in one line; `None` without any.
    pub fn text(&self) -> Option<String> {
        let all: Vec<_> = self.sources.iter().map(String::as_str).collect();
        (!all.is_empty()).then(|| all.join(SEPARATOR))
    }
}

/// Text between the sources of one limit; no source contains this text.
pub const SEPARATOR: &str = "; ";

/// Kind of a source, by its first word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceKind {
    /// A paper, `S0` to `S4`, with its section, equation, table or figure.
    Paper,
    /// A key of the unit configuration.
    Configuration,
    /// A key of the track database.
    Track,
    /// A key of the train's file.
    Train,
    /// A value that an earlier step measured.
    Measurement,
    /// A published standard or rule, by name.
    Standard,
    /// The unit says its own limits.
    Unit,
    /// The bench's own choice, with or without its reason.
    Default,
}

/// Word with which a source of each kind begins; a source that is a paper begins as in [`PAPERS`].
const WORDS: [(&str, SourceKind); 7] = [
    ("configuration ", SourceKind::Configuration),
    ("track database ", SourceKind::Track),
    ("train ", SourceKind::Train),
    ("measurement ", SourceKind::Measurement),
    ("standard ", SourceKind::Standard),
    ("unit", SourceKind::Unit),
    ("default", SourceKind::Default),
];
/// The papers, and how a place in one begins; a number follows.
const PAPERS: [&str; 5] = ["S0 ", "S1 ", "S2 ", "S3 ", "S4 "];
const PLACES: [&str; 4] = ["§", "eq. ", "table ", "fig. "];

impl SourceKind {
    /// The kind of a source, and what is behind its word: key, name or reason.
    pub fn split(source: &str) -> Option<(Self, &str)> {
        if source.contains(SEPARATOR.trim_end()) {
            return None;
        }
        if let Some(place) = PAPERS.iter().find_map(|paper| source.strip_prefix(paper)) {
            let number = PLACES.iter().find_map(|word| place.strip_prefix(word))?;
            return number
                .starts_with(|c: char| c.is_ascii_digit())
                .then_some((Self::Paper, source));
        }
        let (kind, rest) = WORDS
            .iter()
            .find_map(|(word, kind)| Some((*kind, source.strip_prefix(word)?)))?;
        match kind {
            Self::Unit => rest.is_empty().then_some((kind, rest)),
            Self::Default if rest.is_empty() => Some((kind, rest)),
            Self::Default => rest
                .strip_prefix(": ")
                .filter(|reason| !reason.is_empty())
                .map(|reason| (kind, reason)),
            _ => (!rest.is_empty()).then_some((kind, rest)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_is_of_a_known_kind_and_says_where() {
        for (source, expected) in [
            ("S3 eq. 4, 5", Some((SourceKind::Paper, "S3 eq. 4, 5"))),
            ("S0 §3.1.1", Some((SourceKind::Paper, "S0 §3.1.1"))),
            ("S2 table 1", Some((SourceKind::Paper, "S2 table 1"))),
            (
                "configuration receiver.detect_ms",
                Some((SourceKind::Configuration, "receiver.detect_ms")),
            ),
            ("track database stop_m", Some((SourceKind::Track, "stop_m"))),
            (
                "standard IEEE 1698",
                Some((SourceKind::Standard, "IEEE 1698")),
            ),
            ("unit", Some((SourceKind::Unit, ""))),
            ("default", Some((SourceKind::Default, ""))),
            (
                "default: two scans",
                Some((SourceKind::Default, "two scans")),
            ),
            ("S5 §1", None),
            ("S3", None),
            ("S3 §", None),
            ("S3 somewhere", None),
            ("default two scans", None),
            ("default: ", None),
            ("default: one; two", None),
            ("configuration ", None),
            ("experience", None),
            ("", None),
        ] {
            assert_eq!(SourceKind::split(source), expected, "{source}");
        }
    }

    #[test]
    fn a_number_without_a_source_is_seen_until_one_is_given() {
        let mut sum = Origin::of("configuration a.b_ms");
        sum.join(&Origin::lacking());
        assert!(sum.lacks);
        sum.fill(&[]);
        assert!(sum.lacks, "nothing was given");
        sum.fill(&["default: slack".into()]);
        assert!(!sum.lacks);
        sum.fill(&["default: of the file".into()]);
        let text = sum.text();
        assert_eq!(
            text.as_deref(),
            Some("configuration a.b_ms; default: slack")
        );
        assert_eq!(Origin::lacking().text(), None);
    }
}
