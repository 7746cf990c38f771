//! Compares the tables, indexes, views and triggers of a file with those that this program creates. A
//! foreign trigger could change what is recorded, and a view in place of a table could return anything.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use rusqlite::config::DbConfig;
use rusqlite::{Connection, Result};

use crate::error::{Damage, SchemaObject};
use crate::schema::sql_functions;
use crate::schema::{self, SCHEMA_VERSION};

/// By type and name of a table, index, view or trigger: its table and its SQL.
type Objects = BTreeMap<(String, String), (String, String)>;

/// Restricts the SQL stored in a file to what this program's own SQL needs, and protects SQLite's shadow tables from
/// direct writes. A reader's connection fires no triggers.
pub(crate) fn harden(conn: &Connection, triggers: bool) -> Result<()> {
    conn.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true)?;
    conn.set_db_config(DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false)?;
    conn.set_db_config(DbConfig::SQLITE_DBCONFIG_ENABLE_TRIGGER, triggers)?;
    Ok(())
}

/// Descriptions of all objects of a file of this schema version that this program did not make or that were
/// altered; empty if there are none.
pub(crate) fn foreign_objects(conn: &Connection, version: i32) -> Result<Vec<Damage>> {
    let made = made(version)?;
    let found = objects(conn)?;
    let mut foreign_objects = Vec::new();
    for (object, (of, sql)) in &found {
        let (_, name) = object;
        let on = (of != name).then(|| of.clone());
        match made.get(object) {
            None => foreign_objects.push(Damage::Foreign(named(object, on))),
            Some((made_of, made_sql)) if made_of != of || made_sql != sql => {
                foreign_objects.push(Damage::Remade(named(object, on)));
            }
            Some(_) => {}
        }
    }
    let missing = made.keys().filter(|object| !found.contains_key(*object));
    foreign_objects.extend(missing.map(|object| Damage::NoObject(named(object, None))));
    Ok(foreign_objects)
}

fn named((kind, name): &(String, String), on: Option<String>) -> SchemaObject {
    SchemaObject {
        kind: kind.clone(),
        name: name.clone(),
        on,
    }
}

/// The objects of this schema version, as the program makes them.
fn made(version: i32) -> Result<&'static Objects> {
    static MADE: [OnceLock<Objects>; SCHEMA_VERSION as usize + 1] =
        [const { OnceLock::new() }; SCHEMA_VERSION as usize + 1];
    let place = usize::try_from(version)
        .unwrap_or_default()
        .min(MADE.len() - 1);
    if let Some(known) = MADE[place].get() {
        return Ok(known);
    }
    let conn = Connection::open_in_memory()?;
    sql_functions::register(&conn)?;
    schema::create(&conn, version)?;
    let found = objects(&conn)?;
    Ok(MADE[place].get_or_init(|| found))
}

fn objects(conn: &Connection) -> Result<Objects> {
    let mut select =
        conn.prepare("SELECT type, name, tbl_name, coalesce(sql, '') FROM sqlite_schema")?;
    let mut rows = select.query([])?;
    let mut objects = Objects::new();
    while let Some(row) = rows.next()? {
        let (kind, name, of): (String, String, String) = (row.get(0)?, row.get(1)?, row.get(2)?);
        // Statistics left by `ANALYZE` are harmless.
        if name.starts_with("sqlite_stat") {
            continue;
        }
        let sql = match is_of_search(&name) {
            true => String::new(),
            false => plain(&row.get::<_, String>(3)?),
        };
        objects.insert((kind, name), (of, sql));
    }
    Ok(objects)
}

/// Whether a table is one of SQLite's own shadow tables of a full-text index.
fn is_of_search(name: &str) -> bool {
    ["event_words_", "note_words_"]
        .iter()
        .any(|of| name.starts_with(of))
}

/// SQL without comments and with single blanks, for comparison.
fn plain(sql: &str) -> String {
    let mut plain = String::with_capacity(sql.len());
    let mut letters = sql.chars().peekable();
    let mut quoted = None;
    while let Some(letter) = letters.next() {
        match (quoted, letter) {
            (Some(quote), _) => {
                plain.push(letter);
                if letter == quote {
                    quoted = None;
                }
            }
            (None, '-') if letters.peek() == Some(&'-') => {
                letters.by_ref().find(|letter| *letter == '\n');
                blank(&mut plain);
            }
            (None, '/') if letters.peek() == Some(&'*') => {
                let mut last = ' ';
                letters.next();
                letters
                    .by_ref()
                    .find(|letter| std::mem::replace(&mut last, *letter) == '*' && *letter == '/');
                blank(&mut plain);
            }
            (None, letter) if letter.is_whitespace() => blank(&mut plain),
            (None, letter) => {
                if matches!(letter, '\'' | '"' | '`') {
                    quoted = Some(letter);
                }
                plain.push(letter);
            }
        }
    }
    plain.trim_end().to_owned()
}

fn blank(plain: &mut String) {
    if !plain.ends_with(' ') {
        plain.push(' ');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layout_and_comments_are_no_difference_and_quoted_text_is() {
        let laid_out = "CREATE TABLE a( -- of all\n  b TEXT /* c */,\n d INTEGER)";
        assert_eq!(plain(laid_out), "CREATE TABLE a( b TEXT , d INTEGER)");
        assert_eq!(plain("SELECT '--  x'"), "SELECT '--  x'");
        assert_ne!(plain("SELECT ' x'"), plain("SELECT '  x'"));
    }

    #[test]
    fn a_file_of_each_version_has_no_foreign_objects() {
        for version in 1..=SCHEMA_VERSION {
            let conn = Connection::open_in_memory().expect("a database in memory");
            sql_functions::register(&conn).expect("functions");
            schema::create(&conn, version).expect("made");
            conn.execute_batch("ANALYZE").expect("statistics");
            assert_eq!(foreign_objects(&conn, version).expect("compared"), []);
            let planted = "CREATE TRIGGER x AFTER UPDATE ON run BEGIN SELECT 1; END;
                CREATE TABLE mine(a); CREATE INDEX y ON run(source); DROP INDEX run_by_start";
            conn.execute_batch(planted).expect("planted");
            let found = foreign_objects(&conn, version).expect("compared");
            let found: Vec<_> = found.iter().map(Damage::to_string).collect();
            assert_eq!(
                found,
                [
                    "the index \"y\" on run is not of this program",
                    "the table \"mine\" is not of this program",
                    "the trigger \"x\" on run is not of this program",
                    "the index \"run_by_start\" is missing",
                ]
            );
        }
    }
}
