//! Finds a row by what a user types: a full id, its beginning or end, or `latest`.

use crate::backend::{Backend, SqlResult, Value, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::seal::from_hex;
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
    name: &'static str,
    /// SQL: a table expression of aliases, with `id` and `named`, the row's own id.
    aliases: Option<&'static str>,
    newest_first: &'static str,
    /// SQL: condition on the rows among which `latest` is looked for.
    among: &'static str,
}

const RUN: NamedTable = NamedTable {
    name: "run",
    aliases: None,
    newest_first: "started_at_us DESC, seq DESC",
    among: LAST_RUNS,
};

const FAULT: NamedTable = NamedTable {
    name: "fault",
    aliases: Some(
        "(SELECT a.id, f.id AS named FROM fault_alias a JOIN fault f ON f.seq = a.fault) AS other",
    ),
    newest_first: "last_at_us DESC, seq DESC",
    among: "",
};

const TRACE: NamedTable = NamedTable {
    name: "trace",
    aliases: None,
    newest_first: "t0_us DESC, seq DESC",
    among: "",
};

/// SQL: the last run of each chain of seals, in the order of recording whatever the clock said, and a last run that has
/// not ended.
const LAST_RUNS: &str = "WHERE seq = (SELECT max(seq) FROM run) AND verdict IS NULL OR id IN (
    SELECT (SELECT s.id FROM seal s WHERE s.origin = o.origin AND s.what = 'run' ORDER BY s.ordinal DESC LIMIT 1)
    FROM (SELECT DISTINCT origin FROM seal) o)";

impl Store {
    /// The run with this id, the beginning or end of an id, or `latest`.
    pub fn resolve_run(&self, asked: &str) -> Result<Id, StoreError> {
        self.resolve(&RUN, asked)
    }

    /// The fault with this id, the beginning or end of an id, or `latest`.
    pub fn resolve_fault(&self, asked: &str) -> Result<Id, StoreError> {
        self.resolve(&FAULT, asked)
    }

    /// The trace with this id, the beginning or end of an id, or `latest`.
    pub fn resolve_trace(&self, asked: &str) -> Result<Id, StoreError> {
        self.resolve(&TRACE, asked)
    }

    /// The row number of a run.
    pub(crate) fn run_seq(&self, doing: &'static str, run: Id) -> Result<i64, StoreError> {
        let sql = "SELECT seq FROM run WHERE id = ?1";
        let seq = self.first(doing, sql, &values![run], |row| row.get(0))?;
        seq.ok_or_else(|| StoreError::not_found("run", run))
    }

    fn resolve(&self, named: &NamedTable, asked: &str) -> Result<Id, StoreError> {
        let (what, asked_for) = (named.name, || asked.to_owned());
        let not_found = || StoreError::NotFound {
            what,
            asked: asked_for(),
        };
        if asked == "latest" {
            let (among, newest_first) = (named.among, named.newest_first);
            let sql = format!("SELECT id FROM {what} {among} ORDER BY {newest_first} LIMIT 1");
            let found = self.first(DOING, &sql, &[], |row| row.get(0))?;
            return found.ok_or_else(not_found);
        }
        let digits: String = asked.chars().filter(|c| *c != '-').collect();
        let is_hex = digits.bytes().all(|byte| byte.is_ascii_hexdigit());
        if !is_hex || !(MIN_DIGITS..=ID_DIGITS).contains(&digits.len()) {
            let asked = asked_for();
            return Err(StoreError::BadId { what, asked });
        }
        let digits = digits.to_ascii_lowercase();
        let matches = self.ask(DOING, |backend| matches(backend, named, &digits))?;
        match matches[..] {
            [] => Err(match self.run_that_names(named, &digits)? {
                Some(run) => StoreError::TraceMissing {
                    asked: asked_for(),
                    run,
                },
                None => not_found(),
            }),
            [id] => Ok(id),
            _ => Err(StoreError::Ambiguous {
                what,
                asked: asked_for(),
                matches,
            }),
        }
    }

    /// The run whose seal names a trace with these digits that the file does not have.
    fn run_that_names(&self, named: &NamedTable, digits: &str) -> Result<Option<Id>, StoreError> {
        if named.name != "trace" || !matches!(&self.backend, Backend::File(_)) {
            return Ok(None);
        }
        const SQL: &str = "SELECT s.id FROM seal s,
                json_each(CASE WHEN json_valid(s.says) THEN s.says ELSE '{}' END, '$.traces') t
            WHERE s.what = 'run' AND (
                replace(t.value ->> 'id', '-', '') LIKE ?1 || '%'
                OR replace(t.value ->> 'id', '-', '') LIKE '%' || ?1) LIMIT 1";
        self.first(DOING, SQL, &[digits.into()], |row| row.get(0))
    }
}

/// The ids of the rows that digits of an id fit.
fn matches(backend: &Backend, named: &NamedTable, digits: &str) -> SqlResult<Vec<Id>> {
    let table = named.name;
    let bytes = |digits: &str| Value::Bytes(from_hex(digits).unwrap_or_default().into());
    let bound = |fill| bytes(&padded(digits, fill));
    let (low, high) = (bound('0'), bound('f'));
    if digits.len() == ID_DIGITS {
        let mut exact = format!("SELECT id FROM {table} WHERE id = ?1");
        if let Some(aliases) = named.aliases {
            exact += &format!(" UNION SELECT named FROM {aliases} WHERE id = ?1");
        }
        return backend.select(&exact, &[low], |row| row.get(0));
    }
    // An index finds a beginning (as a range) and the end that tables show; any other end scans all ids.
    let (by_end, end) = if digits.len() == SHORT_DIGITS {
        ("substr(id, 13) = ?3".to_owned(), bytes(digits))
    } else {
        let hex = match backend {
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
        sql +=
            &format!(" UNION SELECT named FROM {aliases} WHERE id BETWEEN ?1 AND ?2 OR {by_end}");
    }
    sql += &format!(" LIMIT {MATCHES_SHOWN}");
    backend.select(&sql, &[low, high, end], |row| row.get(0))
}

fn padded(digits: &str, fill: char) -> String {
    let mut padded = digits.to_owned();
    padded.extend(std::iter::repeat_n(fill, ID_DIGITS - digits.len()));
    padded
}
