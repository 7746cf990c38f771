//! The address of a server: `postgres://user@host:port/database?option=value`, in libpq's syntax.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use percent_encoding::percent_decode_str;
use postgres::Config;

use crate::error::StoreError;
use crate::files::platform;

const DEFAULT_PORT: u16 = 5432;
const DEFAULT_CONNECT_TIMEOUT: Duration = Duration::from_secs(10);
const OPTIONS: &str =
    "host, port, dbname, user, password, passfile, sslmode, sslrootcert, connect_timeout";

/// Protection of a connection.
///
/// The options' names are libpq's, with two differences: without `sslmode` a server on another computer has to prove
/// its identity; and `require` and `verify-ca` verify issuer and host name like `verify-full`, because encryption to an
/// unknown peer protects nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Guard {
    /// No TLS.
    Disable,
    /// TLS if the server offers it, without verification.
    Prefer,
    /// TLS, with a certificate for this host from a trusted issuer.
    Verify,
}

/// The address of a server. Always shown without its password.
#[derive(Clone, PartialEq, Eq)]
pub struct Address {
    pub(super) user: Option<String>,
    pub(super) password: Option<String>,
    pub(super) host: String,
    pub(super) port: u16,
    pub(super) database: Option<String>,
    pub(super) password_file: Option<PathBuf>,
    pub(super) root_certificates: Option<PathBuf>,
    pub(super) connect_timeout: Duration,
    guard: Option<Guard>,
}

impl Address {
    /// Whether the server is on this computer: a socket in a folder, or a local host name.
    pub(super) fn is_local(&self) -> bool {
        let host = self.host.as_str();
        let loopback = host
            .parse::<std::net::IpAddr>()
            .is_ok_and(|ip| ip.is_loopback());
        self.is_socket() || loopback || host == "localhost"
    }

    /// Whether the host is a folder, which holds a socket.
    pub(super) fn is_socket(&self) -> bool {
        self.host.starts_with('/')
    }

    /// Whether the address holds a password, which must never be shown or stored.
    pub fn has_password(&self) -> bool {
        self.password.is_some()
    }

    /// The user that the address names.
    pub fn user(&self) -> Option<&str> {
        self.user.as_deref()
    }

    /// The protection of the connection: as in the address, or else the default.
    pub(super) fn guard(&self) -> Guard {
        match self.guard {
            _ if self.is_socket() => Guard::Disable,
            Some(guard) => guard,
            None if self.is_local() && self.root_certificates.is_none() => Guard::Prefer,
            None => Guard::Verify,
        }
    }
}

impl FromStr for Address {
    type Err = StoreError;

    fn from_str(text: &str) -> Result<Self, StoreError> {
        parse(text).map_err(StoreError::BadAddress)
    }
}

/// Reads an address. The error quotes nothing of the text, any part of which may belong to a misspelt password. The
/// options for files and for protection are read here, the rest by the client.
fn parse(text: &str) -> Result<Address, String> {
    if !text.starts_with("postgres://") && !text.starts_with("postgresql://") {
        return Err("it begins with neither postgres:// nor postgresql://".to_owned());
    }
    let (place, options) = text.split_once('?').unwrap_or((text, ""));
    // The client takes the first @ for the end of the login, but it may belong to a password.
    let place = place.rsplit_once('@').map_or_else(
        || place.to_owned(),
        |(login, host)| format!("{}@{host}", login.replace('@', "%40")),
    );
    let (mut password_file, mut root_certificates, mut guard) = (None, None, None);
    let mut known = String::new();
    for option in options.split('&').filter(|option| !option.is_empty()) {
        let (name, value) = option
            .split_once('=')
            .ok_or("one of its options has no value")?;
        match name {
            "passfile" => password_file = Some(file(value)?),
            // libpq's name for the system's certificates.
            "sslrootcert" if value == "system" => root_certificates = None,
            "sslrootcert" => root_certificates = Some(file(value)?),
            "sslmode" => guard = Some(guard_of(value)?),
            "host" | "port" | "dbname" | "user" | "password" | "connect_timeout" => {
                known += &format!("{name}={}&", value.replace('@', "%40"));
            }
            _ => {
                return Err(format!(
                    "it has an option that is not known; there are {OPTIONS}"
                ));
            }
        }
    }
    let read = format!("{place}?{known}").parse::<Config>();
    let read = read.map_err(|_| "its host, port or time is not understood")?;
    let host = match read.get_hosts() {
        [] => String::new(),
        [host] => platform::host(host)?,
        _ => return Err("it names several hosts; name one".to_owned()),
    };
    let given = |text: Option<&str>| text.filter(|text| !text.is_empty()).map(str::to_owned);
    let password = read
        .get_password()
        .map(|bytes| String::from_utf8(bytes.to_vec()));
    let password = password.transpose();
    Ok(Address {
        user: given(read.get_user()),
        password: password.map_err(|_| "its password is no text")?,
        host: given(Some(&host)).unwrap_or_else(|| "localhost".to_owned()),
        port: read.get_ports().last().copied().unwrap_or(DEFAULT_PORT),
        database: given(read.get_dbname()),
        password_file,
        root_certificates,
        connect_timeout: read
            .get_connect_timeout()
            .copied()
            .unwrap_or(DEFAULT_CONNECT_TIMEOUT),
        guard,
    })
}

/// The file of an option.
fn file(value: &str) -> Result<PathBuf, &'static str> {
    let path = percent_decode_str(value).decode_utf8();
    path.map_or(Err("its % digits make no text"), |path| {
        Ok(PathBuf::from(&*path))
    })
}

fn guard_of(word: &str) -> Result<Guard, String> {
    match word {
        "disable" => Ok(Guard::Disable),
        "prefer" => Ok(Guard::Prefer),
        "require" | "verify-ca" | "verify-full" => Ok(Guard::Verify),
        _ => Err(
            "its sslmode is not known; it is disable, prefer, require, verify-ca or verify-full"
                .to_owned(),
        ),
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("postgres://")?;
        if let Some(user) = &self.user {
            write!(f, "{user}@")?;
        }
        match self.host.as_str() {
            // An unescaped slash would end the host.
            host if self.is_socket() => f.write_str(&host.replace('/', "%2F"))?,
            host if host.contains(':') => write!(f, "[{host}]")?,
            host => f.write_str(host)?,
        }
        if self.port != DEFAULT_PORT {
            write!(f, ":{}", self.port)?;
        }
        write!(f, "/{}", self.database.as_deref().unwrap_or_default())
    }
}

impl fmt::Debug for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Address({self})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(text: &str) -> Address {
        text.parse().expect(text)
    }

    #[test]
    fn an_address_is_shown_without_its_password() {
        let a =
            address("postgres://kim:s%40cret@depot.example:6543/history?sslrootcert=/etc/ca.pem");
        assert_eq!(a.password.as_deref(), Some("s@cret"));
        assert_eq!(a.root_certificates, Some(PathBuf::from("/etc/ca.pem")));
        let shown = format!("{a} {a:?}");
        assert!(
            shown.contains("postgres://kim@depot.example:6543/history"),
            "{shown}"
        );
        assert!(!shown.contains("cret"), "{shown}");
        assert_eq!(address("postgresql://[::1]/h").host, "::1");
        assert_eq!(address("postgres:///h").host, "localhost");
        let socket = address("postgres://%2Frun%2Fpostgresql/h");
        assert_eq!(socket.host, "/run/postgresql");
        assert_eq!(address(&socket.to_string()), socket);
        assert_eq!(address("postgres:///h?host=/run/postgresql"), socket);
        for text in [
            "postgres://kim:s3/cr@et@a/h",
            "postgres://kim@a/h?password=s3/cr@et",
        ] {
            let a = address(text);
            assert!(a.has_password(), "{text}");
            assert!(!a.to_string().contains("s3"), "{a}");
        }
    }

    #[test]
    fn a_server_on_another_machine_has_to_prove_its_identity() {
        for (text, guard) in [
            ("postgres://depot/h", Guard::Verify),
            ("postgres://depot/h?sslmode=require", Guard::Verify),
            ("postgres://depot/h?sslmode=prefer", Guard::Prefer),
            ("postgres://depot/h?sslmode=disable", Guard::Disable),
            ("postgres://localhost/h", Guard::Prefer),
            ("postgres://127.0.0.1/h", Guard::Prefer),
            ("postgres://localhost.example/h", Guard::Verify),
            ("postgres://127.0.0.1/h?sslrootcert=ca.pem", Guard::Verify),
            ("postgres://%2Ftmp/h?sslmode=require", Guard::Disable),
        ] {
            assert_eq!(address(text).guard(), guard, "{text}");
        }
    }

    #[test]
    fn address_errors_never_quote_the_password() {
        for (text, words) in [
            ("mysql://h/d", "neither postgres://"),
            ("postgres://a,b/d", "several hosts"),
            ("postgres://a:99999/d", "host, port or time"),
            // Passwords whose ? was not escaped.
            ("postgres://kim:77?pass@a/d", "has no value"),
            ("postgres://kim:77?pass=1@a/d", "option that is not known"),
            ("postgres://kim:77?port=pass@a/d", "not understood"),
            ("postgres://kim:pass%ff@a/d", "is no text"),
            ("postgres://a/d?sslmode=yes", "disable, prefer"),
            ("postgres://a/d?colour=red", "not known; there are"),
            ("postgres://a/d?sslmode", "no value"),
            ("postgres://[::1/d", "host, port or time"),
            ("postgres://a/d?connect_timeout=soon", "host, port or time"),
        ] {
            let said = text.parse::<Address>().expect_err(text).to_string();
            assert!(said.contains(words), "{text}: {said}");
            let plain = said
                .replace("password", "")
                .replace("passfile", "")
                .replace(".pgpass", "");
            assert!(!plain.contains("pa%") && !plain.contains("pass"), "{said}");
        }
    }
}
