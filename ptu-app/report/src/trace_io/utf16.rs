//! Text that may be UTF-16, as UTF-8.

use std::io::{self, Read};

/// Passes bytes on as they are, unless they begin with the mark of UTF-16.
pub(super) struct Text<R> {
    input: R,
    form: Form,
    /// What was read and not passed on yet.
    held: Vec<u8>,
}

enum Form {
    Unknown,
    Bytes,
    /// The halves of a character that is longer than one unit.
    Utf16 {
        is_big: bool,
        first: Option<u16>,
    },
}

impl<R: Read> Text<R> {
    pub fn new(input: R) -> Self {
        let (form, held) = (Form::Unknown, Vec::new());
        Self { input, form, held }
    }

    /// Holds the next character of UTF-16, or nothing at the end; what is cut off there is left out.
    fn hold_more(&mut self) -> io::Result<bool> {
        let Form::Utf16 { is_big, mut first } = self.form else {
            self.held = self.pair()?;
            return Ok(!self.held.is_empty());
        };
        while self.held.is_empty() {
            let Ok(pair) = <[u8; 2]>::try_from(self.pair()?) else {
                return Ok(false);
            };
            let unit = if is_big {
                u16::from_be_bytes(pair)
            } else {
                u16::from_le_bytes(pair)
            };
            if (0xd800..0xdc00).contains(&unit) {
                first = Some(unit);
                continue;
            }
            let letters = char::decode_utf16(first.take().into_iter().chain([unit]));
            let letters: String = letters
                .map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER))
                .collect();
            self.held = letters.into_bytes();
        }
        Ok(true)
    }

    /// Reads two bytes, or one at the end, or none.
    fn pair(&mut self) -> io::Result<Vec<u8>> {
        let mut pair = Vec::with_capacity(2);
        (&mut self.input).take(2).read_to_end(&mut pair)?;
        Ok(pair)
    }
}

impl<R: Read> Read for Text<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if matches!(self.form, Form::Unknown) {
            let pair = self.pair()?;
            self.form = match pair[..] {
                [0xff, 0xfe] => Form::Utf16 {
                    is_big: false,
                    first: None,
                },
                [0xfe, 0xff] => Form::Utf16 {
                    is_big: true,
                    first: None,
                },
                _ => Form::Bytes,
            };
            if matches!(self.form, Form::Bytes) {
                self.held = pair;
            }
        }
        let mut passed = 0;
        while passed < to.len() {
            if self.held.is_empty() && !self.hold_more()? {
                break;
            }
            let more = self.held.len().min(to.len() - passed);
            to[passed..passed + more].copy_from_slice(&self.held[..more]);
            self.held.drain(..more);
            passed += more;
            if matches!(self.form, Form::Bytes) && self.held.is_empty() {
                return Ok(passed + self.input.read(&mut to[passed..])?);
            }
        }
        Ok(passed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: the text of a file is the same in each form. Method: letters of one unit, of two, and halves of one.
    #[test]
    fn text_is_read_in_every_form() {
        let text = "t;속도;𝄞\n";
        let units: Vec<u16> = text.encode_utf16().chain([0xd834]).collect();
        let little = [0xfeff]
            .iter()
            .chain(&units)
            .flat_map(|unit| unit.to_le_bytes());
        let big = [0xfeff]
            .iter()
            .chain(&units)
            .flat_map(|unit| unit.to_be_bytes());
        for bytes in [little.collect::<Vec<_>>(), big.collect(), text.into()] {
            let mut read = String::new();
            let whole = Text::new(&bytes[..]).read_to_string(&mut read);
            whole.expect("text");
            assert_eq!(read, text);
        }
        for short in ["", "a", "ab"] {
            let mut read = Vec::new();
            Text::new(short.as_bytes())
                .read_to_end(&mut read)
                .expect("read");
            assert_eq!(read, short.as_bytes());
        }
    }
}
