//! Full-text search that finds the same in a file and on a server.
//!
//! A word is a run of letters and digits, in lower case. A Korean, Chinese or Japanese character is a word
//! of its own, because a search for 교체 has to find 부품교체함. Words that are adjacent in the search text
//! have to be adjacent in the match, and the last word matches as a prefix: `relay` finds `relays`.

use unicode_normalization::UnicodeNormalization as _;

/// Longest word that is indexed, bytes; longer words are not searched for.
const MOST_BYTES: usize = 200;

/// The words of a text, in order.
pub(crate) fn words(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut word = String::new();
    let mut end = |word: &mut String| {
        if !word.is_empty() && word.len() <= MOST_BYTES {
            found.push(std::mem::take(word));
        }
        word.clear();
    };
    for letter in text.nfkc() {
        if stands_alone(letter) && letter.is_alphanumeric() {
            end(&mut word);
            word.push(letter);
            end(&mut word);
        } else if letter.is_alphanumeric() {
            word.extend(
                letter
                    .to_lowercase()
                    .filter(|letter| letter.is_alphanumeric()),
            );
        } else {
            end(&mut word);
        }
    }
    end(&mut word);
    found
}

/// A search text: a match has all its phrases.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Search(Vec<Vec<String>>);

impl Search {
    /// A search in which each part between blanks is a phrase; `None` without any word.
    pub fn new(text: &str) -> Option<Self> {
        let phrases: Vec<_> = text
            .split_whitespace()
            .map(words)
            .filter(|words| !words.is_empty())
            .collect();
        (!phrases.is_empty()).then_some(Self(phrases))
    }

    /// A search in which the whole text is one phrase; `None` without any word.
    pub fn exactly(text: &str) -> Option<Self> {
        let words = words(text);
        (!words.is_empty()).then_some(Self(vec![words]))
    }

    /// Whether a text matches: the text has every phrase, with the last word of each as a prefix.
    pub fn is_in(&self, text: &str) -> bool {
        let said = words(text);
        let stands_at = |phrase: &[String], place: &[String]| {
            let (last, before) = (place.len() - 1, phrase.len() - 1);
            let ends = match goes_on(phrase) {
                true => place[last].starts_with(&phrase[before]),
                false => place[last] == phrase[before],
            };
            ends && place[..last] == phrase[..before]
        };
        let is_said =
            |phrase: &Vec<String>| said.windows(phrase.len()).any(|at| stands_at(phrase, at));
        self.0.iter().all(is_said)
    }

    /// The search as a query of SQLite's FTS5.
    pub fn for_file(&self) -> String {
        let phrase = |words: &Vec<String>| {
            let more = if goes_on(words) { " *" } else { "" };
            format!("\"{}\"{more}", words.join(" "))
        };
        self.0.iter().map(phrase).collect::<Vec<_>>().join(" AND ")
    }

    /// The search as a `tsquery` of PostgreSQL.
    pub fn for_server(&self) -> String {
        let phrase = |words: &Vec<String>| {
            let quoted: Vec<_> = words.iter().map(|word| format!("'{word}'")).collect();
            let more = if goes_on(words) { ":*" } else { "" };
            format!("({}{more})", quoted.join(" <-> "))
        };
        self.0.iter().map(phrase).collect::<Vec<_>>().join(" & ")
    }
}

/// PostgreSQL's `tsvector` of a text.
pub(crate) fn for_server(text: &str) -> String {
    let place = |(place, word): (usize, String)| format!("'{word}':{}", place + 1);
    let places: Vec<_> = words(text).into_iter().enumerate().map(place).collect();
    places.join(" ")
}

/// Whether the last word matches as a prefix: not if it is a single Hangul, kana or Chinese character.
fn goes_on(words: &[String]) -> bool {
    words
        .last()
        .and_then(|word| word.chars().next())
        .is_some_and(|letter| !stands_alone(letter))
}

/// Whether a character is a word by itself: Hangul, kana and Chinese characters.
fn stands_alone(letter: char) -> bool {
    matches!(letter,
        '\u{1100}'..='\u{11ff}' | '\u{3040}'..='\u{30ff}' | '\u{3130}'..='\u{318f}'
        | '\u{3400}'..='\u{9fff}' | '\u{a960}'..='\u{a97f}' | '\u{ac00}'..='\u{d7ff}'
        | '\u{f900}'..='\u{faff}' | '\u{20000}'..='\u{3ffff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_runs_of_letters_and_single_korean_syllables() {
        assert_eq!(
            words("EB_relay (SN-77) 부품교체함."),
            ["eb", "relay", "sn", "77", "부", "품", "교", "체", "함"]
        );
        assert_eq!(words("ＥＢ릴레이"), ["eb", "릴", "레", "이"]);
        assert!(words(" -- ").is_empty());
    }

    #[test]
    fn a_text_matches_words_that_are_adjacent_in_it() {
        let says = |text: &str, asked: &str| Search::new(asked).expect("words").is_in(text);
        assert!(says("부품교체함, SN-77", "교체 SN-7"));
        assert!(says("EB relays replaced", "relay eb"));
        assert!(!says("부품 교 정 체", "교체"));
        assert!(!says("relays replaced", "relays-repl-x"));
        assert!(!says("체", "교체"), "shorter than what is asked");
        assert!(says("교체", "교체") && !says("", "교체"));
    }

    #[test]
    fn a_search_keeps_adjacent_words_adjacent() {
        let search = Search::new("교체 SN-7").expect("words");
        assert_eq!(search.for_file(), "\"교 체\" AND \"sn 7\" *");
        assert_eq!(search.for_server(), "('교' <-> '체') & ('sn' <-> '7':*)");
        assert_eq!(Search::new("\"*'"), None);
    }
}
