//! Writes an answer as a table, as JSON or as CSV; the latter two come from one list of rows.

use clap::Args;
use serde::Serialize;
use serde_json::Value;

use super::{questions, terminal};
use ptu_report::csv::{Cell, MARK};
use ptu_report::json_text;
use ptu_report::words::{Language, Words, tell};
use ptu_runs::failure::{Exit, Failure};
use ptu_runs::stdio;

/// Option `--json`: prints an answer as JSON or as text.
#[derive(Clone, Copy, Debug, Args)]
pub struct Json {
    /// Print JSON, with all there is
    #[arg(long)]
    json: bool,
}

impl Json {
    /// Whether the answer is to be JSON.
    pub fn is_asked(self) -> bool {
        self.json
    }

    /// Words for the answer: English for JSON, which other programs read, else the user's language.
    pub fn words(self) -> &'static Words {
        match self.json {
            true => Language::English.words(),
            false => Words::shown(),
        }
    }

    /// Prints the document as JSON, or the text.
    pub fn answer<T: Serialize>(
        self,
        document: impl FnOnce() -> T,
        text: impl FnOnce() -> String,
    ) -> Result<Exit, Failure> {
        match self.json {
            true => print_json(&document()),
            false => print_out(&text()),
        }
    }
}

/// Options `--json` and `--csv`: print a list as JSON, as CSV or as a table.
#[derive(Clone, Copy, Debug, Args)]
pub struct Form {
    /// Print JSON
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print CSV, a line of headings first
    #[arg(long)]
    csv: bool,
}

impl Form {
    /// Whether the list is to be a table, neither JSON nor CSV.
    pub fn is_table(self) -> bool {
        !self.json && !self.csv
    }

    /// Whether the list is to be JSON.
    pub fn is_json(self) -> bool {
        self.json
    }

    /// Prints the rows as JSON or CSV, or else the table; the columns are the keys of the first row.
    pub fn print(self, rows: &[Value], table: impl FnOnce() -> String) -> Result<Exit, Failure> {
        let columns = rows.first().map(keys).unwrap_or_default();
        self.print_columns(&columns, rows, table)
    }

    /// Prints the rows as JSON or CSV, or else the table. Each row has the columns as its keys, in their order.
    pub fn print_columns(
        self,
        columns: &[&str],
        rows: &[Value],
        table: impl FnOnce() -> String,
    ) -> Result<Exit, Failure> {
        if self.json {
            print_json(&rows)
        } else if self.csv {
            print_csv(columns, rows)
        } else {
            print_out(&table())
        }
    }
}

/// Options of a question: how its answer is printed, and a name to save it under.
#[derive(Clone, Debug, Args)]
pub struct Output {
    #[command(flatten)]
    pub form: Form,
    /// Save the question under a name, for `ptu saved`
    #[arg(long, value_name = "NAME")]
    save: Option<String>,
}

impl Output {
    /// Saves the question if `--save` gives a name.
    pub fn save(&self) -> Result<(), Failure> {
        match &self.save {
            Some(name) => questions::save(name, std::env::args_os()),
            None => Ok(()),
        }
    }
}

/// Prints one JSON document.
pub fn print_json(value: &impl Serialize) -> Result<Exit, Failure> {
    stdio::document(&json_text(value)?)?;
    Ok(Exit::Passed)
}

/// Prints text for people.
pub fn print_out(text: &str) -> Result<Exit, Failure> {
    if !terminal::paged(text) {
        stdio::answer(text)?;
    }
    Ok(Exit::Passed)
}

/// Exit code of finished work whose answer was printed, or failed to print. A missing answer turns success into a
/// failure; a failure keeps its own exit code.
pub fn answered(told: Result<Exit, Failure>, exit: Exit) -> Result<Exit, Failure> {
    match told {
        Ok(_) => Ok(exit),
        Err(failure) if exit == Exit::Passed => Err(failure),
        Err(failure) => {
            tell(&failure);
            Ok(exit)
        }
    }
}

/// Prints rows as CSV. Each row has the columns as its keys, in their order.
pub fn print_csv(columns: &[&str], rows: &[Value]) -> Result<Exit, Failure> {
    let mark = if stdio::begins_file() { MARK } else { "" };
    stdio::document(&format!("{mark}{}", csv(columns, rows)))?;
    Ok(Exit::Passed)
}

/// Rows under their headings as CSV (RFC 4180), without a line end after the last row; lists and objects are written
/// as JSON.
fn csv(columns: &[&str], rows: &[Value]) -> String {
    debug_assert!(rows.iter().all(|row| keys(row) == columns));
    let heading = columns.iter().map(|column| Cell::Text((*column).into()));
    let mut lines = vec![line(heading)];
    lines.extend(rows.iter().map(|row| {
        let cells = columns
            .iter()
            .map(|column| cell(row.get(column).unwrap_or(&Value::Null)));
        line(cells)
    }));
    lines.join("\n")
}

/// The keys of a row, in their order.
pub fn keys(row: &Value) -> Vec<&str> {
    let row = row.as_object();
    row.into_iter()
        .flat_map(|row| row.keys().map(String::as_str))
        .collect()
}

fn line(cells: impl Iterator<Item = Cell>) -> String {
    let line = cells.map(Cell::written).collect::<Vec<_>>().join(",");
    match line.is_empty() {
        // A row of one empty cell is written as quotes: many readers skip an empty line.
        true => "\"\"".to_owned(),
        false => line,
    }
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
        assert_eq!(
            csv(&["key", "n", "last"], &rows),
            "key,n,last\n\"a,b\",1,\n'=1,-2.5,\"[1,2]\""
        );
    }

    #[test]
    fn without_rows_there_are_headings() {
        assert_eq!(csv(&["key", "a,b"], &[]), "key,\"a,b\"");
    }

    #[test]
    fn the_last_rows_are_kept_however_empty_they_are() {
        let rows = [
            json!({"a": "x  ", "b": null}),
            json!({"a": null, "b": "  "}),
        ];
        assert_eq!(csv(&["a", "b"], &rows), "a,b\nx  ,\n,  ");
        let rows = [json!({"a": null}), json!({"a": ""})];
        assert_eq!(csv(&["a"], &rows), "a\n\"\"\n\"\"");
    }
}
