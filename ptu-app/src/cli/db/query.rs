//! `ptu db query`: a question in SQL.

use clap::Args;
use fault_db::{QueryResult, SqlValue};
use serde_json::{Map, Value, json};

use crate::cli::output::Output;
use crate::cli::{Database, print_json};
use crate::failure::{Exit, Failure};
use crate::table::Table;

/// Rows a query prints at most.
const MAX_ROWS: usize = 10_000;

/// Ask the database in SQL, reading only; `ptu db schema` says about what
///
/// Examples:
///   ptu db query "SELECT unit, count(*) FROM faults WHERE state = 'open' GROUP BY unit"
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct QueryArguments {
    /// The question
    #[arg(value_name = "SELECT …")]
    sql: String,
    #[command(flatten)]
    output: Output,
}

impl QueryArguments {
    pub fn query(&self, database: &Database) -> Result<Exit, Failure> {
        let answer = database
            .open_read_only()?
            .query_read_only(&self.sql, MAX_ROWS)?;
        self.output.save()?;
        if self.output.is_json() {
            return print_json(&answer);
        }
        if answer.truncated && !self.output.is_table() {
            eprintln!("only the first {MAX_ROWS} rows; add LIMIT, or ask for less");
        }
        let columns = columns(&answer);
        let columns: Vec<_> = columns.iter().map(String::as_str).collect();
        self.output
            .print(&columns, &rows(&answer, &columns), || table(&answer))
    }
}

/// The names of the columns; of two with one name the last has another.
fn columns(answer: &QueryResult) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for column in &answer.columns {
        let mut name = column.clone();
        while names.contains(&name) {
            name.push('_');
        }
        names.push(name);
    }
    names
}

/// Each row by the names of its columns.
fn rows(answer: &QueryResult, columns: &[&str]) -> Vec<Value> {
    let row = |row: &Vec<SqlValue>| {
        let cells = columns.iter().zip(row);
        Value::Object(
            cells
                .map(|(name, value)| ((*name).to_owned(), json!(value)))
                .collect::<Map<_, _>>(),
        )
    };
    answer.rows.iter().map(row).collect()
}

fn table(answer: &QueryResult) -> String {
    let headings: Vec<_> = answer.columns.iter().map(String::as_str).collect();
    let is_number =
        |value: Option<&SqlValue>| matches!(value, Some(SqlValue::Integer(_) | SqlValue::Real(_)));
    let numbers = (0..headings.len()).filter(|column| {
        answer
            .rows
            .first()
            .is_some_and(|row| is_number(row.get(*column)))
    });
    let mut table = Table::new(&headings).right(numbers);
    for row in &answer.rows {
        table.row(row.iter().map(|value| match value {
            SqlValue::Null => String::new(),
            SqlValue::Integer(number) => number.to_string(),
            SqlValue::Real(number) => real(*number),
            SqlValue::Text(text) => text.clone(),
        }));
    }
    let more = match answer.truncated {
        true => "\n… more rows; add LIMIT",
        false => "",
    };
    format!("{}{more}", table.render())
}

/// As few digits as tell it from all other numbers; with an exponent where zeros would fill the table.
fn real(number: f64) -> String {
    let size = number.abs();
    if size > 0.0 && size.is_finite() && !(1e-5..=1e15).contains(&size) {
        return format!("{number:e}");
    }
    number.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_an_exponent_only_where_they_need_one() {
        for (number, text) in [
            (0.0, "0"),
            (-2.5, "-2.5"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e15, "1000000000000000"),
            (1e300, "1e300"),
            (-1.25e-7, "-1.25e-7"),
            (0.00001, "0.00001"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(real(number), text);
        }
    }
}
