//! What is signed of a run, event, note or instrument: its seal, and for a run in short what it says.

use serde::{Deserialize, Serialize};

use super::places::Places;
use super::signed::Signed;
use crate::backend::{Backend, SqlResult, values};
use crate::id::Id;

/// The kind of an entry that holds a signature.
pub(crate) const SIGNATURE: &str = "signature";

/// A signed statement about one entry of a chain of seals.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Statement {
    /// Version of this list.
    pub version: u32,
    /// `run`, `event`, `note` or `instrument`.
    pub what: String,
    /// The id of what is signed.
    pub id: String,
    /// The file that sealed it, and the position in its chain.
    pub file: String,
    /// The position there.
    pub entry: i64,
    /// SHA-256 of the content, as the seal has it.
    pub digest: String,
    /// The seal, which covers all entries before.
    pub seal: String,
    /// When it was made: the end of a run, the time of an event or note.
    pub at_us: i64,
    /// Who signed.
    #[serde(default)]
    pub who: String,
    /// Whose key it is: of a technician or a bench.
    #[serde(default)]
    pub kind: String,
    /// The public key.
    #[serde(default)]
    pub key: String,
    /// What a run says, in short.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub about: Option<About>,
    /// Beginnings of digests of each row of a run, by which a change is located.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub places: Option<Places>,
}

/// What a run says, in short: a certificate tells it without the database.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// Serial number of the unit.
    pub unit: String,
    /// The verdict.
    pub verdict: String,
    /// Who tested.
    pub operator: String,
    /// Where the unit was: `sim`, `serial:…`.
    pub source: String,
    /// The line.
    pub line: String,
    /// The train; empty: not stated.
    pub train: String,
    /// When it began.
    pub started_at_us: i64,
    /// Steps, and measured values.
    pub steps: i64,
    /// Measured values.
    pub measurements: i64,
    /// Version of the program.
    pub app_version: String,
    /// Faults that were injected on purpose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub injected: Option<String>,
}

impl Statement {
    /// The first digits of the key, as lists and sheets show it.
    pub fn short_key(&self) -> &str {
        self.key.get(..16).unwrap_or(&self.key)
    }

    /// The statement in a signed document, if it is one about an entry.
    pub fn of(signed: &Signed) -> Option<Self> {
        serde_json::from_value(signed.statement().clone()).ok()
    }
}

/// The signed documents about what belongs to this id, in the order in which they were made: of a run its own and those
/// of its notes, of a fault those of its events.
pub(crate) fn signatures_of(backend: &Backend, group: Id) -> SqlResult<Vec<String>> {
    backend.select(
        "SELECT says FROM seal WHERE id = ?1 AND what = 'signature' ORDER BY origin, ordinal",
        &values![group],
        |row| row.get(0),
    )
}

/// The signature of a run itself, if it has one that holds.
pub(crate) fn signature_of_run(backend: &Backend, run: Id) -> SqlResult<Option<Statement>> {
    let texts = signatures_of(backend, run)?;
    let signed = texts.iter().filter_map(|text| Signed::read(text).ok());
    let mut statements = signed.filter_map(|signed| Statement::of(&signed));
    Ok(statements.find(|statement| statement.what == "run"))
}
