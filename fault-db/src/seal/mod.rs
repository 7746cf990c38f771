//! The chain of a file: each run that ends, all that is said later and each trace that is deleted is sealed
//! with a hash over all it says and over the seal before it. What was changed later no longer fits its
//! seal; what was taken out leaves a gap. Who rewrites the whole chain is found by a seal that is known
//! elsewhere: on a test sheet, in a backup, in another file, or on a server. SEALS.md says what is
//! hashed, byte by byte.

mod canon;
pub(crate) mod first;
mod head;
pub(crate) mod parted;
pub(crate) mod run;
pub(crate) mod said;
pub(crate) mod trace;

use serde::{Deserialize, Serialize};

pub(crate) use canon::COVERS;
use canon::Canon;
pub use head::{RunSealed, SealHead};
pub(crate) use head::{head_of, sealed_as};

use crate::base::{Base, SqlError, SqlResult, values};
use crate::id::Id;
use said::{Earlier, EarlierSays};

/// How a run, an event or a note came that was sealed as it was found.
pub(crate) const BY_IMPORT: &str = "import";
pub(crate) const BY_SYNC: &str = "sync";
const BY_UPDATE: &str = "an earlier version";

/// Adds an entry to the file's own chain.
pub(crate) fn append(
    base: &Base,
    what: &str,
    id: Id,
    says: &str,
    digest: [u8; 32],
) -> SqlResult<()> {
    append_as(base, what, id, COVERS, says, &digest)
}

fn append_as(
    base: &Base,
    what: &str,
    id: Id,
    covers: i64,
    says: &str,
    digest: &[u8],
) -> SqlResult<()> {
    let origin = own_name(base)?.ok_or(SqlError::File(rusqlite::Error::QueryReturnedNoRows))?;
    let (ordinal, before) = match head_of(base, origin)? {
        Some((ordinal, hash)) => (ordinal, Some(hash)),
        None => (0, None),
    };
    base.execute(
        "INSERT INTO seal(origin, ordinal, what, id, covers, says, digest, hash)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
        &values![
            origin,
            ordinal + 1,
            what,
            id,
            covers,
            says,
            digest,
            &chained(before.as_deref(), digest)[..]
        ],
    )?;
    Ok(())
}

/// The name of a file, which its own entries have; a server has neither.
pub(crate) fn own_name(base: &Base) -> SqlResult<Option<Id>> {
    if let Base::Server(_) = base {
        return Ok(None);
    }
    let sql = "SELECT value FROM about WHERE key = 'file_id'";
    base.first(sql, &[], |row| row.get(0))
}

pub(crate) use first::chained;

/// Adds an entry that says something no row says.
pub(crate) fn state(base: &Base, what: &str, id: Id, says: &impl Serialize) -> SqlResult<()> {
    let says = serde_json::to_string(says).unwrap_or_default();
    append(base, what, id, &says, statement_digest(what, id, &says))
}

/// The digest of an entry that says all by itself.
pub(crate) fn statement_digest(what: &str, id: Id, says: &str) -> [u8; 32] {
    let mut hash = Canon::of(what);
    hash.bytes(id.as_bytes());
    hash.text(says);
    hash.finish()
}

/// The digest of a run as it lies there, of the kind that this seal is.
pub(crate) fn run_digest(base: &Base, run: i64, covers: i64, says: &str) -> SqlResult<[u8; 32]> {
    match covers {
        COVERS => run::digest(base, run, says),
        _ => first::digest(base, run),
    }
}

/// Seals a run as it is found, since it came without a seal.
pub(crate) fn found_run(base: &Base, run: i64, found: &str) -> SqlResult<()> {
    let sql = "SELECT id FROM run WHERE seq = ?1";
    let Some(id) = base.first(sql, &values![run], |row| row.get(0))? else {
        return Ok(());
    };
    let says = run::says(base, run, found)?.text();
    append(base, "run", id, &says, run::digest(base, run, &says)?)
}

/// What an entry is called that says that a trace or recording was deleted.
pub(crate) const PRUNED: &str = "pruned";

/// What a trace's, or a recording's, entry says that it was deleted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PrunedSays {
    pub run: String,
    /// Of what was deleted, as its run's seal has it.
    pub sha256: String,
    /// The recording, by its place in the run; none of a trace.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<i64>,
    pub at_us: i64,
}

/// What the first entry of a file's chain in the fifth schema says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct BegunSays {
    /// The file's schema before; 0 of a new one.
    pub schema: i32,
    /// Runs sealed by an earlier version, and those that no version had sealed until then.
    pub runs_sealed: i64,
    pub runs_found: usize,
    pub events: EarlierSays,
    pub notes: EarlierSays,
}

/// Names a file and begins its chain, in the transaction that brought it up to date; what was recorded
/// until then keeps the seals it has.
pub(crate) fn begin(base: &Base, schema: i32, minted: Id) -> SqlResult<Id> {
    let known = own_name(base)?;
    let origin = known.unwrap_or(minted);
    if known.is_none() {
        let sql = "INSERT INTO about(key, value) VALUES ('file_id', ?1)";
        base.execute(sql, &values![origin])?;
    }
    let count = |sql: &str| base.first(sql, &[], |row| row.get::<i64>(0));
    // No version had sealed any run before the fourth schema. A run without a seal is none of theirs later.
    let found: Vec<i64> = match schema {
        0..4 => base.select(
            "SELECT seq FROM run WHERE verdict IS NOT NULL ORDER BY finished_at_us, seq",
            &[],
            |row| row.get(0),
        )?,
        _ => Vec::new(),
    };
    let begun = BegunSays {
        schema,
        runs_sealed: count("SELECT count(DISTINCT id) FROM seal")?.unwrap_or(0),
        runs_found: found.len(),
        events: said::earlier(base, Earlier::Events, i64::MAX)?,
        notes: said::earlier(base, Earlier::Notes, i64::MAX)?,
    };
    state(base, "begun", origin, &begun)?;
    for run in found {
        found_run(base, run, BY_UPDATE)?;
    }
    Ok(origin)
}

/// As lower-case hex digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// What an entry is called that says what was counted anew.
pub(crate) const RECOUNTED: &str = "recounted";

/// What was not as the history says before it was counted anew: it may be all that shows of a row that was
/// changed by hand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RecountedSays {
    pub at_us: i64,
    pub differed: Vec<String>,
}

impl RecountedSays {
    /// As a person reads it.
    pub fn text(&self) -> String {
        let at = chrono::DateTime::from_timestamp_micros(self.at_us).unwrap_or_default();
        format!(
            "counted anew at {}; until then {}",
            at.format("%Y-%m-%d %H:%M:%S UTC"),
            self.differed.join("; ")
        )
    }
}

/// What the first entry of a copy says that got a name of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CopiedSays {
    /// The file it is a copy of.
    pub file: String,
    /// The last entry that both have, and its hash.
    pub after: i64,
    pub seal: String,
    pub at_us: i64,
}

impl CopiedSays {
    /// Of a file that is a copy from this entry on.
    pub fn of(base: &Base, origin: Id, after: i64, at_us: i64) -> SqlResult<Self> {
        let sql = "SELECT hash FROM seal WHERE origin = ?1 AND ordinal = ?2";
        let hash: Option<Vec<u8>> = base.first(sql, &values![origin, after], |row| row.get(0))?;
        Ok(Self {
            file: origin.to_string(),
            after,
            seal: hex(&hash.unwrap_or_default()),
            at_us,
        })
    }
}

const COPIED: &str = "copied";

/// Gives a file another name, begins its chain, and enters in it what the file went on with: with the digests
/// it had, so that nothing that was changed fits again.
pub(crate) fn name_anew(base: &Base, name: Id, says: &CopiedSays) -> SqlResult<()> {
    base.execute(
        "UPDATE about SET value = ?1 WHERE key = 'file_id'",
        &values![name],
    )?;
    state(base, COPIED, name, says)?;
    let Ok(before) = says.file.parse::<Id>() else {
        return Ok(());
    };
    let went_on = base.select(
        "SELECT what, id, covers, says, digest FROM seal WHERE origin = ?1 AND ordinal > ?2
         ORDER BY ordinal",
        &values![before, says.after],
        |row| {
            Ok((
                row.get::<String>(0)?,
                row.get::<Id>(1)?,
                row.get::<i64>(2)?,
                row.get::<String>(3)?,
                row.get::<Vec<u8>>(4)?,
            ))
        },
    )?;
    for (what, id, covers, says, digest) in went_on {
        append_as(base, &what, id, covers, &says, &digest)?;
    }
    Ok(())
}

/// The entry after which a file is a copy of another, if it said so.
pub(crate) fn copied_from(base: &Base, origin: Id) -> SqlResult<Option<i64>> {
    let says = base.select(
        "SELECT says FROM seal WHERE what = 'copied' ORDER BY origin",
        &[],
        |row| row.get::<String>(0),
    )?;
    let says = says
        .iter()
        .filter_map(|says| serde_json::from_str::<CopiedSays>(says).ok());
    Ok(says
        .filter(|says| says.file == origin.to_string())
        .map(|says| says.after)
        .min())
}
