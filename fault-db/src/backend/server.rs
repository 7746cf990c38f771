//! A PostgreSQL connection with the same query interface as a file.

use std::cell::RefCell;
use std::collections::HashMap;

use postgres::fallible_iterator::FallibleIterator as _;
use postgres::types::{IsNull, ToSql, Type, to_sql_checked};
use postgres::{Client, Statement};

use super::error::SqlResult;
use super::value::Value;

/// Number of the advisory lock that all writers take: the letters `FTDB`.
const WRITERS_LOCK: i64 = 0x4654_4442;

pub(crate) struct Server {
    client: RefCell<Client>,
    /// Prepared statements by text and parameter types, as the server plans for both.
    statements: RefCell<HashMap<(String, Vec<Type>), Statement>>,
}

impl Server {
    pub fn new(client: Client) -> Self {
        Self {
            client: RefCell::new(client),
            statements: RefCell::default(),
        }
    }

    pub fn each(
        &self,
        sql: &str,
        values: &[Value<'_>],
        mut take: impl FnMut(&postgres::Row) -> SqlResult<()>,
    ) -> SqlResult<()> {
        let statement = self.prepared(sql, values)?;
        let mut client = self.client.borrow_mut();
        let mut rows = client.query_raw(&statement, values)?;
        while let Some(row) = rows.next()? {
            take(&row)?;
        }
        Ok(())
    }

    pub fn execute(&self, sql: &str, values: &[Value<'_>]) -> SqlResult<u64> {
        let statement = self.prepared(sql, values)?;
        let places: Vec<_> = values.iter().map(|v| v as &(dyn ToSql + Sync)).collect();
        Ok(self.client.borrow_mut().execute(&statement, &places)?)
    }

    /// Lends the connection itself, for operations that only servers have.
    pub fn with_client<T>(&self, work: impl FnOnce(&mut Client) -> T) -> T {
        work(&mut self.client.borrow_mut())
    }

    /// Executes one or several statements without parameters or results.
    pub fn batch(&self, sql: &str) -> SqlResult<()> {
        Ok(self.client.borrow_mut().batch_execute(sql)?)
    }

    /// Begins a transaction that excludes this program's other writers. So rows become visible in the order of their
    /// numbers: a reader who has seen a number has seen all before it.
    pub fn begin(&self) -> SqlResult<()> {
        let begun = self.batch(&format!(
            "BEGIN; SELECT pg_advisory_xact_lock({WRITERS_LOCK})"
        ));
        begun.inspect_err(|_| {
            // Another writer may hold the lock for too long; then the transaction is to be ended.
            let _ = self.batch("ROLLBACK");
        })
    }

    /// Executes a statement whose parameters are whole columns, each an array; returns the number of rows changed.
    pub fn execute_columns(&self, sql: &str, columns: &[&(dyn ToSql + Sync)]) -> SqlResult<u64> {
        let statement = self.prepared(sql, &[])?;
        Ok(self.client.borrow_mut().execute(&statement, columns)?)
    }

    /// The result of a query whose parameters are whole columns, each an array.
    pub fn select_columns(
        &self,
        sql: &str,
        columns: &[&(dyn ToSql + Sync)],
    ) -> SqlResult<Vec<postgres::Row>> {
        let statement = self.prepared(sql, &[])?;
        Ok(self.client.borrow_mut().query(&statement, columns)?)
    }

    fn prepared(&self, sql: &str, values: &[Value<'_>]) -> SqlResult<Statement> {
        let types: Vec<_> = values.iter().map(Value::server_type).collect();
        let key = (sql.to_owned(), types);
        if let Some(known) = self.statements.borrow().get(&key) {
            return Ok(known.clone());
        }
        let text = dollar_places(sql);
        let statement = self.client.borrow_mut().prepare_typed(&text, &key.1)?;
        self.statements.borrow_mut().insert(key, statement.clone());
        Ok(statement)
    }
}

/// SQL with PostgreSQL's parameters: `$1` for `?1`, except in quotes.
fn dollar_places(sql: &str) -> String {
    let mut quoted = false;
    let mut text = String::with_capacity(sql.len());
    for letter in sql.chars() {
        quoted ^= letter == '\'';
        text.push(if letter == '?' && !quoted {
            '$'
        } else {
            letter
        });
    }
    text
}

impl Value<'_> {
    /// The parameter's type; for NULL the server infers it.
    fn server_type(&self) -> Type {
        match self {
            Self::Null => Type::UNKNOWN,
            Self::Integer(_) => Type::INT8,
            Self::Real(_) => Type::FLOAT8,
            Self::Text(_) => Type::TEXT,
            Self::Bytes(_) => Type::BYTEA,
        }
    }
}

impl ToSql for Value<'_> {
    fn to_sql(
        &self,
        of_type: &Type,
        out: &mut bytes::BytesMut,
    ) -> Result<IsNull, Box<dyn std::error::Error + Sync + Send>> {
        match self {
            Self::Null => Ok(IsNull::Yes),
            Self::Integer(integer) => integer.to_sql(of_type, out),
            Self::Real(real) => real.to_sql(of_type, out),
            Self::Text(text) => text.to_sql(of_type, out),
            Self::Bytes(bytes) => bytes.to_sql(of_type, out),
        }
    }

    fn accepts(_: &Type) -> bool {
        true
    }

    to_sql_checked!();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_the_servers_and_quotes_stay() {
        assert_eq!(
            dollar_places("SELECT '?1' WHERE a = ?1 AND b = ?12"),
            "SELECT '?1' WHERE a = $1 AND b = $12"
        );
    }
}
