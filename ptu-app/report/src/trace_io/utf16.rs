//! Text that may be UTF-16, as UTF-8.

use std::io::{BufRead, BufReader, Cursor, Error, Read, Result};

/// Longest file of UTF-16, bytes: it is held in memory.
const LONGEST: u64 = 256 << 20;

/// Passes bytes on as they are, unless they begin with the mark of UTF-16.
pub(super) fn text<'i>(input: impl Read + 'i) -> Result<Box<dyn BufRead + 'i>> {
    let mut input = BufReader::new(input);
    let unit: fn([u8; 2]) -> u16 = match input.fill_buf()? {
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        _ => return Ok(Box::new(input)),
    };
    input.consume(2);
    let mut rest = Vec::new();
    input.take(LONGEST + 1).read_to_end(&mut rest)?;
    if rest.len() as u64 > LONGEST {
        return Err(Error::other("longer than UTF-16 is read; save it as UTF-8"));
    }
    let (pairs, _) = rest.as_chunks();
    let letters = char::decode_utf16(pairs.iter().map(|pair| unit(*pair)));
    let letters = letters.map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER));
    Ok(Box::new(Cursor::new(letters.collect::<String>())))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: the text of a file is the same in each form. Method: letters of one unit, of two, and half a unit.
    #[test]
    fn text_is_read_in_every_form() {
        let all = "t;속도;𝄞\n";
        let units = || std::iter::once(0xfeff).chain(all.encode_utf16());
        let little = units().flat_map(u16::to_le_bytes).chain([0x74]);
        let big = units().flat_map(u16::to_be_bytes).chain([0]);
        let forms = [little.collect::<Vec<_>>(), big.collect(), all.into()];
        let short = ["", "a", "ab"].map(|short| (short.into(), short));
        for (bytes, expected) in forms.map(|bytes| (bytes, all)).into_iter().chain(short) {
            let mut read = String::new();
            let whole = text(&bytes[..]).and_then(|mut text| text.read_to_string(&mut read));
            whole.expect("text");
            assert_eq!(read, expected);
        }
    }
}
