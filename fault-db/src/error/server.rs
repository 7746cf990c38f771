//! Classifies errors of a server, by its messages, the network's errors and its certificate.

use std::error::Error as _;
use std::path::Path;

use postgres::error::{DbError, SqlState};
use rustls::CertificateError;

use super::StoreError;

/// Reason for which there is no connection with a server, and the remedy.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ServerReason {
    /// No program at that address.
    #[error("nothing listens there")]
    NothingListens,
    /// The server does not answer in time.
    #[error("no answer in time")]
    NoAnswer,
    /// The socket's file does not exist.
    #[error("there is no such socket")]
    NoSocket,
    /// The connection broke off.
    #[error("the connection is lost")]
    Lost,
    /// The server wants a password, and none was found.
    #[error("it wants a password")]
    NoPassword,
    /// The server offers no TLS, and the address demands TLS.
    #[error("it has no TLS; on a network you trust add sslmode=disable")]
    NoTls,
    /// The certificate's issuer is not trusted.
    #[error("nobody known here issued its certificate; name the issuer's with sslrootcert=FILE")]
    UnknownIssuer,
    /// The certificate names another host.
    #[error("its certificate is for another host; use the name that stands in it")]
    OtherHost,
    /// The certificate has expired.
    #[error("its certificate has expired; renew it, or set this computer's clock")]
    Expired,
    /// The certificate is not valid yet.
    #[error("its certificate is not valid yet; set this computer's clock")]
    NotYetValid,
    /// A message of the server or the system.
    #[error("{0}")]
    Said(String),
}

/// Classifies an error of a server by what a caller can do about it.
pub(crate) fn classify(path: &Path, doing: &'static str, source: postgres::Error) -> StoreError {
    let reason = match source.as_db_error() {
        Some(said) => by_code(said),
        None => by_cause(&source),
    };
    let path = path.to_path_buf();
    match reason {
        Some(Trouble::Busy(reason)) => StoreError::ServerBusy {
            path,
            doing,
            reason,
        },
        Some(Trouble::Refuses(reason)) => StoreError::ServerRefuses { path, reason },
        Some(Trouble::Unreachable(reason)) => StoreError::ServerUnreachable {
            path,
            doing,
            reason,
        },
        Some(Trouble::NotTrusted(reason)) => StoreError::ServerNotTrusted { path, reason },
        None => StoreError::Server {
            path,
            doing,
            source,
        },
    }
}

/// Kinds of trouble with a server that a caller tells apart.
enum Trouble {
    Busy(String),
    Refuses(ServerReason),
    Unreachable(ServerReason),
    NotTrusted(ServerReason),
}

/// The kind of trouble, by the code of a server's message.
fn by_code(said: &DbError) -> Option<Trouble> {
    let reason = said.message().to_owned();
    match *said.code() {
        SqlState::QUERY_CANCELED
        | SqlState::LOCK_NOT_AVAILABLE
        | SqlState::TOO_MANY_CONNECTIONS => Some(Trouble::Busy(reason)),
        SqlState::INSUFFICIENT_PRIVILEGE
        | SqlState::INVALID_PASSWORD
        | SqlState::INVALID_AUTHORIZATION_SPECIFICATION
        | SqlState::INVALID_CATALOG_NAME
        | SqlState::READ_ONLY_SQL_TRANSACTION
        | SqlState::DISK_FULL
        | SqlState::OUT_OF_MEMORY => Some(Trouble::Refuses(ServerReason::Said(reason))),
        SqlState::ADMIN_SHUTDOWN
        | SqlState::CRASH_SHUTDOWN
        | SqlState::CANNOT_CONNECT_NOW
        | SqlState::IDLE_IN_TRANSACTION_SESSION_TIMEOUT => {
            Some(Trouble::Unreachable(ServerReason::Said(reason)))
        }
        _ => None,
    }
}

/// The server's message.
pub(crate) fn message(error: &postgres::Error) -> String {
    match error.as_db_error() {
        Some(said) => said.message().to_owned(),
        None => error.to_string(),
    }
}

/// The kind of trouble of an error of the network or the client, without a message of the server.
fn by_cause(source: &postgres::Error) -> Option<Trouble> {
    if source.is_closed() {
        return Some(Trouble::Unreachable(ServerReason::Lost));
    }
    let cause = source.source()?;
    let Some(network) = cause.downcast_ref::<std::io::Error>() else {
        // The client's own errors have fixed texts: no TLS here, no password given.
        return match cause.to_string().as_str() {
            "server does not support TLS" => Some(Trouble::Refuses(ServerReason::NoTls)),
            "password missing" => Some(Trouble::Refuses(ServerReason::NoPassword)),
            _ => None,
        };
    };
    if let Some(error) = network.get_ref().and_then(|inner| inner.downcast_ref()) {
        return Some(Trouble::NotTrusted(distrust(error)));
    }
    Some(Trouble::Unreachable(match network.kind() {
        std::io::ErrorKind::ConnectionRefused => ServerReason::NothingListens,
        std::io::ErrorKind::TimedOut => ServerReason::NoAnswer,
        std::io::ErrorKind::NotFound => ServerReason::NoSocket,
        std::io::ErrorKind::UnexpectedEof
        | std::io::ErrorKind::ConnectionReset
        | std::io::ErrorKind::ConnectionAborted
        | std::io::ErrorKind::BrokenPipe => ServerReason::Lost,
        _ => ServerReason::Said(network.to_string()),
    }))
}

/// Reason for which a certificate was not trusted.
fn distrust(error: &rustls::Error) -> ServerReason {
    use CertificateError as C;
    match error {
        rustls::Error::InvalidCertificate(wrong) => match wrong {
            C::UnknownIssuer | C::BadSignature => ServerReason::UnknownIssuer,
            C::NotValidForName | C::NotValidForNameContext { .. } => ServerReason::OtherHost,
            C::Expired | C::ExpiredContext { .. } => ServerReason::Expired,
            C::NotValidYet | C::NotValidYetContext { .. } => ServerReason::NotYetValid,
            _ => ServerReason::Said(error.to_string()),
        },
        other => ServerReason::Said(other.to_string()),
    }
}
