//! Checks content against the SHA-256 in its row: channel lists and samples of traces.

use sha2::{Digest as _, Sha256};

use crate::backend::Value;

/// The reason for refusing content that is not what was stored.
pub(super) const DAMAGED: &str = "it does not match its checksum";

/// Compares content with the digest in its row; a value of another type passes, as the column's domain refuses it.
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
