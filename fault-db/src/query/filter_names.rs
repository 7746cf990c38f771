//! Resolves the names in a filter: codes to their numbers, parts to their stored spellings, texts to search words.

use crate::backend::values;
use crate::error::StoreError;
use crate::schema::full_text::Search;
use crate::store::Store;

/// The search for a filter's text.
///
/// # Errors
/// [`StoreError::NoWords`] if the text has none.
pub(super) fn search(note: &str) -> Result<Search, StoreError> {
    Search::new(note).ok_or_else(|| StoreError::NoWords(note.to_owned()))
}

/// The numbers of codes, which are given as numbers or by the names of faults, separated by commas.
pub(super) fn codes(store: &Store, asked: &str) -> Result<Vec<i64>, StoreError> {
    let mut numbers = Vec::new();
    let mut known = None;
    for code in asked.split(',').map(str::trim) {
        if let Some(number) = code_number(code) {
            numbers.push(number);
            continue;
        }
        if known.is_none() {
            known = Some(store.known_codes()?);
        }
        let named = known.iter().flatten();
        let named = named.filter(|(_, name)| name.eq_ignore_ascii_case(code));
        numbers.extend(named.map(|(number, _)| *number));
    }
    numbers.sort_unstable();
    numbers.dedup();
    Ok(numbers)
}

/// A code written as a number: decimal, or hex after `0x`.
pub fn code_number(code: &str) -> Option<i64> {
    match code.strip_prefix("0x") {
        Some(hex) => i64::from_str_radix(hex, 16).ok(),
        None => code.parse().ok(),
    }
}

/// The stored spellings of a part's name, whatever the case of its letters.
pub(super) fn lrus(store: &Store, lru: &str) -> Result<Vec<String>, StoreError> {
    let mut known = store.known_lrus()?;
    known.retain(|known| known.eq_ignore_ascii_case(lru));
    Ok(known)
}

impl Store {
    pub(super) fn unit_seq(&self, serial: &str) -> Result<i64, StoreError> {
        let found = self.first(
            "looking up a unit",
            "SELECT seq FROM unit WHERE serial = ?1",
            &values![serial],
            |row| row.get(0),
        )?;
        found.ok_or_else(|| StoreError::NotFound {
            what: "unit",
            asked: serial.to_owned(),
        })
    }
}
