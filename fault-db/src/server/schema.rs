//! Recognises the server's schema and its version, and migrates it.

use std::path::Path;

use crate::backend::{Backend, Server, SqlResult, values};
use crate::error::StoreError;
use crate::id::Id;

/// SQL of each schema version: the first creates everything; the table `meta` has the number of the version.
const STEPS: &[&str] = &[concat!(
    include_str!("tables.sql"),
    include_str!("rules.sql"),
    include_str!("views.sql"),
)];

/// Version of the schema that this crate reads and writes on a server.
pub const SERVER_SCHEMA_VERSION: i32 = STEPS.len() as i32;

/// The value in the table `meta` that marks a database as this program's.
const APPLICATION: &str = "ptu fault history";

const DOING: &str = "looking at the server's tables";

/// The state of a database.
enum Found {
    Nothing,
    Ours { schema: i32 },
    Others,
}

/// Refuses a database whose schema this crate cannot read.
pub(super) fn check(backend: &Backend, path: &Path) -> Result<(), StoreError> {
    let path = path.to_path_buf();
    match look(backend).map_err(|error| StoreError::from_sql(&path, DOING, error))? {
        Found::Nothing => Err(StoreError::ServerEmpty(path)),
        Found::Others => Err(StoreError::ServerForeign(path)),
        Found::Ours { schema } if schema < SERVER_SCHEMA_VERSION => {
            Err(StoreError::ServerOlderSchema {
                path,
                found: schema,
                known: SERVER_SCHEMA_VERSION,
            })
        }
        Found::Ours { schema } if schema > SERVER_SCHEMA_VERSION => {
            Err(StoreError::ServerNewerSchema {
                path,
                found: schema,
                known: SERVER_SCHEMA_VERSION,
            })
        }
        Found::Ours { .. } => Ok(()),
    }
}

/// Creates the tables of a new database, or migrates those of an earlier version; runs in the caller's
/// transaction, which excludes all other writers.
pub(super) fn bring_up_to_date(backend: &Backend, server: &Server, new_id: Id) -> SqlResult<()> {
    // Another program may have migrated the tables meanwhile.
    match look(backend)? {
        Found::Nothing => steps(server, 0)?,
        Found::Ours { schema } if schema < SERVER_SCHEMA_VERSION => {
            steps(server, usize::try_from(schema).unwrap_or_default())?;
        }
        Found::Ours { .. } | Found::Others => return Ok(()),
    }
    backend.execute(
        "INSERT INTO meta(key, value) VALUES ('application', ?1), ('server_id', ?2)
         ON CONFLICT DO NOTHING",
        &values![APPLICATION, new_id.to_string()],
    )?;
    Ok(())
}

fn steps(server: &Server, from: usize) -> SqlResult<()> {
    STEPS[from..]
        .iter()
        .try_for_each(|step| server.batch(step))?;
    server.batch(&format!(
        "INSERT INTO meta(key, value) VALUES ('schema', '{SERVER_SCHEMA_VERSION}')
         ON CONFLICT (key) DO UPDATE SET value = excluded.value"
    ))
}

/// The server's id, which is given once.
pub(crate) fn server_id(backend: &Backend) -> SqlResult<Option<Id>> {
    let text = backend.first(
        "SELECT value FROM meta WHERE key = 'server_id'",
        &[],
        |row| row.get::<String>(0),
    )?;
    Ok(text.and_then(|text| text.parse().ok()))
}

fn look(backend: &Backend) -> SqlResult<Found> {
    // Tables of extensions do not count.
    let tables: i64 = one(
        backend,
        "SELECT count(*) FROM pg_class c JOIN pg_namespace n ON n.oid = c.relnamespace
         WHERE n.nspname = current_schema() AND c.relkind IN ('r', 'p', 'v', 'm', 'f')
            AND NOT EXISTS (SELECT 1 FROM pg_depend d WHERE d.classid = 'pg_class'::regclass
                AND d.objid = c.oid AND d.deptype = 'e')",
    )?;
    if tables == 0 {
        return Ok(Found::Nothing);
    }
    let has_meta: i64 = one(
        backend,
        "SELECT count(*) FROM information_schema.columns
         WHERE table_schema = current_schema() AND table_name = 'meta'
            AND column_name IN ('key', 'value') AND data_type = 'text'",
    )?;
    if has_meta != 2 {
        return Ok(Found::Others);
    }
    let said = |key: &str| {
        let value = "SELECT value FROM meta WHERE key = ?1";
        backend.first(value, &values![key], |row| row.get::<String>(0))
    };
    let schema = said("schema")?.and_then(|text| text.parse().ok());
    Ok(match (said("application")?.as_deref(), schema) {
        (Some(APPLICATION), Some(schema)) => Found::Ours { schema },
        _ => Found::Others,
    })
}

fn one(backend: &Backend, sql: &str) -> SqlResult<i64> {
    let found = backend.first(sql, &[], |row| row.get(0))?;
    Ok(found.unwrap_or_default())
}
