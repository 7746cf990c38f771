//! Signed statement about a run, event, note or instrument: its seal, and for a run a summary.

use serde::{Deserialize, Serialize};

use super::places::Places;
use super::signed::Signed;
use crate::backend::{Backend, SqlResult, values};
use crate::error::{SealPlace, WrongSignature};
use crate::id::Id;
use crate::seal::covered::Covered;
use crate::seal::hex;
use crate::seal::samples::has_its_traces;

/// The kind of an entry that holds a signature.
pub(crate) const SIGNATURE: &str = "signature";

/// A signed statement about one entry of a chain of seals.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Statement {
    /// Version of this list of fields.
    pub version: u32,
    /// `run`, `event`, `note` or `instrument`.
    pub what: String,
    /// The id of what is signed.
    pub id: String,
    /// Id of the file whose chain has the seal.
    pub file: String,
    /// Number of the seal in that file's chain, from 1.
    pub entry: i64,
    /// SHA-256 of the content, as the seal has it.
    pub digest: String,
    /// The seal, which covers all entries before.
    pub seal: String,
    /// Time of what is signed, µs since 1970: the end of a run, the time of an event or note.
    pub at_us: i64,
    /// Name of the person who signed.
    #[serde(default)]
    pub who: String,
    /// Kind of the key's owner: technician or bench.
    #[serde(default)]
    pub kind: String,
    /// The public key.
    #[serde(default)]
    pub key: String,
    /// Summary of a run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<About>,
    /// Beginning of the digest of each row of a run; a change is located by comparing these.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub places: Option<Places>,
}

/// Summary of a run, so that a certificate can be read without the database.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// Serial number of the unit.
    pub unit: String,
    /// The verdict.
    pub verdict: String,
    /// Name of the tester.
    pub operator: String,
    /// Where the unit was: `sim`, `serial:…`.
    pub source: String,
    /// The line.
    pub line: String,
    /// The train; empty: not stated.
    pub train: String,
    /// When the run began, µs since 1970.
    pub started_at_us: i64,
    /// Number of different steps that were run.
    pub steps: i64,
    /// Number of measured values.
    pub measurements: i64,
    /// Version of the program.
    pub app_version: String,
    /// Faults that were injected on purpose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub injected: Option<String>,
}

impl Statement {
    /// Whether the statement is about the entry of this kind and id.
    pub(crate) fn is_about(&self, what: &str, id: Id) -> bool {
        self.what == what && self.id == id.to_string()
    }

    /// The first digits of the key, as lists and sheets show it.
    pub fn short_key(&self) -> &str {
        self.key.get(..16).unwrap_or(&self.key)
    }

    /// The statement in a signed document; `None` if the document is about something else than an entry.
    pub fn of(signed: &Signed) -> Option<Self> {
        serde_json::from_value(signed.statement().clone()).ok()
    }
}

/// The valid signed documents that belong to this id, in the order of their seals: of a run its own and those of its
/// notes, of a fault those of its events. Left out is a document whose run, note or event no longer has the signed
/// content.
pub(crate) fn signatures_of(backend: &Backend, group: Id) -> SqlResult<Vec<(String, Statement)>> {
    let texts = backend.select(
        "SELECT says FROM seal WHERE id = ?1 AND what = 'signature' ORDER BY origin, ordinal",
        &values![group],
        |row| row.get::<String>(0),
    )?;
    let mut held = Vec::new();
    for text in texts {
        if let Ok(statement) = read_signature(backend, group, &text)?
            && has_content(backend, &statement)?
        {
            held.push((text, statement));
        }
    }
    Ok(held)
}

/// Whether the run (with its traces), note or event that a statement names still has the signed content.
fn has_content(backend: &Backend, statement: &Statement) -> SqlResult<bool> {
    let Some(kind) = Covered::of(&statement.what) else {
        return Ok(true);
    };
    let Ok(id) = statement.id.parse::<Id>() else {
        return Ok(false);
    };
    let sql = format!(
        "SELECT t.seq, s.says FROM {} t JOIN seal s ON s.id = t.id AND s.what = ?2 WHERE t.id = ?1",
        kind.table()
    );
    let sealed = backend.select(&sql, &values![id, &statement.what], |row| {
        Ok((row.get::<i64>(0)?, row.get::<String>(1)?))
    })?;
    for (row, payload) in sealed {
        if hex(&kind.digest(backend, row, &payload)?) == statement.digest {
            return Ok(kind != Covered::Run || has_its_traces(backend, (id, row), &payload)?);
        }
    }
    Ok(false)
}

/// Reads a signature stored with a run, fault or instrument (`group`), and compares it with the seal that it signs and
/// with `group`; an error says what is wrong. Signatures are read here only.
pub(crate) fn read_signature(
    backend: &Backend,
    group: Id,
    text: &str,
) -> SqlResult<Result<Statement, WrongSignature>> {
    let signed = match Signed::read(text) {
        Ok(signed) => signed,
        Err(error) => return Ok(Err(WrongSignature::Document(error))),
    };
    let Some(statement) = Statement::of(&signed) else {
        return Ok(Err(WrongSignature::NoStatement));
    };
    let wrong = match wrong_subject(backend, group, &statement)? {
        None => seal_mismatch(backend, &statement)?,
        wrong => wrong,
    };
    Ok(wrong.map_or(Ok(statement), Err))
}

/// Error of a signature that is stored with the wrong thing: the signature of a run or instrument belongs to itself, of
/// a note to its run, of an event to its fault.
fn wrong_subject(
    backend: &Backend,
    group: Id,
    statement: &Statement,
) -> SqlResult<Option<WrongSignature>> {
    let what = &statement.what;
    let Ok(id) = statement.id.parse::<Id>() else {
        return Ok(Some(WrongSignature::NoSeal));
    };
    let owners = match &what[..] {
        "run" | "instrument" => vec![id],
        "note" => backend.select(
            "SELECT r.id FROM run_note n JOIN run r ON r.seq = n.run WHERE n.id = ?1",
            &values![id],
            |row| row.get(0),
        )?,
        "event" => backend.select(
            "SELECT f.id FROM fault_event e JOIN fault f ON f.seq = e.fault WHERE e.id = ?1
             UNION SELECT a.id FROM fault_event e JOIN fault_alias a ON a.fault = e.fault WHERE e.id = ?1",
            &values![id],
            |row| row.get(0),
        )?,
        _ => return Ok(Some(WrongSignature::NotThere(what.clone()))),
    };
    // A removed note or event is reported by its seal.
    let is_own = owners.is_empty() || owners.contains(&group);
    Ok((!is_own).then(|| WrongSignature::Other(what.clone(), id)))
}

/// Difference between a signature and the seal that it names.
fn seal_mismatch(backend: &Backend, statement: &Statement) -> SqlResult<Option<WrongSignature>> {
    let (Ok(id), Ok(file)) = (statement.id.parse::<Id>(), statement.file.parse::<Id>()) else {
        return Ok(Some(WrongSignature::NoSeal));
    };
    let sql = "SELECT what, id, digest, hash FROM seal WHERE origin = ?1 AND ordinal = ?2";
    let sealed = backend.first(sql, &values![file, statement.entry], |row| {
        let same = row.get::<String>(0)? == statement.what
            && row.get::<Id>(1)? == id
            && hex(row.get(2)?) == statement.digest
            && hex(row.get(3)?) == statement.seal;
        Ok(same)
    })?;
    if sealed == Some(true) {
        return Ok(None);
    }
    // A copy that got its own id has sealed the same content again.
    let sql = "SELECT digest FROM seal WHERE id = ?1 AND what = ?2";
    let again = backend.select(sql, &values![id, &statement.what], |row| {
        Ok(hex(row.get(0)?))
    })?;
    let (what, entry) = (statement.what.clone(), statement.entry);
    Ok(match (sealed, again.contains(&statement.digest)) {
        (None, true) => None,
        (None, false) if again.is_empty() => Some(WrongSignature::SealGone(what, id)),
        _ => Some(WrongSignature::OtherSeal(
            what,
            id,
            SealPlace { file, entry },
        )),
    })
}
