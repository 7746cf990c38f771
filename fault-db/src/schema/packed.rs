//! Rows packed by column, which are read faster than SQLite returns rows one by one: statistics read all of a million
//! occurrences.
//!
//! A column holds whole numbers or texts. A number is stored as its distance from the column's least number, plus one;
//! a text as its index among the column's texts, plus one; 0 is NULL. All take as few bytes as the greatest needs.
//! Layout, all numbers little-endian: rows `u32`, columns `u8`; of each column the base `i64`, bytes per row `u8`,
//! number of texts `u32`, each text as length `u32` and UTF-8, then the rows. Eight zero bytes end it, so that every
//! number can be read as eight bytes.

use std::collections::HashMap;

use rusqlite::Error::UserFunctionError;
use rusqlite::functions::{Aggregate, Context};
use rusqlite::types::ValueRef;

use crate::backend::{Backend, Row, SqlResult, values};

/// SQL: packs the faults of a block `p`.
const FAULTS: &str =
    "SELECT packed_rows(f.seq, f.unit, f.code, f.lru, f.line, f.severity, f.state, f.first_at_us,
        f.last_at_us, f.closed_at_us, f.repairs, f.cause)
    FROM fault f WHERE f.seq BETWEEN p.block * 32 AND p.block * 32 + 31";

const OCCURRENCES: &str = "SELECT packed_rows(o.fault, o.at_us, o.line, s.procedure, o.run)
    FROM fault_occurrence o LEFT JOIN step s ON s.run = o.run AND s.step_index = o.step_index
    WHERE o.fault BETWEEN p.block * 32 AND p.block * 32 + 31";

/// SQL: packs the repairs of a block's faults, found by the unit, code and part of each fault.
const REPAIRS: &str = "SELECT packed_rows(r.fault, r.at_us, r.opened_at_us, r.back_at_us)
    FROM fault f CROSS JOIN repair r
    WHERE f.seq BETWEEN p.block * 32 AND p.block * 32 + 31
        AND r.unit = f.unit AND r.code = f.code AND r.lru = f.lru AND r.fault = f.seq";

/// Calls `take` with the packed faults, occurrences and repairs of each block of a file.
pub(crate) fn each_block(
    backend: &Backend,
    take: impl FnMut(Row<'_>) -> SqlResult<()>,
) -> SqlResult<()> {
    let sql = format!(
        "SELECT coalesce(p.faults, ({FAULTS})), coalesce(p.occurrences, ({OCCURRENCES})),
            coalesce(p.repairs, ({REPAIRS})) FROM packed p"
    );
    backend.each(&sql, &[], take)
}

/// Up to this many blocks may stay empty at the end of a run: the next runs change the same blocks again, and a reader
/// packs them for itself in a few milliseconds.
const FEW_EMPTY: u32 = 64;

/// Packs the empty blocks of a file if they are more than [`FEW_EMPTY`]. A server has none.
pub(crate) fn fill_empty_blocks(backend: &Backend) -> SqlResult<()> {
    let Backend::File(_) = backend else {
        return Ok(());
    };
    let few = "SELECT 1 FROM packed WHERE faults IS NULL LIMIT 1 OFFSET ?1";
    if !backend.has(few, &values![FEW_EMPTY])? {
        return Ok(());
    }
    let sql = format!(
        "UPDATE packed AS p SET faults = ({FAULTS}), occurrences = ({OCCURRENCES}), repairs = ({REPAIRS})
         WHERE faults IS NULL"
    );
    backend.execute(&sql, &[])?;
    Ok(())
}

/// Zero bytes at the end.
const PADDING: usize = 8;

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Cell {
    Null,
    Number(i64),
    Text(String),
}

/// Packs rows. They are sorted first: the same rows in any order give the same bytes.
pub(crate) fn pack(mut rows: Vec<Vec<Cell>>) -> Vec<u8> {
    rows.sort_unstable();
    let columns = rows.first().map_or(0, Vec::len);
    let mut packed = Vec::new();
    packed.extend((rows.len() as u32).to_le_bytes());
    packed.push(columns as u8);
    for column in 0..columns {
        pack_column(rows.iter().map(|row| &row[column]), &mut packed);
    }
    packed.extend([0; PADDING]);
    packed
}

fn pack_column<'a>(cells: impl Iterator<Item = &'a Cell> + Clone, packed: &mut Vec<u8>) {
    let numbers = cells.clone().filter_map(|cell| match cell {
        Cell::Number(number) => Some(*number),
        Cell::Null | Cell::Text(_) => None,
    });
    let base = numbers.min().unwrap_or(0);
    let (mut texts, mut places) = (Vec::new(), HashMap::new());
    let codes: Vec<u64> = cells
        .map(|cell| match cell {
            Cell::Null => 0,
            Cell::Number(number) => (number.wrapping_sub(base) as u64).saturating_add(1),
            Cell::Text(text) => *places.entry(text.as_str()).or_insert_with(|| {
                texts.push(text.as_str());
                texts.len() as u64
            }),
        })
        .collect();
    let greatest = codes.iter().max().copied().unwrap_or(0);
    let width = (u64::BITS - greatest.leading_zeros()).div_ceil(8) as usize;
    packed.extend(base.to_le_bytes());
    packed.push(width as u8);
    packed.extend((texts.len() as u32).to_le_bytes());
    for text in texts {
        packed.extend((text.len() as u32).to_le_bytes());
        packed.extend(text.as_bytes());
    }
    for code in codes {
        packed.extend(&code.to_le_bytes()[..width]);
    }
}

/// A packed table, for reading.
pub(crate) struct Packed<'a, const COLUMNS: usize> {
    pub rows: usize,
    pub columns: [Column<'a>; COLUMNS],
}

/// A column of a packed table.
#[derive(Clone, Default)]
pub(crate) struct Column<'a> {
    base: i64,
    width: usize,
    mask: u64,
    pub texts: Vec<&'a str>,
    /// The bytes of the rows, and of everything behind them.
    codes: &'a [u8],
}

impl<'a, const COLUMNS: usize> Packed<'a, COLUMNS> {
    /// Reads bytes that [`pack`] made of rows with `COLUMNS` columns; `None` for anything else.
    pub fn read(bytes: &'a [u8]) -> Option<Self> {
        let mut rest = bytes;
        let rows = take_u32(&mut rest)?;
        let columns = usize::from(*take(&mut rest, 1)?.first()?);
        let mut read = Vec::with_capacity(COLUMNS);
        for _ in 0..columns {
            read.push(Column::read(&mut rest, rows)?);
        }
        // Without rows, `pack` does not know the number of columns either.
        if rows == 0 && columns == 0 {
            read.resize(COLUMNS, Column::default());
        }
        let columns = read.try_into().ok()?;
        (rest.len() == PADDING).then_some(Self { rows, columns })
    }
}

impl<'a> Column<'a> {
    fn read(rest: &mut &'a [u8], rows: usize) -> Option<Self> {
        let base = i64::from_le_bytes(take(rest, 8)?.try_into().ok()?);
        let width = usize::from(*take(rest, 1)?.first()?);
        let mut texts = Vec::new();
        for _ in 0..take_u32(rest)? {
            let length = take_u32(rest)?;
            texts.push(std::str::from_utf8(take(rest, length)?).ok()?);
        }
        let codes = *rest;
        take(rest, rows.checked_mul(width)?)?;
        let mask = match width {
            0 => 0,
            1..=8 => u64::MAX >> (64 - 8 * width),
            _ => return None,
        };
        Some(Self {
            base,
            width,
            mask,
            texts,
            codes,
        })
    }

    /// The stored code: 0 is NULL; a text has its index among the column's texts plus one.
    pub fn code(&self, row: usize) -> usize {
        (self.raw(row) as usize).min(self.texts.len())
    }

    /// The number; `None` is NULL.
    pub fn number(&self, row: usize) -> Option<i64> {
        let code = self.raw(row);
        (code > 0).then(|| self.base.wrapping_add((code - 1) as i64))
    }

    fn raw(&self, row: usize) -> u64 {
        let from = row * self.width;
        let bytes = self.codes.get(from..from + 8);
        let bytes = bytes.and_then(|bytes| bytes.try_into().ok());
        bytes.map_or(0, u64::from_le_bytes) & self.mask
    }
}

fn take<'a>(rest: &mut &'a [u8], length: usize) -> Option<&'a [u8]> {
    let (taken, left) = rest.split_at_checked(length)?;
    *rest = left;
    Some(taken)
}

fn take_u32(rest: &mut &[u8]) -> Option<usize> {
    let bytes = take(rest, 4)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(bytes)).ok()
}

/// SQL aggregate: the rows of its arguments, packed.
pub(crate) struct PackRows;

impl Aggregate<Vec<Vec<Cell>>, Vec<u8>> for PackRows {
    fn init(&self, _: &mut Context<'_>) -> rusqlite::Result<Vec<Vec<Cell>>> {
        Ok(Vec::new())
    }

    fn step(&self, context: &mut Context<'_>, rows: &mut Vec<Vec<Cell>>) -> rusqlite::Result<()> {
        let cells = (0..context.len()).map(|argument| match context.get_raw(argument) {
            ValueRef::Null => Ok(Cell::Null),
            ValueRef::Integer(number) => Ok(Cell::Number(number)),
            value => Ok(Cell::Text(value.as_str()?.to_owned())),
        });
        let row = cells.collect::<Result<_, rusqlite::types::FromSqlError>>();
        rows.push(row.map_err(|error| UserFunctionError(error.into()))?);
        Ok(())
    }

    fn finalize(
        &self,
        _: &mut Context<'_>,
        rows: Option<Vec<Vec<Cell>>>,
    ) -> rusqlite::Result<Vec<u8>> {
        Ok(pack(rows.unwrap_or_default()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Cell {
        Cell::Text(text.to_owned())
    }

    #[test]
    fn rows_are_read_as_they_were_packed() {
        let rows = vec![
            vec![
                Cell::Number(7),
                text("b"),
                Cell::Number(1_750_000_000_000_000),
            ],
            vec![Cell::Number(-3), text("a"), Cell::Null],
            vec![
                Cell::Number(7),
                text("b"),
                Cell::Number(1_000_000_000_000_000),
            ],
        ];
        let packed = pack(rows.clone());
        assert_eq!(packed, pack(rows.into_iter().rev().collect()));
        let read = Packed::<3>::read(&packed).expect("what was packed");
        let [number, word, at_us] = &read.columns;
        let rows: Vec<_> = (0..read.rows)
            .map(|row| {
                let word = word.texts[word.code(row) - 1];
                (number.number(row), word, at_us.number(row))
            })
            .collect();
        assert_eq!(
            rows,
            [
                (Some(-3), "a", None),
                (Some(7), "b", Some(1_000_000_000_000_000)),
                (Some(7), "b", Some(1_750_000_000_000_000)),
            ]
        );
    }

    #[test]
    fn no_rows_are_packed_as_no_rows_and_cut_ones_are_refused() {
        assert!(Packed::<2>::read(&pack(Vec::new())).is_some_and(|read| read.rows == 0));
        let packed = pack(vec![vec![Cell::Number(1), text("b")]]);
        assert!(Packed::<1>::read(&packed).is_none());
        for length in 0..packed.len() {
            assert!(Packed::<2>::read(&packed[..length]).is_none(), "{length}");
        }
    }
}
