//! A server made ready by who looks after it: its tables, and who may do what with them.

use serde::Serialize;

use super::address::Address;
use super::connect::open;
use super::schema::{self, SERVER_SCHEMA_VERSION};
use crate::base::{Base, Server, SqlError, SqlResult, values};
use crate::error::StoreError;
use crate::id::IdSource;
use crate::settle::SETTLE;
use crate::store::Store;

const DOING: &str = "setting up the server";

/// What belongs to whom, and who may do what.
const GRANTS: &str = include_str!("grants.sql");

/// A server that is ready for laptops.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ServerSetup {
    /// Its address, without a password.
    pub server: String,
    /// The database.
    pub database: String,
    /// The account that owns the tables: it alone may change or remove them.
    pub owner: String,
    /// The account of the laptops: it adds rows and reads.
    pub laptops: String,
    /// Whether that account was made just now; it has no password yet.
    pub made_account: bool,
    /// The tables' version before; none if there were none.
    pub schema_before: Option<i32>,
    /// Their version now.
    pub schema: i32,
}

/// What a step of it comes to: the reason if it is refused.
type Step<T> = SqlResult<Result<T, String>>;

impl Store {
    /// Makes the tables of a server, or brings those of an earlier version up to date, and lets the account of
    /// the laptops add rows and read, and nothing else. All of it or nothing; done again it changes nothing.
    ///
    /// # Errors
    /// The account that asks may not do so, or that of the laptops is the same or may do more.
    pub fn set_up_server(
        address: &Address,
        mut ids: IdSource,
        laptops: &str,
    ) -> Result<ServerSetup, StoreError> {
        let (base, path) = open(address)?;
        let Base::Server(server) = &base else {
            return Err(StoreError::NotAServer { path });
        };
        let schema_before = match schema::check(&base, &path) {
            Ok(()) => Some(SERVER_SCHEMA_VERSION),
            Err(StoreError::ServerEmpty { .. }) => None,
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
        let done = match set_up(&base, server, &mut ids, laptops) {
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

/// All of it, in the caller's transaction.
fn set_up(base: &Base, server: &Server, ids: &mut IdSource, laptops: &str) -> Step<Done> {
    let who = "SELECT CAST(current_user AS text), CAST(current_database() AS text)";
    let found = base.first(who, &[], |row| Ok((row.get(0)?, row.get(1)?)))?;
    let (owner, database): (String, String) = found.unwrap_or_default();
    let made_account = match account(base, server, laptops, &owner)? {
        Ok(made) => made,
        Err(reason) => return Ok(Err(reason)),
    };
    // What is made now finds its tables here, whatever path who calls it has set.
    server.batch(
        "SELECT set_config('search_path', quote_ident(current_schema()) || ', pg_temp', true)",
    )?;
    schema::bring_up_to_date(base, server, ids.mint())?;
    server.batch(&functions())?;
    let named = "SELECT set_config('ptu.laptops', ?1, true)";
    base.execute(named, &values![laptops])?;
    server.batch(GRANTS)?;
    if let Some(reason) = too_much(base, laptops)? {
        return Ok(Err(reason));
    }
    Ok(Ok(Done {
        owner,
        database,
        made_account,
    }))
}

/// What keeps what follows from rows.
fn functions() -> String {
    include_str!("functions.sql").replace("{settle}", SETTLE)
}

/// Sees to the laptops' account; whether it had to be made.
fn account(base: &Base, server: &Server, laptops: &str, owner: &str) -> Step<bool> {
    if laptops == owner {
        return Ok(Err(format!(
            "{owner} makes the tables and may remove them; laptops need an account of their own, named with \
             --laptops"
        )));
    }
    let sql = "SELECT rolsuper OR pg_has_role(rolname, current_user, 'MEMBER') FROM pg_roles WHERE rolname = ?1";
    let may_more = base.first(sql, &values![laptops], |row| row.get::<i64>(0))?;
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
    if base.first(sql, &[], |row| row.get::<i64>(0))? != Some(1) {
        return Ok(Err(format!(
            "there is no account {laptops}, and {owner} may not make one; make it on the server with \
             `createuser --pwprompt {laptops}`"
        )));
    }
    base.execute(
        "SELECT set_config('ptu.laptops', ?1, true)",
        &values![laptops],
    )?;
    // Another program may be first.
    server.batch(
        "DO $$ BEGIN
           EXECUTE format('CREATE ROLE %I LOGIN', current_setting('ptu.laptops'));
         EXCEPTION WHEN duplicate_object OR unique_violation THEN NULL;
         END $$",
    )?;
    Ok(Ok(true))
}

/// What the laptops' account may do beyond adding rows, in words: who gave it that has to take it back.
fn too_much(base: &Base, laptops: &str) -> SqlResult<Option<String>> {
    let found = base.first(
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
