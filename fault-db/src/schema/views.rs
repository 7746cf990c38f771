//! The documentation page of the views that SQL queries can use.

/// The text of `ptu db schema`: each view, each column, its meaning.
pub const VIEWS_PAGE: &str = include_str!("../../VIEWS.md");

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use rusqlite::Connection;

    use super::*;
    use crate::schema::{self, sql_functions};

    /// The columns the page tells of, by view.
    fn told() -> BTreeMap<String, Vec<String>> {
        let mut told: BTreeMap<String, Vec<String>> = BTreeMap::new();
        let mut view = String::new();
        for line in VIEWS_PAGE.lines() {
            if let Some((name, _)) = line
                .strip_prefix("## ")
                .and_then(|head| head.split_once(':'))
            {
                view = name.to_owned();
            } else if let Some((names, _)) =
                line.strip_prefix("| ").and_then(|row| row.split_once(" |"))
                && names != "column"
            {
                let names = names.split(", ").map(str::to_owned);
                told.entry(view.clone()).or_default().extend(names);
            }
        }
        told.values_mut().for_each(|columns| columns.sort());
        told
    }

    #[test]
    fn the_page_describes_every_column() {
        let conn = Connection::open_in_memory().expect("a database in memory");
        sql_functions::register(&conn).expect("functions");
        schema::bring_up_to_date(&conn).expect("the schema");
        let sql = "SELECT v.name, c.name FROM sqlite_schema v, pragma_table_info(v.name) c
            WHERE v.type = 'view' ORDER BY 1, 2";
        let mut select = conn.prepare(sql).expect("a question");
        let mut there: BTreeMap<String, Vec<String>> = BTreeMap::new();
        let mut rows = select.query([]).expect("asked");
        while let Some(row) = rows.next().expect("read") {
            there
                .entry(row.get(0).expect("a view"))
                .or_default()
                .push(row.get(1).expect("a column"));
        }
        assert_eq!(told(), there);
    }
}
