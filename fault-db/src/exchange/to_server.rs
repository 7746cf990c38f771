//! Applies change sets to a PostgreSQL server: each table by one statement over all its rows, which are sent
//! as arrays, column by column.

use std::borrow::Cow;

use postgres::types::ToSql;

use super::change_set::{ChangeSet, Counts};
use super::columns::{Column, Kind};
use super::rows::Rows;
use super::tables::{COUNT, TableId};
use crate::backend::{Backend, Server, SqlResult, Value};
use crate::history::event_graph::settle;
use crate::history::recurrence::HighWaterMark;

/// A server to which change sets of a laptop are applied, in the caller's transaction.
pub(super) struct ServerApplier<'a> {
    pub backend: &'a Backend,
    /// The PostgreSQL connection of `backend`.
    pub server: &'a Server,
    /// The server's row number of the laptop.
    pub laptop: i64,
}

impl ServerApplier<'_> {
    /// Adds the rows that the server does not have, and settles their faults; returns the numbers of new rows.
    pub fn apply(&self, set: &ChangeSet) -> SqlResult<Counts> {
        let mark = HighWaterMark::of(self.backend)?;
        let mut counts = [0; COUNT];
        // Aliases come before the faults: an alias tells that a fault is already here under another id.
        self.insert(set.rows(TableId::Alias))?;
        for rows in set.tables() {
            counts[rows.table.of as usize] = self.insert(rows)?;
        }
        let faults = set
            .rows(TableId::Fault)
            .column(0)
            .filter_map(Value::id)
            .collect();
        settle(self.backend, &faults, Some(mark))?;
        Ok(counts)
    }

    /// Adds the rows of one table; returns the number of new ones.
    pub fn insert(&self, rows: &Rows) -> SqlResult<u64> {
        if rows.count() == 0 {
            return Ok(0);
        }
        let table = rows.table;
        let arrays: Vec<_> = (table.sent(true).enumerate())
            .map(|(place, column)| array(rows, place, column))
            .collect();
        let arrays: Vec<_> = arrays.iter().map(|array| &**array).collect();
        let execute =
            |sql: &str| (self.server).execute_columns(&table.filled(sql, self.laptop), &arrays);
        let new = match table.is_inserted {
            true => execute(&table.insert_into_server())?,
            false => 0,
        };
        for sql in table.server_after {
            execute(sql)?;
        }
        Ok(new)
    }
}

/// The values of a column as an array, without NUL characters in text, which PostgreSQL does not store.
fn array<'a>(rows: &'a Rows, place: usize, column: &Column) -> Box<dyn ToSql + Sync + 'a> {
    fn all<'a, T>(
        rows: &'a Rows,
        place: usize,
        one: impl Fn(&'a Value<'static>) -> Option<T>,
    ) -> Vec<Option<T>> {
        rows.column(place).map(one).collect()
    }
    match column.kind {
        Kind::Integer => Box::new(all(rows, place, |value| match value {
            Value::Integer(value) => Some(*value),
            _ => None,
        })),
        Kind::Real => Box::new(all(rows, place, |value| match value {
            Value::Real(value) => Some(*value),
            _ => None,
        })),
        Kind::Text | Kind::Unit => Box::new(all(rows, place, |value| match value {
            Value::Text(text) if text.contains('\0') => {
                Some(Cow::Owned(text.replace('\0', "\u{fffd}")))
            }
            Value::Text(text) => Some(Cow::Borrowed(&text[..])),
            _ => None,
        })),
        Kind::Bytes | Kind::Run | Kind::Fault | Kind::ChannelSet | Kind::Trace => {
            Box::new(all(rows, place, |value| match value {
                Value::Bytes(bytes) => Some(&bytes[..]),
                _ => None,
            }))
        }
    }
}
