//! The hash chain of a file. Each finished run, each later event or note and each deletion of a trace is
//! sealed: an entry holds a digest of the content and a hash over that digest and the entry before.
//!
//! A changed row no longer matches its digest, and a removed entry leaves a gap. A chain that was rewritten
//! as a whole is detected where one of its hashes is known elsewhere: on a test sheet, in a backup, in
//! another file, or on a server. SEALS.md lists the hashed fields, byte by byte.

pub(crate) mod canonical;
pub(crate) mod covered;
pub(crate) mod divergence;
pub(crate) mod events_and_notes;
mod head;
pub(crate) mod known_heads;
pub(crate) mod run;
pub(crate) mod samples;
pub(crate) mod trace;

use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use canonical::CanonicalHash;
pub(crate) use divergence::hash_of;
pub use head::{RunSealed, SealHead};
pub(crate) use head::{head_of, sealed_as};

use crate::backend::{Backend, SqlError, SqlResult, values};
use crate::id::Id;
use crate::schema::SCHEMA_VERSION;

/// Values of `found`: how a run, event or note came that was sealed as found.
pub(crate) const BY_IMPORT: &str = "import";
pub(crate) const BY_SYNC: &str = "sync";

/// Appends an entry to the file's own chain.
pub(crate) fn append(
    backend: &Backend,
    what: &str,
    id: Id,
    payload: &str,
    digest: &[u8],
) -> SqlResult<()> {
    let origin =
        own_file_id(backend)?.ok_or(SqlError::File(rusqlite::Error::QueryReturnedNoRows))?;
    let (ordinal, before) = match head_of(backend, origin)? {
        Some((ordinal, hash)) => (ordinal, Some(hash)),
        None => (0, None),
    };
    backend.execute(
        "INSERT INTO seal(origin, ordinal, what, id, says, digest, hash) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
        &values![
            origin,
            ordinal + 1,
            what,
            id,
            payload,
            digest,
            &chained(before.as_deref(), digest)[..]
        ],
    )?;
    Ok(())
}

/// The hash of an entry, from the hash of the entry before and its digest.
pub(crate) fn chained(before: Option<&[u8]>, digest: &[u8]) -> [u8; 32] {
    let hash = Sha256::new().chain_update(before.unwrap_or_default());
    hash.chain_update(digest).finalize().into()
}

/// The file's id, under which its entries are made; `None` for a server.
pub(crate) fn own_file_id(backend: &Backend) -> SqlResult<Option<Id>> {
    if let Backend::Server(_) = backend {
        return Ok(None);
    }
    let sql = "SELECT value FROM about WHERE key = 'file_id'";
    backend.first(sql, &[], |row| row.get(0))
}

/// Appends an entry whose payload is its whole content.
pub(crate) fn append_statement(
    backend: &Backend,
    what: &str,
    id: Id,
    payload: &impl Serialize,
) -> SqlResult<()> {
    let payload = serde_json::to_string(payload).unwrap_or_default();
    append(
        backend,
        what,
        id,
        &payload,
        &statement_digest(what, id, &payload),
    )
}

/// The digest of an entry whose payload is its whole content.
pub(crate) fn statement_digest(what: &str, id: Id, payload: &str) -> [u8; 32] {
    let mut hash = CanonicalHash::of(what);
    hash.bytes(id.as_bytes());
    hash.text(payload);
    hash.finish()
}

/// The kind of an entry for the deletion of a trace or recording.
pub(crate) const PRUNED: &str = "pruned";

/// The payload of an entry for a deletion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PrunedPayload {
    pub run: String,
    /// The digest of the deleted trace or recording, as in its run's seal.
    pub sha256: String,
    /// The position of the recording in its run; `None` for a trace.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<i64>,
    pub at_us: i64,
}

/// The kind of the first entry of a chain.
pub(crate) const BEGUN: &str = "begun";

/// The payload of the first entry of a chain.
#[derive(Serialize)]
pub(crate) struct BegunPayload {
    /// The file's schema.
    pub schema: i32,
}

/// Gives a new file its id and begins its chain, in the transaction that creates its tables.
pub(crate) fn begin(backend: &Backend, origin: Id) -> SqlResult<Id> {
    let sql = "INSERT INTO about(key, value) VALUES ('file_id', ?1)";
    backend.execute(sql, &values![origin])?;
    let begun = BegunPayload {
        schema: SCHEMA_VERSION,
    };
    append_statement(backend, BEGUN, origin, &begun)?;
    Ok(origin)
}

/// Bytes as lower-case hex digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Bytes of lower-case hex digits.
pub(crate) fn from_hex(text: &str) -> Option<Vec<u8>> {
    let digit = |byte: u8| match byte {
        b'0'..=b'9' => Some(byte - b'0'),
        b'a'..=b'f' => Some(byte - b'a' + 10),
        _ => None,
    };
    let pairs = text.as_bytes().chunks(2).map(|pair| match pair {
        [high, low] => Some(digit(*high)? << 4 | digit(*low)?),
        _ => None,
    });
    pairs.collect()
}

/// The kind of an entry for a recount.
pub(crate) const RECOUNTED: &str = "recounted";

/// Rows that differed before a recount: perhaps the only trace of a row that was changed by hand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RecountedPayload {
    pub at_us: i64,
    pub differed: Vec<String>,
}

/// The payload of the first entry of a copy that got an id of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CopiedPayload {
    /// Id of the file that this is a copy of.
    pub file: String,
    /// Number and hash of the last entry that both files have.
    pub after: i64,
    pub seal: String,
    pub at_us: i64,
}

impl CopiedPayload {
    /// The payload for a copy of file `origin` that goes its own way after entry `after`.
    pub fn of(backend: &Backend, origin: Id, after: i64, at_us: i64) -> SqlResult<Self> {
        let hash = hash_of(backend, origin, after)?;
        Ok(Self {
            file: origin.to_string(),
            after,
            seal: hex(&hash.unwrap_or_default()),
            at_us,
        })
    }
}

const COPIED: &str = "copied";

/// Gives a copy its own id, begins its chain, and repeats in that chain the entries made since the copy, with their
/// digests, so that rows changed meanwhile still do not match.
pub(crate) fn start_chain_of_copy(
    backend: &Backend,
    name: Id,
    payload: &CopiedPayload,
) -> SqlResult<()> {
    backend.execute(
        "UPDATE about SET value = ?1 WHERE key = 'file_id'",
        &values![name],
    )?;
    append_statement(backend, COPIED, name, payload)?;
    let Ok(before) = payload.file.parse::<Id>() else {
        return Ok(());
    };
    let went_on = backend.select(
        "SELECT what, id, says, digest FROM seal WHERE origin = ?1 AND ordinal > ?2 ORDER BY ordinal",
        &values![before, payload.after],
        |row| {
            Ok((
                row.get::<String>(0)?,
                row.get::<Id>(1)?,
                row.get::<String>(2)?,
                row.get::<Vec<u8>>(3)?,
            ))
        },
    )?;
    for (what, id, payload, digest) in went_on {
        append(backend, &what, id, &payload, &digest)?;
    }
    Ok(())
}

/// Number of the last entry of file `origin` that this file, a copy, shares with it; `None` if this file is no such
/// copy.
pub(crate) fn copied_from(backend: &Backend, origin: Id) -> SqlResult<Option<i64>> {
    let payload = backend.select(
        "SELECT says FROM seal WHERE what = 'copied' ORDER BY origin",
        &[],
        |row| row.get::<String>(0),
    )?;
    let payload = payload
        .iter()
        .filter_map(|payload| serde_json::from_str::<CopiedPayload>(payload).ok());
    Ok(payload
        .filter(|payload| payload.file == origin.to_string())
        .map(|payload| payload.after)
        .min())
}
