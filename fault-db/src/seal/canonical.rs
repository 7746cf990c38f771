//! The canonical byte encoding of sealed fields, which gives different contents different bytes. SEALS.md describes it.

use sha2::{Digest as _, Sha256};

use crate::backend::{Backend, Field, SqlResult, Value};

/// SHA-256 over fields, each written with its type and length.
#[derive(Clone)]
pub(crate) struct CanonicalHash(Sha256);

impl CanonicalHash {
    /// A hash without a prefix: for a table of a run.
    pub fn new() -> Self {
        Self(Sha256::new())
    }

    /// A hash with a prefix (kind of entry and digest version): for an entry.
    pub fn of(what: &str) -> Self {
        let mut canon = Self::new();
        canon.text(what);
        canon.integer(DIGEST_VERSION);
        canon
    }

    pub fn text(&mut self, text: &str) {
        self.take(Field::Text(text));
    }

    pub fn integer(&mut self, integer: i64) {
        self.take(Field::Integer(integer));
    }

    pub fn bytes(&mut self, bytes: &[u8]) {
        self.take(Field::Bytes(bytes));
    }

    /// Adds values about to be stored.
    pub fn values(&mut self, values: &[Value<'_>]) {
        values.iter().for_each(|value| self.take(value.field()));
    }

    /// Adds a field as a database would return it: NaN as NULL, −0 as 0, and text without NUL characters, which
    /// PostgreSQL does not store.
    pub fn take(&mut self, field: Field<'_>) {
        match field {
            Field::Real(value) if value.is_nan() => self.raw(Field::Null),
            Field::Real(value) => self.raw(Field::Real(value + 0.0)),
            Field::Text(text) if text.contains('\0') => {
                self.raw(Field::Text(&text.replace('\0', "\u{fffd}")));
            }
            field => self.raw(field),
        }
    }

    /// Adds a field with its type and length.
    pub fn raw(&mut self, field: Field<'_>) {
        let (kind, bytes): (u8, &[u8]) = match &field {
            Field::Null => (0, &[]),
            Field::Integer(value) => (1, &value.to_be_bytes()),
            Field::Real(value) => (2, &value.to_bits().to_be_bytes()),
            Field::Text(text) => (3, text.as_bytes()),
            Field::Bytes(bytes) => (4, bytes),
        };
        self.plain(&[kind]);
        self.plain(&(bytes.len() as u64).to_be_bytes());
        self.plain(bytes);
    }

    /// Adds bytes without type and length.
    pub fn plain(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    pub fn finish(self) -> [u8; 32] {
        self.0.finalize().into()
    }
}

/// Version of the list of fields that a digest covers; another list needs another number.
const DIGEST_VERSION: i64 = 1;

/// Adds all fields of each row of a result.
pub(crate) fn take_rows(
    canon: &mut CanonicalHash,
    backend: &Backend,
    sql: &str,
    values: &[Value<'_>],
) -> SqlResult<()> {
    let columns = columns(sql);
    backend.each(sql, values, |row| {
        (0..columns).try_for_each(|column| {
            canon.take(row.field(column)?);
            Ok(())
        })
    })
}

/// The number of columns between `SELECT` and `FROM`; none of them may contain a comma.
pub(crate) fn columns(sql: &str) -> usize {
    let list = sql.split("FROM").next().unwrap_or_default();
    list.matches(',').count() + 1
}
