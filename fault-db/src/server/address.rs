//! The address of a server: `postgres://user@host:port/database?option=value`, in libpq's syntax.

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use crate::error::StoreError;

const DEFAULT_PORT: u16 = 5432;
const DEFAULT_CONNECT_TIMEOUT_S: u64 = 10;
const OPTIONS: &str =
    "host, port, dbname, user, password, passfile, sslmode, sslrootcert, connect_timeout";

/// Protection of a connection.
///
/// The names are libpq's, with two differences: without `sslmode` a server on another machine has to prove
/// its identity; and `require` and `verify-ca` verify issuer and host name like `verify-full`, because
/// encryption to an unknown peer protects nothing.
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
    pub(super) connect_timeout_s: u64,
    guard: Option<Guard>,
}

impl Address {
    /// A socket in a folder, or this machine.
    pub(super) fn is_local(&self) -> bool {
        let host = self.host.as_str();
        let loopback = host
            .parse::<std::net::IpAddr>()
            .is_ok_and(|ip| ip.is_loopback());
        self.is_socket() || loopback || host == "localhost"
    }

    /// A folder that holds a socket.
    pub(super) fn is_socket(&self) -> bool {
        self.host.starts_with('/')
    }

    /// Whether the address holds a password, which is nowhere to be shown or kept.
    pub fn has_password(&self) -> bool {
        self.password.is_some()
    }

    /// The user that the address names.
    pub fn user(&self) -> Option<&str> {
        self.user.as_deref()
    }

    /// The protection that applies, with its default.
    pub(super) fn guard(&self) -> Guard {
        match self.guard {
            _ if self.is_socket() => Guard::Disable,
            Some(guard) => guard,
            None if self.is_local() && self.root_certificates.is_none() => Guard::Prefer,
            None => Guard::Verify,
        }
    }

    fn set(&mut self, name: &str, value: String) -> Result<(), String> {
        match name {
            "host" => self.host = value,
            "port" => self.port = port(&value)?,
            "dbname" => self.database = Some(value),
            "user" => self.user = Some(value),
            "password" => self.password = Some(value),
            "passfile" => self.password_file = Some(value.into()),
            // libpq's name for the system's certificates.
            "sslrootcert" if value == "system" => self.root_certificates = None,
            "sslrootcert" => self.root_certificates = Some(value.into()),
            "sslmode" => self.guard = Some(guard(&value)?),
            "connect_timeout" => {
                let seconds = value
                    .parse()
                    .ok()
                    .filter(|seconds| (1..=600).contains(seconds));
                self.connect_timeout_s =
                    seconds.ok_or("connect_timeout is a number of seconds from 1 to 600")?;
            }
            _ => {
                return Err(format!(
                    "it has an option that is not known; there are {OPTIONS}"
                ));
            }
        }
        Ok(())
    }
}

impl FromStr for Address {
    type Err = StoreError;

    fn from_str(text: &str) -> Result<Self, StoreError> {
        parse(text).map_err(|reason| StoreError::BadAddress { reason })
    }
}

/// The error quotes nothing of the text: any part may belong to a misspelt password.
fn parse(text: &str) -> Result<Address, String> {
    let rest = text
        .strip_prefix("postgres://")
        .or_else(|| text.strip_prefix("postgresql://"))
        .ok_or("it begins with neither postgres:// nor postgresql://")?;
    let (rest, options) = rest.split_once('?').unwrap_or((rest, ""));
    let (place, database) = rest.split_once('/').unwrap_or((rest, ""));
    let (login, place) = match place.rsplit_once('@') {
        Some((login, place)) => (Some(login), place),
        None => (None, place),
    };
    if place.contains(',') {
        return Err("it names several hosts; name one".to_owned());
    }
    let (host, number) = split_host(place)?;
    let mut address = Address {
        user: None,
        password: None,
        host: plain(host)?,
        port: number.map_or(Ok(DEFAULT_PORT), port)?,
        database: Some(plain(database)?).filter(|name| !name.is_empty()),
        password_file: None,
        root_certificates: None,
        connect_timeout_s: DEFAULT_CONNECT_TIMEOUT_S,
        guard: None,
    };
    if let Some(login) = login {
        let (user, password) = match login.split_once(':') {
            Some((user, password)) => (user, Some(plain(password)?)),
            None => (login, None),
        };
        address.user = Some(plain(user)?).filter(|user| !user.is_empty());
        address.password = password;
    }
    for option in options.split('&').filter(|option| !option.is_empty()) {
        let (name, value) = option
            .split_once('=')
            .ok_or("one of its options has no value")?;
        address.set(&plain(name)?, plain(value)?)?;
    }
    if address
        .database
        .as_deref()
        .is_some_and(|name| name.contains('@'))
    {
        return Err(
            "a / or @ of its password has to be written as %2F or %40; better, the password belongs into \
             ~/.pgpass"
                .to_owned(),
        );
    }
    if address.host.is_empty() {
        address.host = "localhost".to_owned();
    }
    Ok(address)
}

/// Host and port; an IPv6 address stands in brackets.
fn split_host(place: &str) -> Result<(&str, Option<&str>), String> {
    if let Some(rest) = place.strip_prefix('[') {
        let (host, after) = rest.split_once(']').ok_or("its [ has no ]")?;
        return match after.strip_prefix(':') {
            Some(port) => Ok((host, Some(port))),
            None if after.is_empty() => Ok((host, None)),
            None => Err("after ] comes : and a port".to_owned()),
        };
    }
    Ok(match place.split_once(':') {
        Some((host, port)) => (host, Some(port).filter(|port| !port.is_empty())),
        None => (place, None),
    })
}

fn port(text: &str) -> Result<u16, String> {
    let port = text.parse().ok().filter(|port| *port > 0);
    port.ok_or_else(|| "its port is no number from 1 to 65535".to_owned())
}

fn guard(word: &str) -> Result<Guard, String> {
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

/// Decodes percent escapes.
fn plain(text: &str) -> Result<String, String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        rest = after;
        if *first != b'%' {
            bytes.push(*first);
            continue;
        }
        let digits = after.get(..2).and_then(|two| std::str::from_utf8(two).ok());
        let byte = digits.and_then(|two| u8::from_str_radix(two, 16).ok());
        // The error does not quote the text: it may be a password.
        bytes.push(byte.ok_or("after % come two hex digits; a % itself is written %25")?);
        rest = &after[2..];
    }
    match String::from_utf8(bytes) {
        Ok(text) if !text.contains('\0') => Ok(text),
        _ => Err("its % digits make no text".to_owned()),
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("postgres://")?;
        if let Some(user) = &self.user {
            write!(f, "{user}@")?;
        }
        match self.host.as_str() {
            // A slash would end the host.
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
            ("postgres://a:99999/d", "1 to 65535"),
            // Passwords whose / and ? were not escaped.
            ("postgres://kim:pa/ss@a/d", "1 to 65535"),
            ("postgres://kim:77/pass@a/d", "%2F or %40"),
            ("postgres://kim:77?pass@a/d", "has no value"),
            ("postgres://kim:77?pass=1@a/d", "option that is not known"),
            ("postgres://kim:pa%zz@a/d", "two hex digits"),
            ("postgres://a/d?sslmode=yes", "disable, prefer"),
            ("postgres://a/d?colour=red", "not known; there are"),
            ("postgres://a/d?sslmode", "no value"),
            ("postgres://[::1/d", "no ]"),
            ("postgres://a/d?connect_timeout=0", "1 to 600"),
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
