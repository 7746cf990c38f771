//! Finding a row by what a person types: a full id, a part of one, or `latest`.

use rusqlite::{OptionalExtension, params};

use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;

/// A part of an id has at least this many hex digits.
const MIN_DIGITS: usize = 4;
const ID_DIGITS: usize = 32;
/// So many of an ambiguous part's matches are named.
const MATCHES_SHOWN: usize = 4;

/// A table people name rows of.
struct Named {
    what: &'static str,
    table: &'static str,
    newest_first: &'static str,
}

impl Store {
    /// The run meant by `asked`: an id, its beginning or end, or `latest`.
    pub fn resolve_run(&self, asked: &str) -> Result<Id, StoreError> {
        let newest_first = "started_at_us DESC, seq DESC";
        self.resolve(
            &Named {
                what: "run",
                table: "run",
                newest_first,
            },
            asked,
        )
    }

    /// The fault meant by `asked`: an id, its beginning or end, or `latest`.
    pub fn resolve_fault(&self, asked: &str) -> Result<Id, StoreError> {
        let newest_first = "last_at_us DESC, seq DESC";
        self.resolve(
            &Named {
                what: "fault",
                table: "fault",
                newest_first,
            },
            asked,
        )
    }

    /// The trace meant by `asked`: an id, its beginning or end, or `latest`.
    pub fn resolve_trace(&self, asked: &str) -> Result<Id, StoreError> {
        let newest_first = "t0_us DESC, seq DESC";
        self.resolve(
            &Named {
                what: "trace",
                table: "trace",
                newest_first,
            },
            asked,
        )
    }

    fn resolve(&self, named: &Named, asked: &str) -> Result<Id, StoreError> {
        let Named {
            what,
            table,
            newest_first,
        } = *named;
        if asked == "latest" {
            let sql = format!("SELECT id FROM {table} ORDER BY {newest_first} LIMIT 1");
            let found = self.conn.query_row(&sql, [], |row| row.get(0)).optional();
            let found = found.map_err(|error| self.failed("looking up an id", error))?;
            return found.ok_or_else(|| StoreError::NotFound {
                what,
                asked: asked.to_owned(),
            });
        }
        let digits: String = asked.chars().filter(|c| *c != '-').collect();
        let is_hex = digits.bytes().all(|byte| byte.is_ascii_hexdigit());
        if !is_hex || !(MIN_DIGITS..=ID_DIGITS).contains(&digits.len()) {
            return Err(StoreError::BadId {
                what,
                asked: asked.to_owned(),
            });
        }
        let matches = self.matches(table, &digits.to_ascii_uppercase());
        let matches = matches.map_err(|error| self.failed("looking up an id", error))?;
        match matches[..] {
            [] => Err(StoreError::NotFound {
                what,
                asked: asked.to_owned(),
            }),
            [id] => Ok(id),
            _ => Err(StoreError::Ambiguous {
                what,
                asked: asked.to_owned(),
                matches,
            }),
        }
    }

    fn matches(&self, table: &str, digits: &str) -> rusqlite::Result<Vec<Id>> {
        if digits.len() == ID_DIGITS {
            let exact = format!("SELECT id FROM {table} WHERE id = unhex(?1)");
            let mut exact = self.conn.prepare_cached(&exact)?;
            return exact
                .query_map(params![digits], |row| row.get(0))?
                .collect();
        }
        let low = bound(digits, '0');
        let high = bound(digits, 'F');
        // The beginning is a range of the index; the end has to look at every id of the index.
        let by_end = format!(
            "SELECT id FROM {table} WHERE id BETWEEN unhex(?1) AND unhex(?2)
             UNION SELECT id FROM {table} WHERE substr(hex(id), -length(?3)) = ?3
             LIMIT {MATCHES_SHOWN}"
        );
        self.conn
            .prepare_cached(&by_end)?
            .query_map(params![low, high, digits], |row| row.get(0))?
            .collect()
    }

    /// Turns "no row" into an error that names what was asked.
    pub(crate) fn not_found(
        &self,
        what: &'static str,
        id: Id,
        error: rusqlite::Error,
    ) -> StoreError {
        match error {
            rusqlite::Error::QueryReturnedNoRows => StoreError::NotFound {
                what,
                asked: id.to_string(),
            },
            error => self.failed("looking up an id", error),
        }
    }
}

fn bound(digits: &str, fill: char) -> String {
    let mut bound = digits.to_owned();
    bound.extend(std::iter::repeat_n(fill, ID_DIGITS - digits.len()));
    bound
}
