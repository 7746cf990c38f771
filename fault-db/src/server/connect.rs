//! Connects to a PostgreSQL server.

use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::time::Duration;

use postgres::config::SslMode;
use postgres::{Client, Config};

use super::address::{Address, Guard};
use super::password::{self, Password};
use super::{schema, tls};
use crate::backend::{Backend, Server};
use crate::error::{ServerReason, StoreError};
use crate::files::platform;
use crate::id::IdSource;
use crate::store::Store;

const DOING: &str = "connecting";

/// Time after which unacknowledged data counts as lost.
const NETWORK_PATIENCE: Duration = Duration::from_secs(30);

/// Session settings: if a laptop's cable is pulled, the writers' lock is released soon rather than after two hours;
/// queries are not JIT-compiled, which takes longer than to run them.
const MANNERS: &str = "
    SET statement_timeout = '300s';
    SET lock_timeout = '60s';
    SET idle_in_transaction_session_timeout = '60s';
    SET tcp_keepalives_idle = 20;
    SET tcp_keepalives_interval = 10;
    SET tcp_keepalives_count = 3;
    SET tcp_user_timeout = '60s';
    SET standard_conforming_strings = on;
    SET jit = off";

impl Store {
    /// Connects to a server for queries, for a sync, and for changes of faults and notes by users. Its tables
    /// are created by [`Store::set_up_server`] only.
    pub fn connect(address: &Address, ids: IdSource) -> Result<Self, StoreError> {
        let (backend, path) = open(address)?;
        schema::check(&backend, &path)?;
        Self::of(backend, &path, Some(ids))
    }

    /// Connects to a server for reading only.
    pub fn connect_read_only(address: &Address) -> Result<Self, StoreError> {
        let (backend, path) = open(address)?;
        schema::check(&backend, &path)?;
        let guarded = backend.execute("SET default_transaction_read_only = on", &[]);
        guarded.map_err(|error| StoreError::from_sql(&path, DOING, error))?;
        Self::of(backend, &path, None)
    }
}

pub(super) fn open(address: &Address) -> Result<(Backend, PathBuf), StoreError> {
    let path = PathBuf::from(address.to_string());
    let environment = |name: &str| std::env::var_os(name);
    let user = address.user.clone().or_else(|| {
        let named = environment("PGUSER").or_else(|| environment(platform::LOGGED_IN));
        named.and_then(|name| name.into_string().ok())
    });
    let user = user.ok_or_else(|| {
        StoreError::BadAddress(
            "it names no user, and nobody is logged in; write postgres://USER@…".to_owned(),
        )
    })?;
    let database = address.database.clone().unwrap_or_else(|| user.clone());
    let password = password::find(address, &user, &database, &environment);
    let mut config = config(address, &user, &database);
    if let Some(secret) = &password.secret {
        config.password(secret);
    }
    let (client, encoding) = reach(config, address, &path, password)?;
    // Text of any language has to be stored unchanged.
    if encoding != "UTF8" {
        return Err(StoreError::ServerRefuses {
            path,
            reason: ServerReason::Said(format!(
                "its text is {encoding}; make the database with `createdb -E UTF8 -T template0`"
            )),
        });
    }
    Ok((Backend::Server(Server::new(client)), path))
}

fn config(address: &Address, user: &str, database: &str) -> Config {
    let mut config = Config::new();
    config
        .user(user)
        .dbname(database)
        // A host that is a folder means the socket in it.
        .host(&address.host)
        .port(address.port)
        // Whoever may put a socket into that folder is trusted.
        .ssl_mode(match address.guard() {
            Guard::Disable => SslMode::Disable,
            Guard::Prefer => SslMode::Prefer,
            Guard::Verify => SslMode::Require,
        })
        .application_name("ptu")
        .connect_timeout(address.connect_timeout)
        .tcp_user_timeout(NETWORK_PATIENCE)
        .keepalives_idle(Duration::from_secs(20))
        .keepalives_interval(Duration::from_secs(10))
        .keepalives_retries(3);
    config
}

/// Connects on a separate thread, because resolving a name, or a server that accepts a connection and then falls
/// silent, blocks longer than the time limit. Returns the encoding of the server's texts, too.
fn reach(
    config: Config,
    address: &Address,
    path: &Path,
    password: Password,
) -> Result<(Client, String), StoreError> {
    let not_trusted = |reason| StoreError::ServerNotTrusted {
        path: path.to_path_buf(),
        reason: ServerReason::Said(reason),
    };
    let tls = tls::connector(address).map_err(not_trusted)?;
    let (done, waiting) = mpsc::channel();
    let connecting = std::thread::Builder::new()
        .name("connecting".into())
        .spawn(move || {
            let connected = config.connect(tls).and_then(|mut client| {
                client.batch_execute(MANNERS)?;
                let encoding = client.query_one("SHOW server_encoding", &[])?;
                Ok((client, encoding.try_get(0)?))
            });
            // Nobody receives a connection that took too long.
            let _ = done.send(connected);
        });
    let away = |reason| StoreError::ServerUnreachable {
        path: path.to_path_buf(),
        doing: DOING,
        reason,
    };
    connecting.map_err(|error| away(ServerReason::Said(error.to_string())))?;
    let connected = waiting
        .recv_timeout(address.connect_timeout)
        .map_err(|_| away(ServerReason::NoAnswer))?;
    connected.map_err(
        |error| match StoreError::from_sql(path, DOING, error.into()) {
            StoreError::ServerRefuses { path, reason } => StoreError::ServerRefuses {
                path,
                reason: match &password.passed_over {
                    Some(why) => ServerReason::Said(format!("{reason}; {why}")),
                    None => reason,
                },
            },
            // Any other error means that there is no connection.
            StoreError::Server { source, .. } => away(ServerReason::Said(source.to_string())),
            other => other,
        },
    )
}
