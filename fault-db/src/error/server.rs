//! Classifies errors of a server: its own messages, the network, certificates.

use std::error::Error as _;
use std::path::Path;

use postgres::error::SqlState;
use rustls::CertificateError;

use super::StoreError;

/// The error if the server has no TLS and the address demands it.
pub(crate) const NO_TLS: &str = "server does not support TLS";

/// Classifies an error of a server by what a caller can do about it.
pub(crate) fn classify(path: &Path, doing: &'static str, source: postgres::Error) -> StoreError {
    let path = path.to_path_buf();
    let Some(said) = source.as_db_error() else {
        return without_message(path, doing, source);
    };
    let reason = said.message().to_owned();
    match *said.code() {
        SqlState::QUERY_CANCELED
        | SqlState::LOCK_NOT_AVAILABLE
        | SqlState::TOO_MANY_CONNECTIONS => StoreError::ServerBusy {
            path,
            doing,
            reason,
        },
        SqlState::INSUFFICIENT_PRIVILEGE
        | SqlState::INVALID_PASSWORD
        | SqlState::INVALID_AUTHORIZATION_SPECIFICATION
        | SqlState::INVALID_CATALOG_NAME
        | SqlState::READ_ONLY_SQL_TRANSACTION => StoreError::ServerRefuses { path, reason },
        SqlState::DISK_FULL | SqlState::OUT_OF_MEMORY => StoreError::ServerRefuses { path, reason },
        SqlState::ADMIN_SHUTDOWN
        | SqlState::CRASH_SHUTDOWN
        | SqlState::CANNOT_CONNECT_NOW
        | SqlState::IDLE_IN_TRANSACTION_SESSION_TIMEOUT => StoreError::ServerUnreachable {
            path,
            doing,
            reason,
        },
        _ => StoreError::Server {
            path,
            doing,
            source,
        },
    }
}

/// The server's message.
pub(crate) fn message(error: &postgres::Error) -> String {
    match error.as_db_error() {
        Some(said) => said.message().to_owned(),
        None => error.to_string(),
    }
}

/// Errors without a message of the server: of the network, or of the client.
fn without_message(
    path: std::path::PathBuf,
    doing: &'static str,
    source: postgres::Error,
) -> StoreError {
    if source.is_closed() {
        let reason = "the connection is lost".to_owned();
        return StoreError::ServerUnreachable {
            path,
            doing,
            reason,
        };
    }
    let Some(cause) = source.source() else {
        return StoreError::Server {
            path,
            doing,
            source,
        };
    };
    let Some(network) = cause.downcast_ref::<std::io::Error>() else {
        // The client's own errors have fixed texts: no TLS here, no password given.
        let reason = cause.to_string();
        return match reason.as_str() {
            NO_TLS => StoreError::ServerRefuses {
                path,
                reason: "it has no TLS; on a network you trust add sslmode=disable".to_owned(),
            },
            "password missing" => StoreError::ServerRefuses {
                path,
                reason: "it wants a password".to_owned(),
            },
            _ => StoreError::Server {
                path,
                doing,
                source,
            },
        };
    };
    if let Some(error) = network.get_ref().and_then(|inner| inner.downcast_ref()) {
        let reason = distrust(error);
        return StoreError::ServerNotTrusted { path, reason };
    }
    let reason = match network.kind() {
        std::io::ErrorKind::ConnectionRefused => "nothing listens there".to_owned(),
        std::io::ErrorKind::TimedOut => "no answer in time".to_owned(),
        std::io::ErrorKind::NotFound => "there is no such socket".to_owned(),
        std::io::ErrorKind::UnexpectedEof
        | std::io::ErrorKind::ConnectionReset
        | std::io::ErrorKind::ConnectionAborted
        | std::io::ErrorKind::BrokenPipe => "the connection is lost".to_owned(),
        _ => network.to_string(),
    };
    StoreError::ServerUnreachable {
        path,
        doing,
        reason,
    }
}

/// Why a certificate was not trusted, and what to do about it.
fn distrust(error: &rustls::Error) -> String {
    use rustls::Error::InvalidCertificate;
    match error {
        InvalidCertificate(CertificateError::UnknownIssuer | CertificateError::BadSignature) => {
            "nobody known here issued its certificate; name the issuer's with sslrootcert=FILE"
                .to_owned()
        }
        InvalidCertificate(
            CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. },
        ) => "its certificate is for another host; use the name that stands in it".to_owned(),
        InvalidCertificate(CertificateError::Expired | CertificateError::ExpiredContext { .. }) => {
            "its certificate has expired; renew it, or set this computer's clock".to_owned()
        }
        InvalidCertificate(
            CertificateError::NotValidYet | CertificateError::NotValidYetContext { .. },
        ) => "its certificate is not valid yet; set this computer's clock".to_owned(),
        other => other.to_string(),
    }
}
