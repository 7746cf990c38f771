//! Sets a server up, by an administrator: creates the tables and grants the rights.

use serde::Serialize;

use super::address::Address;
use super::connect::open;
use super::schema::{self, SERVER_SCHEMA_VERSION};
use crate::backend::{Backend, Server, SqlError, SqlResult, values};
use crate::error::StoreError;
use crate::history::event_graph::MOVE_ROWS;
use crate::history::graph_sql::RECOMPUTE_FAULT;
use crate::id::IdSource;
use crate::store::Store;

const DOING: &str = "setting up the server";

/// Ownership and rights.
const GRANTS: &str = include_str!("grants.sql");

/// A server that is ready for laptops.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ServerSetup {
    /// Address of the server, without a password.
    pub server: String,
    /// Name of the database.
    pub database: String,
    /// The account that owns the tables; it alone may change or drop them.
    pub owner: String,
    /// The laptops' account; it may insert and select.
    pub laptops: String,
    /// Whether the laptops' account was created now; it has no password yet.
    pub made_account: bool,
    /// The schema version before; `None` if there were no tables.
    pub schema_before: Option<i32>,
    /// The schema version now.
    pub schema: i32,
}

/// Result of a step of the set-up, or the reason why it was refused.
type Step<T> = SqlResult<Result<T, String>>;

impl Store {
    /// Creates the tables of a server, or migrates those of an earlier version, and grants the laptops' account the
    /// right to insert and select, nothing else. One transaction; may be repeated.
    ///
    /// # Errors
    /// The connecting account lacks the right, or the laptops' account is the same or has more rights.
    pub fn set_up_server(
        address: &Address,
        mut ids: IdSource,
        laptops: &str,
    ) -> Result<ServerSetup, StoreError> {
        let (backend, path) = open(address)?;
        let Backend::Server(server) = &backend else {
            return Err(StoreError::NotAServer(path));
        };
        let schema_before = match schema::check(&backend, &path) {
            Ok(()) => Some(SERVER_SCHEMA_VERSION),
            Err(StoreError::ServerEmpty(_)) => None,
            Err(StoreError::ServerOlderSchema { found, .. }) => Some(found),
            Err(other) => return Err(other),
        };
        let refused = |reason: String| StoreError::ServerSetup {
            path: path.clone(),
            reason,
        };
        let failed = |error: SqlError| match StoreError::from_sql(&path, DOING, error) {
            StoreError::ServerRefuses { reason, .. } => refused(format!(
                "{reason}; ask as the account that owns the database and its tables, or as a superuser"
            )),
            other => other,
        };
        server.begin().map_err(failed)?;
        let done = match set_up(&backend, server, &mut ids, laptops) {
            Ok(Ok(done)) => server.batch("COMMIT").map(|()| done).map_err(failed),
            Ok(Err(reason)) => Err(refused(reason)),
            Err(error) => Err(failed(error)),
        };
        let Done {
            owner,
            database,
            made_account,
        } = done.inspect_err(|_| {
            // The error says more than a failed rollback would.
            let _ = server.batch("ROLLBACK");
        })?;
        Ok(ServerSetup {
            server: path.display().to_string(),
            database,
            owner,
            laptops: laptops.to_owned(),
            made_account,
            schema_before,
            schema: SERVER_SCHEMA_VERSION,
        })
    }
}

struct Done {
    owner: String,
    database: String,
    made_account: bool,
}

/// All steps, in the caller's transaction.
fn set_up(backend: &Backend, server: &Server, ids: &mut IdSource, laptops: &str) -> Step<Done> {
    let who = "SELECT CAST(current_user AS text), CAST(current_database() AS text)";
    let found = backend.first(who, &[], |row| Ok((row.get(0)?, row.get(1)?)))?;
    let (owner, database): (String, String) = found.unwrap_or_default();
    let made_account = match account(backend, server, laptops, &owner)? {
        Ok(made) => made,
        Err(reason) => return Ok(Err(reason)),
    };
    // Functions find these tables whatever search path their caller has set.
    server.batch(
        "SELECT set_config('search_path', quote_ident(current_schema()) || ', pg_temp', true)",
    )?;
    schema::bring_up_to_date(backend, server, ids.mint())?;
    server.batch(&functions())?;
    let named = "SELECT set_config('ptu.laptops', ?1, true)";
    backend.execute(named, &values![laptops])?;
    server.batch(GRANTS)?;
    if let Some(reason) = too_much(backend, laptops)? {
        return Ok(Err(reason));
    }
    Ok(Ok(Done {
        owner,
        database,
        made_account,
    }))
}

/// The functions that maintain derived columns.
fn functions() -> String {
    let moved = MOVE_ROWS.join(";\n    ");
    let moved = moved.replace("?1", "stays").replace("?2", "goes");
    // The part that an event names is a column here: laptops send it beside the event's body.
    let settle = RECOMPUTE_FAULT.replace("part_of(e.body)", "e.part");
    (include_str!("functions.sql").replace("{settle}", &settle)).replace("{move}", &moved)
}

/// Creates the laptops' account if need be; returns whether it was created.
fn account(backend: &Backend, server: &Server, laptops: &str, owner: &str) -> Step<bool> {
    if laptops == owner {
        return Ok(Err(format!(
            "{owner} makes the tables and may remove them; laptops need an account of their own, named with \
             --laptops"
        )));
    }
    let sql = "SELECT rolsuper OR pg_has_role(rolname, current_user, 'MEMBER') FROM pg_roles WHERE rolname = ?1";
    let may_more = backend.first(sql, &values![laptops], |row| row.get::<i64>(0))?;
    match may_more {
        Some(0) => return Ok(Ok(false)),
        Some(_) => {
            return Ok(Err(format!(
                "the account {laptops} is a superuser or may act as {owner}; name another with --laptops"
            )));
        }
        None => {}
    }
    let sql = "SELECT rolsuper OR rolcreaterole FROM pg_roles WHERE rolname = current_user";
    if backend.first(sql, &[], |row| row.get::<i64>(0))? != Some(1) {
        return Ok(Err(format!(
            "there is no account {laptops}, and {owner} may not make one; make it on the server with \
             `createuser --pwprompt {laptops}`"
        )));
    }
    backend.execute(
        "SELECT set_config('ptu.laptops', ?1, true)",
        &values![laptops],
    )?;
    // Another program may create the account at the same moment.
    server.batch(
        "DO $$ BEGIN
           EXECUTE format('CREATE ROLE %I LOGIN', current_setting('ptu.laptops'));
         EXCEPTION WHEN duplicate_object OR unique_violation THEN NULL;
         END $$",
    )?;
    Ok(Ok(true))
}

/// The rights of the laptops' account beyond inserting and selecting; the grantor has to revoke them.
fn too_much(backend: &Backend, laptops: &str) -> SqlResult<Option<String>> {
    let found = backend.first(
        "SELECT has_schema_privilege(?1, current_schema(), 'CREATE'),
            has_database_privilege(?1, current_database(), 'CREATE, TEMPORARY')",
        &values![laptops],
        |row| Ok((row.get::<i64>(0)?, row.get::<i64>(1)?)),
    )?;
    Ok(found.filter(|may| *may != (0, 0)).map(|_| {
        format!(
            "the account {laptops} may make tables of its own; ask as a superuser, or let one say `REVOKE CREATE \
             ON SCHEMA public FROM PUBLIC` and `ALTER DATABASE … OWNER TO …`"
        )
    }))
}
