//! Finding a row by what a person types: a full id, a part of one, or `latest`.

use crate::base::{Base, SqlResult, Value};
use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;

/// A part of an id has at least this many hex digits.
const MIN_DIGITS: usize = 4;
const ID_DIGITS: usize = 32;
/// The end of an id that is shown in tables, found by an index.
const SHORT_DIGITS: usize = 8;
const DOING: &str = "looking up an id";
/// So many of an ambiguous part's matches are named.
const MATCHES_SHOWN: usize = 4;

/// A table people name rows of.
struct Named {
    what: &'static str,
    table: &'static str,
    /// Other ids of its rows, as `id` and `named`, the row's own.
    aliases: Option<&'static str>,
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
                aliases: None,
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
                aliases: Some(
                    "(SELECT a.id, f.id AS named FROM fault_alias a JOIN fault f ON f.seq = a.fault) AS other",
                ),
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
                aliases: None,
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
            ..
        } = *named;
        if asked == "latest" {
            let sql = format!("SELECT id FROM {table} ORDER BY {newest_first} LIMIT 1");
            let found = self.first(DOING, &sql, &[], |row| row.get(0))?;
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
        let matches = self.matches(named, &digits.to_ascii_lowercase());
        let matches = matches.map_err(|error| self.failed(DOING, error))?;
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

    fn matches(&self, named: &Named, digits: &str) -> SqlResult<Vec<Id>> {
        let table = named.table;
        let bound = |fill| Value::Bytes(bytes(&padded(digits, fill)).into());
        let (low, high) = (bound('0'), bound('f'));
        if digits.len() == ID_DIGITS {
            let mut exact = format!("SELECT id FROM {table} WHERE id = ?1");
            if let Some(aliases) = named.aliases {
                exact += &format!(" UNION SELECT named FROM {aliases} WHERE id = ?1");
            }
            return self.base().select(&exact, &[low], |row| row.get(0));
        }
        // The beginning is a range of the index, and so is the end that tables show; any other end has to
        // look at every id.
        let (by_end, end) = if digits.len() == SHORT_DIGITS {
            (
                "substr(id, 13) = ?3".to_owned(),
                Value::Bytes(bytes(digits).into()),
            )
        } else {
            let hex = match self.base() {
                Base::File(_) => "lower(hex(id))",
                Base::Server(_) => "encode(id, 'hex')",
            };
            let from = ID_DIGITS - digits.len() + 1;
            (format!("substr({hex}, {from}) = ?3"), digits.into())
        };
        let mut sql = format!(
            "SELECT id FROM {table} WHERE id BETWEEN ?1 AND ?2
             UNION SELECT id FROM {table} WHERE {by_end}"
        );
        if let Some(aliases) = named.aliases {
            sql += &format!(
                " UNION SELECT named FROM {aliases} WHERE id BETWEEN ?1 AND ?2 OR {by_end}"
            );
        }
        sql += &format!(" LIMIT {MATCHES_SHOWN}");
        self.base()
            .select(&sql, &[low, high, end], |row| row.get(0))
    }
}

fn padded(digits: &str, fill: char) -> String {
    let mut padded = digits.to_owned();
    padded.extend(std::iter::repeat_n(fill, ID_DIGITS - digits.len()));
    padded
}

/// Bytes of an even number of hex digits.
fn bytes(digits: &str) -> Vec<u8> {
    let pairs = digits.as_bytes().chunks_exact(2);
    let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap_or(""), 16);
    pairs.map(|pair| byte(pair).unwrap_or_default()).collect()
}
