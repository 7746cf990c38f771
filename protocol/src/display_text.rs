//! Makes text from outside safe to display.
//!
//! Notes, names, serial numbers and messages come from operators, scripts, files and units. Control
//! characters in them would move a terminal's cursor or change its title, bidirectional ones would reorder
//! the text, and ones without width would make two names look the same. Each is shown by its number
//! instead: `\x1b`, `\u{202e}`.

use alloc::borrow::Cow;
use alloc::string::String;
use core::fmt::Write;

/// The text on one line.
pub fn line(text: &str) -> Cow<'_, str> {
    spelled(text, is_unseen)
}

/// The text on its lines: line feeds and tabs stay as they are.
pub fn lines(text: &str) -> Cow<'_, str> {
    spelled(text, |letter| {
        is_unseen(letter) && !matches!(letter, '\n' | '\t')
    })
}

/// A character that is invisible, controls the display, or is no character (the last two of each plane, and U+FDD0 to
/// U+FDEF), which XML cannot hold.
pub fn is_unseen(letter: char) -> bool {
    letter.is_control()
        || u32::from(letter) & 0xfffe == 0xfffe
        || matches!(letter, '\u{fdd0}'..='\u{fdef}')
        || matches!(letter,
            // Soft hyphen, joiners, fillers of syllables and of vowels, which have no width.
            '\u{ad}' | '\u{34f}' | '\u{115f}'..='\u{1160}' | '\u{17b4}'..='\u{17b5}'
            | '\u{180b}'..='\u{180f}' | '\u{200b}'..='\u{200d}' | '\u{3164}' | '\u{ffa0}' | '\u{feff}'
            // Marks, embeddings, overrides and isolates of the writing direction.
            | '\u{61c}' | '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            // Separators of lines and paragraphs, annotations, tags and selectors of the last planes.
            | '\u{2028}'..='\u{2029}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}')
}

fn spelled(text: &str, is_spelled: impl Fn(char) -> bool) -> Cow<'_, str> {
    let Some(first) = text.find(&is_spelled) else {
        return Cow::Borrowed(text);
    };
    let mut shown = String::with_capacity(text.len() + 16);
    shown.push_str(&text[..first]);
    for letter in text[first..].chars() {
        // Writing to a text cannot fail.
        let _ = match letter {
            plain if !is_spelled(plain) => {
                shown.push(plain);
                Ok(())
            }
            '\n' => shown.write_str("\\n"),
            '\r' => shown.write_str("\\r"),
            '\t' => shown.write_str("\\t"),
            letter if u32::from(letter) < 0x100 => write!(shown, "\\x{:02x}", u32::from(letter)),
            letter => write!(shown, "\\u{{{:x}}}", u32::from(letter)),
        };
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_shown_by_their_numbers() {
        for (text, shown) in [
            ("\x1b]0;owned\x07", "\\x1b]0;owned\\x07"),
            ("a\x7fb\u{9b}31m", "a\\x7fb\\x9b31m"),
            ("one\ntwo\tthree\r", "one\\ntwo\\tthree\\r"),
            ("abc\u{202e}fed", "abc\\u{202e}fed"),
            (
                "SN\u{200b}-1\u{feff}\u{e0041}",
                "SN\\u{200b}-1\\u{feff}\\u{e0041}",
            ),
            ("a\u{fffe}b\u{1ffff}", "a\\u{fffe}b\\u{1ffff}"),
            (
                "비상제동 계전기 – µ ½ e\u{301}",
                "비상제동 계전기 – µ ½ e\u{301}",
            ),
        ] {
            assert_eq!(line(text), shown);
            assert_eq!(line(&line(text)), shown, "once is enough");
        }
    }

    /// Goal: no text makes a report that a reader of XML refuses. Method: each character there is.
    #[test]
    fn what_is_shown_is_what_xml_can_hold() {
        for letter in char::MIN..=char::MAX {
            let shown = lines(letter.encode_utf8(&mut [0; 4])).into_owned();
            // Extensible Markup Language (XML) 1.0, production 2.
            let can_hold = |letter| matches!(letter, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..);
            assert!(shown.chars().all(can_hold), "{letter:?}");
        }
    }

    #[test]
    fn lines_stay_lines_and_nothing_else_acts() {
        assert_eq!(lines("one\n\ttwo\r\n\x1b[2J"), "one\n\ttwo\\r\n\\x1b[2J");
        for letter in (0..=0x9f).filter_map(char::from_u32) {
            let shown = lines(letter.encode_utf8(&mut [0; 4])).into_owned();
            let stays = letter == '\n' || letter == '\t';
            assert_eq!(shown.contains(char::is_control), stays, "{letter:?}");
        }
    }
}
