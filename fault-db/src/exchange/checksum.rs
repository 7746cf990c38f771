//! Content that its row names by SHA-256: channel sets and traces.

use sha2::{Digest as _, Sha256};

use crate::backend::Value;

/// The reason why content is refused that is not what was stored.
pub(super) const DAMAGED: &str = "it does not match its checksum";

/// Compares content with the digest of its row; a value of another type is left to the column's domain.
pub(super) fn checksum(sha256: &Value<'_>, content: &Value<'_>) -> Result<(), String> {
    let content = match content {
        Value::Bytes(content) => &content[..],
        Value::Text(content) => content.as_bytes(),
        _ => return Ok(()),
    };
    match sha256 {
        Value::Bytes(sha256) if Sha256::digest(content)[..] == sha256[..] => Ok(()),
        _ => Err(DAMAGED.to_owned()),
    }
}
