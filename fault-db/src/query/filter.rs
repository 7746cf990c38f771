//! Filters as SQL: conditions joined by AND, values always bound.

use rusqlite::params_from_iter;
use rusqlite::types::Value;

/// Conditions of a filter, joined by AND, with their values.
#[derive(Default)]
pub(crate) struct Conditions {
    sql: Vec<String>,
    values: Vec<Value>,
}

impl Conditions {
    /// Adds a condition with one `?`, if there is a value for it.
    pub fn add(&mut self, sql: &str, value: Option<impl Into<Value>>) {
        if let Some(value) = value {
            self.sql.push(sql.to_owned());
            self.values.push(value.into());
        }
    }

    /// `WHERE …`, or nothing.
    pub fn sql(&self) -> String {
        if self.sql.is_empty() {
            String::new()
        } else {
            format!("WHERE {}", self.sql.join(" AND "))
        }
    }

    pub fn params(&self) -> impl rusqlite::Params + '_ {
        params_from_iter(self.values.iter())
    }
}
