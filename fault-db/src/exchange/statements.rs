//! Makes the SQL for replicated tables from the tables' declarations.

use super::columns::{Column, Kind};
use super::tables::Table;
use crate::exchange::domain::PACKED_BYTES;

impl Table {
    /// The columns of a change set: those that both sides have, and for a server the derived ones.
    pub fn sent(&self, for_server: bool) -> impl Iterator<Item = &'static Column> + use<> {
        let derived = if for_server { self.derived } else { &[] };
        self.columns.iter().chain(derived)
    }

    /// SQL that reads rows from a file by the value of the column `by`.
    pub fn read(&self, by: &str, for_server: bool) -> String {
        let joins = self.columns.iter().filter_map(|column| {
            let (parent, _) = column.kind.parent()?;
            let name = column.name;
            Some(format!(" JOIN {parent} ON {parent}.seq = t.{name}"))
        });
        format!(
            "SELECT {} FROM {} t{} WHERE t.{by} = ?1 ORDER BY t.{}",
            listed(self.sent(for_server).map(read_value)),
            self.name,
            joins.collect::<String>(),
            self.order
        )
    }

    /// SQL that reads the rows of a file that meet a condition, from a table without parents.
    pub fn read_where(&self, condition: &str) -> String {
        let values = listed(self.columns.iter().map(read_value));
        format!("SELECT {values} FROM {} t WHERE {condition}", self.name)
    }

    /// SQL that inserts one row into a file.
    pub fn insert_into_file(&self) -> String {
        let own = self.columns.iter().map(|column| {
            let value = format!("{{{}}}", column.name);
            match column.kind {
                Kind::Fault => format!(
                    "coalesce((SELECT seq FROM fault WHERE id = {value}),
                        (SELECT fault FROM fault_alias WHERE id = {value}))"
                ),
                kind => match kind.parent() {
                    Some((parent, key)) => {
                        format!("(SELECT seq FROM {parent} WHERE {key} = {value})")
                    }
                    None => value,
                },
            }
        });
        let (into, values) = self.pairs(own, self.file_more);
        self.numbered(&match self.file_unless {
            "" => format!("{into} VALUES ({values}) ON CONFLICT DO NOTHING"),
            unless => format!("{into} SELECT {values} WHERE NOT {unless} ON CONFLICT DO NOTHING"),
        })
    }

    /// Replaces each `{column}` by the number of the parameter with the row's value.
    pub fn numbered(&self, sql: &str) -> String {
        let columns = self.columns.iter().enumerate();
        columns.fold(sql.to_owned(), |sql, (place, column)| {
            sql.replace(&format!("{{{}}}", column.name), &format!("?{}", place + 1))
        })
    }

    /// SQL that inserts the rows `{rows}` into a server.
    pub fn insert_into_server(&self) -> String {
        let mut joins = String::new();
        let columns = self.columns.iter();
        let own = columns.map(|Column { name, kind, .. }| match kind.parent() {
            Some(("fault", _)) => {
                joins += " JOIN laptop_fault k ON k.laptop = {laptop} AND k.id = x.fault";
                "k.fault".to_owned()
            }
            Some((parent, key)) => {
                joins += &format!(" JOIN {parent} ON {parent}.{key} = x.{name}");
                format!("{parent}.seq")
            }
            None => format!("x.{name}"),
        });
        let (into, values) = self.pairs(own, self.server_more);
        let filter = match self.server_unless {
            "" => String::new(),
            unless => format!(" WHERE NOT {unless}"),
        };
        format!(
            "{into} SELECT {values} FROM {{rows}}{joins}{filter} ORDER BY x.sent_at ON CONFLICT DO NOTHING"
        )
    }

    /// The text `INSERT INTO table(columns)`, and the text of the values.
    fn pairs(&self, own: impl Iterator<Item = String>, more: &[(&str, &str)]) -> (String, String) {
        let names = self.columns.iter().map(|column| column.name);
        let names = listed(names.chain(more.iter().map(|(name, _)| *name)));
        let values = own.chain(more.iter().map(|(_, value)| (*value).to_owned()));
        let into = format!("INSERT INTO {}({names})", self.name);
        (into, listed(values))
    }

    /// Replaces `{rows}` by the arrays that are sent, and `{laptop}` by the number of the laptop.
    pub fn filled(&self, sql: &str, laptop: i64) -> String {
        let types = (1..).zip(self.sent(true));
        let arrays =
            types.map(|(place, column)| format!("${place}::{}[]", column.kind.server_type()));
        let names = self.sent(true).map(|column| column.name);
        let rows = format!(
            "unnest({}) WITH ORDINALITY AS x({}, sent_at)",
            listed(arrays),
            listed(names)
        );
        sql.replace("{rows}", &rows)
            .replace("{laptop}", &laptop.to_string())
    }
}

/// SQL: a column's value in a file. A text or blob that is too large is read as its length, a number, which the
/// column's type then refuses.
fn read_value(column: &Column) -> String {
    let name = column.name;
    match (column.kind.parent(), column.kind) {
        _ if !column.value.is_empty() => column.value.to_owned(),
        (Some((parent, key)), _) => format!("{parent}.{key}"),
        (None, Kind::Text | Kind::Bytes) => format!(
            "CASE WHEN octet_length(t.{name}) > {PACKED_BYTES} THEN octet_length(t.{name}) ELSE t.{name} END"
        ),
        (None, _) => format!("t.{name}"),
    }
}

fn listed(all: impl Iterator<Item = impl AsRef<str>>) -> String {
    let all: Vec<_> = all.map(|one| one.as_ref().to_owned()).collect();
    all.join(", ")
}
