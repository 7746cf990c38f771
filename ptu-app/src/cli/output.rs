//! An answer as a table, as JSON or as CSV: one list of rows for the latter two.

use clap::Args;
use serde_json::Value;

use super::{print_json, print_out};
use crate::failure::{Exit, Failure};
use crate::report::csv::Cell;

/// How an answer is printed.
#[derive(Clone, Debug, Args)]
pub struct Output {
    /// Print JSON
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print CSV, a line of headings first
    #[arg(long)]
    csv: bool,
    /// Save the question under a name, for `ptu saved`
    #[arg(long, value_name = "NAME")]
    save: Option<String>,
}

impl Output {
    /// Neither JSON nor CSV.
    pub fn is_table(&self) -> bool {
        !self.json && !self.csv
    }

    /// JSON.
    pub fn is_json(&self) -> bool {
        self.json
    }

    /// Saves the question, if it was given a name.
    pub fn save(&self) -> Result<(), Failure> {
        match &self.save {
            Some(name) => super::saved::save(name, std::env::args_os()),
            None => Ok(()),
        }
    }

    /// Prints rows, or the table of them. All rows have the same keys.
    pub fn print(&self, rows: &[Value], table: impl FnOnce() -> String) -> Result<Exit, Failure> {
        if self.json {
            print_json(&rows)
        } else if self.csv {
            print_out(csv(rows).trim_end())
        } else {
            print_out(&table())
        }
    }
}

/// Rows as CSV (RFC 4180); what is no single value stands as JSON.
fn csv(rows: &[Value]) -> String {
    let Some(first) = rows.first().and_then(Value::as_object) else {
        return String::new();
    };
    let line = |cells: Vec<Cell>| {
        cells
            .into_iter()
            .map(Cell::written)
            .collect::<Vec<_>>()
            .join(",")
    };
    let mut text = line(first.keys().map(|key| Cell::Text(key.clone())).collect()) + "\n";
    for row in rows {
        let cells = first
            .keys()
            .map(|key| cell(row.get(key).unwrap_or(&Value::Null)));
        text += &line(cells.collect());
        text.push('\n');
    }
    text
}

fn cell(value: &Value) -> Cell {
    match value {
        Value::Null => Cell::Number(String::new()),
        Value::String(text) => Cell::Text(text.clone()),
        Value::Number(_) | Value::Bool(_) => Cell::Number(value.to_string()),
        Value::Array(_) | Value::Object(_) => Cell::Text(value.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn rows_become_lines_under_their_keys() {
        let rows = [
            json!({"key": "a,b", "n": 1, "last": null}),
            json!({"key": "=1", "n": -2.5, "last": [1, 2]}),
        ];
        assert_eq!(csv(&rows), "key,n,last\n\"a,b\",1,\n'=1,-2.5,\"[1,2]\"\n");
        assert_eq!(csv(&[]), "");
    }
}
