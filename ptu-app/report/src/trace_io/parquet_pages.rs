//! Checks the unpacked length of each page of a Parquet file, by the page's header, before the library unpacks it.

use std::fs::File;
use std::io::{BufReader, Read, Seek as _, SeekFrom};

use parquet::file::metadata::ColumnChunkMetaData;

/// Longest page, bytes: a column of all samples that are allowed fits.
const MAX_PAGE: u64 = 96 << 20;
/// Longest page whose values take several times as much memory: a dictionary, and texts that repeat the text before.
const MAX_REPEATING: u64 = 4 << 20;
/// Bytes of a page beside its content.
const PAGE: u64 = 64;
/// Longest footer, which describes a file, bytes.
const MAX_FOOTER: u32 = 4 << 20;
/// Greatest depth of structures within structures.
const DEPTH: u32 = 4;

/// Numbers in pages' headers: a kind of page, and an encoding.
const DICTIONARY: i64 = 2;
const DELTA_BYTE_ARRAY: i64 = 7;

/// Sentence that says why a file is not read.
type Refused = String;

/// Refuses a footer that takes more memory than that of a trace.
pub(super) fn check_footer(file: &mut File) -> Result<(), Refused> {
    let mut footer = [0; 8];
    let read = file
        .seek(SeekFrom::End(-8))
        .and_then(|_| file.read_exact(&mut footer));
    read.map_err(|error| format!("damaged, or no Parquet file: {error}"))?;
    let [a, b, c, d, magic @ ..] = footer;
    // A file that is no Parquet file has no footer: the library's reader says so.
    match &magic == b"PAR1" && u32::from_le_bytes([a, b, c, d]) > MAX_FOOTER {
        true => Err(format!("its description is longer than {MAX_FOOTER} bytes")),
        false => Ok(()),
    }
}

/// Subtracts the unpacked length of each page of a column from `left`; refuses a page that is longer than what is left, or than
/// a page may be.
pub(super) fn check_pages(
    file: &File,
    column: &ColumnChunkMetaData,
    left: &mut u64,
) -> Result<(), Refused> {
    let failed = |error: std::io::Error| error.to_string();
    let (start, length) = column.byte_range();
    let mut input = BufReader::new(file.try_clone().map_err(failed)?);
    input.seek(SeekFrom::Start(start)).map_err(failed)?;
    let mut rest = length;
    while rest > 0 {
        let mut header = Header::default();
        let mut bytes = Thrift {
            input: Read::by_ref(&mut input).take(rest),
        };
        bytes.structure(None, DEPTH, &mut header)?;
        let after_header = bytes.input.limit();
        let [packed, unpacked] = [header.packed, header.unpacked].map(u64::try_from);
        let (Ok(packed), Ok(unpacked)) = (packed, unpacked) else {
            return Err("a page has no length".to_owned());
        };
        let repeats = header.kind == DICTIONARY || header.encoding == DELTA_BYTE_ARRAY;
        let most = if repeats { MAX_REPEATING } else { MAX_PAGE };
        let taken = unpacked.max(packed) + PAGE;
        if unpacked > most || taken > *left {
            return Err(format!(
                "a page unpacks to {unpacked} bytes: more than is read here"
            ));
        }
        if header.kind == DICTIONARY && header.values > header.unpacked {
            return Err("a dictionary has more values than bytes".to_owned());
        }
        *left -= taken;
        rest = after_header
            .checked_sub(packed)
            .ok_or("a page is longer than its column")?;
        let packed = i64::try_from(packed).map_err(|error| error.to_string())?;
        input.seek_relative(packed).map_err(failed)?;
    }
    Ok(())
}

/// Header of a page.
#[derive(Default)]
struct Header {
    kind: i64,
    unpacked: i64,
    packed: i64,
    /// Values of a dictionary's page.
    values: i64,
    encoding: i64,
}

impl Header {
    /// Keeps a whole number of the header, by the number of its field and of the structure with this field: 5 is the
    /// header of a data page, 7 of a dictionary, 8 of a data page of the second version.
    fn take(&mut self, within: Option<i64>, field: i64, number: i64) {
        match (within, field) {
            (None, 1) => self.kind = number,
            (None, 2) => self.unpacked = number,
            (None, 3) => self.packed = number,
            (Some(7), 1) => self.values = number,
            (Some(5), 2) | (Some(8), 4) => self.encoding = number,
            _ => {}
        }
    }
}

/// Thrift's compact form, in which headers are written.
struct Thrift<R> {
    input: R,
}

impl<R: Read> Thrift<R> {
    fn byte(&mut self) -> Result<u8, Refused> {
        let mut byte = [0];
        let read = self.input.read_exact(&mut byte);
        read.map_err(|error| format!("a page's header: {error}"))?;
        Ok(byte[0])
    }

    fn unsigned(&mut self) -> Result<u64, Refused> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(number);
            }
        }
        Err("a page's header: a number without an end".to_owned())
    }

    fn signed(&mut self) -> Result<i64, Refused> {
        let number = self.unsigned()?;
        Ok((number >> 1).cast_signed() ^ -(number & 1).cast_signed())
    }

    fn skip(&mut self, bytes: u64) -> Result<(), Refused> {
        (0..bytes).try_for_each(|_| self.byte().map(drop))
    }

    fn structure(
        &mut self,
        within: Option<i64>,
        depth: u32,
        header: &mut Header,
    ) -> Result<(), Refused> {
        let deeper = depth.checked_sub(1).ok_or("a page's header is too deep")?;
        let mut field = 0;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Ok(());
            }
            let before = field;
            field = match head >> 4 {
                0 => self.signed()?,
                more => field + i64::from(more),
            };
            // Of a field that comes twice, one reader would take the first value and another reader the last.
            if field <= before {
                return Err("a page's header has its fields in another order".to_owned());
            }
            match head & 15 {
                1 | 2 => {}
                4..=6 => {
                    let number = self.signed()?;
                    header.take(within, field, number);
                }
                12 => self.structure(within.map_or(Some(field), |_| Some(-1)), deeper, header)?,
                other => self.value(other, deeper, header)?,
            }
        }
    }

    /// Passes over a value that says nothing here.
    fn value(&mut self, kind: u8, depth: u32, header: &mut Header) -> Result<(), Refused> {
        match kind {
            1..=3 => self.skip(1),
            4..=6 => self.signed().map(drop),
            7 => self.skip(8),
            8 => {
                let length = self.unsigned()?;
                self.skip(length)
            }
            9 | 10 => {
                let deeper = depth.checked_sub(1).ok_or("a page's header is too deep")?;
                let head = self.byte()?;
                let count = match head >> 4 {
                    15 => self.unsigned()?,
                    few => u64::from(few),
                };
                (0..count).try_for_each(|_| self.value(head & 15, deeper, header))
            }
            12 => self.structure(Some(-1), depth, header),
            _ => Err("a page's header has a value of an unknown kind".to_owned()),
        }
    }
}
