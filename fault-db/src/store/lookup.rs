//! Finds a row by what a user types: a full id, its beginning or end, or `latest`.

use crate::backend::{Backend, SqlResult, Value};
use crate::error::StoreError;
use crate::id::Id;
use crate::store::Store;

/// Fewest hex digits of a partial id.
const MIN_DIGITS: usize = 4;
const ID_DIGITS: usize = 32;
/// Digits of an id's end that tables show; an index finds them.
const SHORT_DIGITS: usize = 8;
const DOING: &str = "looking up an id";
/// Matches listed of an ambiguous partial id.
const MATCHES_SHOWN: usize = 4;

/// A table whose rows users name.
struct NamedTable {
    what: &'static str,
    table: &'static str,
    /// Aliases of its rows: a table expression with `id` and `named`, the row's own id.
    aliases: Option<&'static str>,
    newest_first: &'static str,
    /// Rows among which the latest is looked for.
    among: &'static str,
}

/// The last run of each chain, as it was recorded whatever the clock said, and one that has not ended.
const LAST_RUNS: &str = "WHERE seq = (SELECT max(seq) FROM run) AND verdict IS NULL OR id IN (
    SELECT (SELECT s.id FROM seal s WHERE s.origin = o.origin AND s.what = 'run' ORDER BY s.ordinal DESC LIMIT 1)
    FROM (SELECT DISTINCT origin FROM seal) o)";

impl Store {
    /// The run with this id, the beginning or end of an id, or `latest`.
    pub fn resolve_run(&self, asked: &str) -> Result<Id, StoreError> {
        let newest_first = "started_at_us DESC, seq DESC";
        self.resolve(
            &NamedTable {
                what: "run",
                table: "run",
                aliases: None,
                newest_first,
                among: LAST_RUNS,
            },
            asked,
        )
    }

    /// The fault with this id, the beginning or end of an id, or `latest`.
    pub fn resolve_fault(&self, asked: &str) -> Result<Id, StoreError> {
        let newest_first = "last_at_us DESC, seq DESC";
        self.resolve(
            &NamedTable {
                what: "fault",
                table: "fault",
                aliases: Some(
                    "(SELECT a.id, f.id AS named FROM fault_alias a JOIN fault f ON f.seq = a.fault) AS other",
                ),
                newest_first,
                among: "",
            },
            asked,
        )
    }

    /// The trace with this id, the beginning or end of an id, or `latest`.
    pub fn resolve_trace(&self, asked: &str) -> Result<Id, StoreError> {
        let newest_first = "t0_us DESC, seq DESC";
        self.resolve(
            &NamedTable {
                what: "trace",
                table: "trace",
                aliases: None,
                newest_first,
                among: "",
            },
            asked,
        )
    }

    fn resolve(&self, named: &NamedTable, asked: &str) -> Result<Id, StoreError> {
        let NamedTable {
            what,
            table,
            newest_first,
            among,
            ..
        } = *named;
        if asked == "latest" {
            let sql = format!("SELECT id FROM {table} {among} ORDER BY {newest_first} LIMIT 1");
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
            [] if let Some(run) = self.run_that_names(named, &digits.to_ascii_lowercase())? => {
                Err(StoreError::TraceMissing {
                    asked: asked.to_owned(),
                    run,
                })
            }
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

    /// The run whose seal names a trace of this id that a file does not have.
    fn run_that_names(&self, named: &NamedTable, digits: &str) -> Result<Option<Id>, StoreError> {
        if named.table != "trace" || !matches!(&self.backend, Backend::File(_)) {
            return Ok(None);
        }
        const SQL: &str = "SELECT s.id FROM seal s,
                json_each(CASE WHEN json_valid(s.says) THEN s.says ELSE '{}' END, '$.traces') t
            WHERE s.what = 'run' AND (
                replace(t.value ->> 'id', '-', '') LIKE ?1 || '%'
                OR replace(t.value ->> 'id', '-', '') LIKE '%' || ?1) LIMIT 1";
        self.first(DOING, SQL, &[digits.into()], |row| row.get(0))
    }

    fn matches(&self, named: &NamedTable, digits: &str) -> SqlResult<Vec<Id>> {
        let table = named.table;
        let bound = |fill| Value::Bytes(bytes(&padded(digits, fill)).into());
        let (low, high) = (bound('0'), bound('f'));
        if digits.len() == ID_DIGITS {
            let mut exact = format!("SELECT id FROM {table} WHERE id = ?1");
            if let Some(aliases) = named.aliases {
                exact += &format!(" UNION SELECT named FROM {aliases} WHERE id = ?1");
            }
            return self.backend.select(&exact, &[low], |row| row.get(0));
        }
        // A beginning is a range of the index, and so is the end that tables show; any other end scans all
        // ids.
        let (by_end, end) = if digits.len() == SHORT_DIGITS {
            (
                "substr(id, 13) = ?3".to_owned(),
                Value::Bytes(bytes(digits).into()),
            )
        } else {
            let hex = match &self.backend {
                Backend::File(_) => "lower(hex(id))",
                Backend::Server(_) => "encode(id, 'hex')",
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
        self.backend
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
