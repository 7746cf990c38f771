//! How what is sealed is written before it is hashed, so that no two statements look alike: SEALS.md.

use sha2::{Digest as _, Sha256};

use crate::base::{Base, Field, SqlResult, Value};

/// A SHA-256 over fields, each with its kind and length.
#[derive(Clone)]
pub(crate) struct Canon(Sha256);

impl Canon {
    /// Of fields alone: a table of a run.
    pub fn new() -> Self {
        Self(Sha256::new())
    }

    /// Of a statement, which begins with what it is and how much it covers.
    pub fn of(what: &str) -> Self {
        let mut canon = Self::new();
        canon.text(what);
        canon.integer(COVERS);
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

    /// Values as they are about to be stored.
    pub fn values(&mut self, values: &[Value<'_>]) {
        values.iter().for_each(|value| self.take(value.field()));
    }

    /// A field as the store gives it back: no number is not stored, and neither is the sign of nothing. A server
    /// keeps no zero letter in a text.
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

    /// A field with its kind and length.
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

    /// Bytes as they are.
    pub fn plain(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    pub fn finish(self) -> [u8; 32] {
        self.0.finalize().into()
    }
}

/// What a seal of this version covers: everything.
pub(crate) const COVERS: i64 = 2;

/// Takes the fields of each row of an answer, one after the other.
pub(crate) fn take_rows(
    canon: &mut Canon,
    base: &Base,
    sql: &str,
    values: &[Value<'_>],
) -> SqlResult<()> {
    let columns = columns(sql);
    base.each(sql, values, |row| {
        (0..columns).try_for_each(|column| {
            canon.take(row.field(column)?);
            Ok(())
        })
    })
}

/// Columns between `SELECT` and `FROM`, none of which is made with a comma.
pub(crate) fn columns(sql: &str) -> usize {
    let list = sql.split("FROM").next().unwrap_or_default();
    list.matches(',').count() + 1
}
