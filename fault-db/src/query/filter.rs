//! Builds a WHERE clause: conditions joined by AND, values always bound as parameters.

use crate::backend::Value;

/// Conditions joined by AND, with their parameter values.
#[derive(Clone, Default)]
pub(crate) struct Conditions {
    sql: Vec<String>,
    values: Vec<Value<'static>>,
}

impl Conditions {
    /// Adds a condition in which `?` stands for the value; adds nothing without a value.
    pub fn add(&mut self, sql: &str, value: Option<impl Into<Value<'static>>>) {
        if let Some(value) = value {
            let place = self.place(value);
            self.sql.push(sql.replace('?', &place));
        }
    }

    /// Adds a condition without values.
    pub fn require(&mut self, sql: impl Into<String>) {
        self.sql.push(sql.into());
    }

    /// Adds a condition that a column is one of these.
    pub fn one_of<T: Into<Value<'static>>>(&mut self, column: &str, values: Vec<T>) {
        let places: Vec<_> = values.into_iter().map(|value| self.place(value)).collect();
        self.sql.push(match places.is_empty() {
            true => "1 = 0".to_owned(),
            false => format!("{column} IN ({})", places.join(", ")),
        });
    }

    /// Binds a value; returns its placeholder.
    pub fn place(&mut self, value: impl Into<Value<'static>>) -> String {
        self.values.push(value.into());
        format!("?{}", self.values.len())
    }

    /// `WHERE …`, or an empty text.
    pub fn sql(&self) -> String {
        if self.sql.is_empty() {
            String::new()
        } else {
            format!("WHERE {}", self.sql.join(" AND "))
        }
    }

    /// The bound values, in the order of their placeholders.
    pub fn values(&self) -> &[Value<'_>] {
        &self.values
    }
}

/// `LIMIT …`, or an empty text.
pub(crate) fn limit(most: Option<u32>) -> String {
    most.map_or_else(String::new, |most| format!("LIMIT {most}"))
}
