//! Text fields of the unit's identity, written so that different bytes never give the same text.

use protocol::display_text::is_unseen;
use protocol::message::Identity;

use crate::failure::{Failure, NoUnit};
use crate::link::Endpoint;

/// Stands for a serial number that is not set. It is longer than any field, so that no unit can say it.
const NO_SERIAL: &str = "(no serial number)";
/// Stands for a configuration without a name.
const NO_NAME: &str = "(no name)";
/// Beginning of an escaped byte.
const ESCAPE: &str = "\\x";

/// Serial number of a unit, as it is shown, stored and asked for with `--serial-no`.
pub fn serial(identity: &Identity) -> String {
    of_serial(&identity.serial)
}

/// Text of a serial number's bytes, as in [`serial`].
pub fn of_serial(bytes: &[u8]) -> String {
    text(bytes).unwrap_or(NO_SERIAL.into())
}

/// Compares the unit at `endpoint` with the serial number that is expected there, if one is.
///
/// # Errors
/// Another unit is there.
pub fn check_expected(
    endpoint: &Endpoint,
    identity: &Identity,
    expected: Option<&str>,
) -> Result<(), Failure> {
    let serial = serial(identity);
    match expected.filter(|expected| *expected != serial) {
        None => Ok(()),
        Some(expected) => Err(NoUnit::Other(endpoint.clone(), serial, expected.to_owned()).into()),
    }
}

/// Name of a unit's configuration.
pub fn config_name(identity: &Identity) -> String {
    text(&identity.config).unwrap_or(NO_NAME.into())
}

/// Text filled up with zeros; none if there is nothing else. Bytes that are no text, or that a person could not
/// see, stand as `\xNN`, and so does the backslash where such an escape stands or seems to: no two fields give
/// the same.
fn text(field: &[u8]) -> Option<String> {
    let end = field.iter().rposition(|byte| *byte != 0)? + 1;
    let bytes = &field[..end];
    if let Ok(text) = std::str::from_utf8(bytes)
        && !text.contains(is_escaped)
        && !text.contains(ESCAPE)
    {
        return Some(text.to_owned());
    }
    let mut shown = String::new();
    for chunk in bytes.utf8_chunks() {
        for character in chunk.valid().chars() {
            if !is_escaped(character) && character != '\\' {
                shown.push(character);
            } else {
                let mut utf8 = [0; 4];
                escape(character.encode_utf8(&mut utf8).as_bytes(), &mut shown);
            }
        }
        escape(chunk.invalid(), &mut shown);
    }
    Some(shown)
}

/// A character that is not seen, or that stands for bytes that are no text.
fn is_escaped(character: char) -> bool {
    is_unseen(character) || character == char::REPLACEMENT_CHARACTER
}

fn escape(bytes: &[u8], shown: &mut String) {
    for byte in bytes {
        shown.push_str(&format!("{ESCAPE}{byte:02x}"));
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn of(serial_bytes: &[u8]) -> Identity {
        let mut identity = Identity::default();
        identity.serial[..serial_bytes.len()].copy_from_slice(serial_bytes);
        identity
    }

    #[test]
    fn a_serial_number_is_shown_as_it_is_or_escaped() {
        let cases: [(&[u8], &str); 13] = [
            (b"SG-0042", "SG-0042"),
            ("호기 7".as_bytes(), "호기 7"),
            (b"A\\B", "A\\B"),
            (b"", NO_SERIAL),
            (b" ", " "),
            (&[0xFF; 16], &"\\xff".repeat(16)),
            (b"SG\xFE42", "SG\\xfe42"),
            (b"SG\\xfe42", "SG\\x5cxfe42"),
            (b"SG\0\x0042", "SG\\x00\\x0042"),
            (b"\x1b[2JSG", "\\x1b[2JSG"),
            ("SG\u{202e}24".as_bytes(), "SG\\xe2\\x80\\xae24"),
            ("SG\u{fffd}".as_bytes(), "SG\\xef\\xbf\\xbd"),
            (b"A\\\xFF", "A\\x5c\\xff"),
        ];
        for (bytes, shown) in cases {
            assert_eq!(serial(&of(bytes)), shown);
        }
    }

    /// Goal: no two fields give the same text. Method: all of five bytes of those that could be
    /// taken for one another.
    #[test]
    fn units_that_differ_stay_apart() {
        let alphabet = b"\0\\x5cf\xff\xc3\xa9 ";
        let mut seen: BTreeMap<String, [u8; 16]> = BTreeMap::new();
        let numbers = 0..alphabet.len().pow(5);
        for number in numbers {
            let mut rest = number;
            let bytes: [u8; 5] = std::array::from_fn(|_| {
                let byte = alphabet[rest % alphabet.len()];
                rest /= alphabet.len();
                byte
            });
            let identity = of(&bytes);
            let before = seen.insert(serial(&identity), identity.serial);
            assert!(
                before.is_none_or(|before| before == identity.serial),
                "{} is {before:?} and {:?}",
                serial(&identity),
                identity.serial
            );
        }
    }
}
