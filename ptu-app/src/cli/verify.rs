//! `ptu verify`: who signed, and whether anything was changed since.

mod sheet;

use std::path::{Path, PathBuf};

use clap::Args;
use fault_db::{About, Id, SignatureError, Signed, Statement, Store, Verification};
use serde_json::{Value, json};

use super::key::KeysOption;
use super::{Database, Json, answered};
use ptu_report::has_certificate;
use ptu_runs::clock::{self, rfc3339};
use ptu_runs::failure::{Asked, Exit, Failure, FileTrouble, Why};
use ptu_runs::keys::KeyList;

/// Longest sheet or certificate that is read, bytes.
const LONGEST: u64 = 64 << 20;
/// What a database file begins with.
const DATABASE: &[u8] = b"SQLite format 3\0";

/// Say who signed a run, a database, a sheet or a certificate, and whether anything was changed since; needs no network
///
/// Examples:
///   ptu verify latest                      the last run of the database
///   ptu verify sheet.html --keys depot.keys
///   ptu verify run.ptucert
///   ptu verify ptu:01a2…/220d…             what a scanner reads of a printed sheet
///   ptu verify history.db                  all of a file
///
/// Exit codes: 0 signed by a key that is trusted, and unchanged, 1 changed, not signed, or signed by a key that is not
/// trusted, 2 no such run or file, 3 it cannot be read.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct VerifyArguments {
    /// A run (an id, its beginning or end, `latest`, or what the code of a sheet says), a database file, an .html sheet or
    /// a .ptucert file
    #[arg(value_name = "RUN|FILE")]
    what: String,
    #[command(flatten)]
    keys: KeysOption,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    database: Database,
}

/// What was found.
#[derive(Default)]
struct Findings {
    /// `run`, `database`, `sheet` or `certificate`.
    what: &'static str,
    id: String,
    /// A signature or seal of it as a whole was read: without one nothing says that it is unchanged.
    is_covered: bool,
    /// Who signed what, when, and how the key stood then.
    signatures: Vec<Value>,
    /// The same in words.
    said: Vec<String>,
    /// What was changed, and where.
    changes: Vec<String>,
    /// What is not signed, or not by a key that is trusted.
    doubts: Vec<String>,
    /// What is to be known besides.
    remarks: Vec<String>,
}

impl VerifyArguments {
    /// Verifies.
    pub fn run(self) -> Result<Exit, Failure> {
        let keys = self.keys.read()?;
        let path = Path::new(&self.what);
        let found = match path.is_file() {
            true => self.file(path, &keys)?,
            false => self.of_run(&keys)?,
        };
        let good = found.changes.is_empty() && found.doubts.is_empty();
        let told = self.json.answer(|| found.json(), || found.text());
        let exit = if good { Exit::Passed } else { Exit::Failed };
        answered(told, exit)
    }

    fn of_run(&self, keys: &KeyList) -> Result<Findings, Failure> {
        if looks_like_a_file(&self.what) {
            return Err(Failure::usage(FileTrouble::Missing(self.what.clone())));
        }
        // Of a code on a sheet: the run, and the SHA-256 of its content that the sheet was written from.
        let code = self.what.strip_prefix("ptu:");
        let (asked, digest) = match code.map(|code| code.split_once('/')) {
            None => (self.what.as_str(), None),
            Some(Some((run, digest))) => (run, Some(digest)),
            Some(None) => return Err(Failure::usage(Asked::NoCodeOfSheet)),
        };
        let store = self.database.open_read_only()?;
        let id = store.resolve_run(asked)?;
        let seen = store.verify_run(id)?;
        let is_same = digest.map(|digest| has_content(&seen, digest));
        let mut found = Findings {
            what: "run",
            is_covered: true,
            id: id.to_string(),
            ..Findings::default()
        };
        found.take_run(seen, keys);
        match is_same {
            Some(true) => {
                (found.remarks).push("the run in the database is the one of the sheet".into())
            }
            Some(false) => {
                (found.changes).push("the run in the database is not the one of the sheet".into())
            }
            None => {}
        }
        Ok(found)
    }

    fn file(&self, path: &Path, keys: &KeyList) -> Result<Findings, Failure> {
        let cannot = |error: std::io::Error| Failure::bench(FileTrouble::unread(path, error));
        let mut head = [0; DATABASE.len()];
        let read = std::io::Read::read(&mut std::fs::File::open(path).map_err(cannot)?, &mut head);
        if read.map_err(cannot)? == head.len() && head == *DATABASE {
            return self.of_database(path, keys);
        }
        let bytes = fault_db::read_regular_file(path, LONGEST).map_err(cannot)?;
        let none = |why| Failure::bench(Asked::NoSignature(path.display().to_string(), why));
        let text = String::from_utf8(bytes).map_err(|_| none(Why::NoText))?;
        if has_certificate(&text) {
            return Ok(sheet::sheet(&text, keys));
        }
        if text.trim_start().starts_with('{') {
            return self.certificate(&text, keys).map_err(none);
        }
        Err(none(Why::Unsigned))
    }

    fn of_database(&self, path: &Path, keys: &KeyList) -> Result<Findings, Failure> {
        let store = Store::open_read_only(path)?;
        let report = store.check()?;
        let mut found = Findings {
            what: "database",
            is_covered: true,
            id: path.display().to_string(),
            ..Findings::default()
        };
        found.changes = report
            .problems
            .into_iter()
            .map(|problem| problem.detail.to_string())
            .collect();
        found.remarks = report.remarks;
        // What this computer's own history has seen of it, by a sync or an import.
        if let Ok(own) = self.database.open_read_only() {
            for broken in own.seen_otherwise(&store)? {
                if !found.changes.contains(&broken) {
                    found.changes.push(broken);
                }
            }
        }
        let signers = report.signed.iter().map(|key| key.who.to_lowercase());
        found.take_unsigned(&store.unsigned_notes()?, &signers.collect::<Vec<_>>());
        let signed: u32 = report.signed.iter().map(|key| key.runs).sum();
        for key in report.signed {
            let stood = [key.first_at_us, key.last_at_us]
                .map(|at_us| keys.standing(&key.key, &key.who, &key.kind, at_us));
            let wrong = stood.iter().find(|standing| !standing.is_good());
            let standing = wrong.unwrap_or(&stood[0]).text();
            let short = key.key.get(..16).unwrap_or_default();
            let name = format!("{} ({}, key {short})", key.who, key.kind);
            found.said.push(format!(
                "{name} signed {} runs and {} notes, events and instruments, from {} to {}; the key {standing}",
                key.runs,
                key.others,
                clock::local(key.first_at_us),
                clock::local(key.last_at_us)
            ));
            if wrong.is_some() {
                found.doubts.push(format!("the key of {name} {standing}"));
            }
            found.doubts.extend(dated_ahead(&name, key.last_at_us));
            found.signatures.push(json!({
                "what": "database", "id": null, "who": key.who, "kind": key.kind, "key": key.key,
                "at": rfc3339(key.last_at_us), "trusted": wrong.is_none(), "standing": standing,
            }));
        }
        if signed == 0 {
            found.doubts.push("no run in it is signed".to_owned());
        } else if signed < report.runs {
            let unsigned = report.runs - signed;
            found
                .remarks
                .push(format!("{unsigned} of {} runs are not signed", report.runs));
        }
        Ok(found)
    }

    /// A certificate by itself, and held against the run where the database has it.
    fn certificate(&self, text: &str, keys: &KeyList) -> Result<Findings, Why> {
        let mut found = Findings {
            what: "certificate",
            is_covered: true,
            ..Findings::default()
        };
        match Signed::read(text.strip_suffix('\n').unwrap_or(text)) {
            Err(why @ SignatureError::Unreadable(_)) => return Err(Why::of(why)),
            Err(why) => found.changes.push(format!("the certificate: {why}")),
            Ok(signed) => {
                let statement = Statement::of(&signed).ok_or(Why::NoStatement)?;
                found.id = statement.id.clone();
                found.take(&statement, keys);
                self.hold_against_database(&statement, &mut found);
            }
        }
        Ok(found)
    }

    fn hold_against_database(&self, statement: &Statement, found: &mut Findings) {
        let look = || -> Option<Verification> {
            let store = self.database.open_read_only().ok()?;
            store.verify_run(statement.id.parse().ok()?).ok()
        };
        match look() {
            None => found
                .remarks
                .push("the database here does not have this run".to_owned()),
            Some(seen) => {
                if !has_content(&seen, &statement.digest) {
                    found
                        .changes
                        .push("the run in the database is not what was signed".to_owned());
                }
                found.changes.extend(seen.changes);
                if found.changes.is_empty() {
                    found
                        .remarks
                        .push("the run in the database is what was signed".to_owned());
                }
            }
        }
    }
}

/// Whether a run was sealed with this SHA-256 of its content.
fn has_content(seen: &Verification, digest: &str) -> bool {
    (seen.seal.as_ref()).is_some_and(|seal| seal.digest == digest)
}

/// Whether a name is meant as that of a file.
fn looks_like_a_file(name: &str) -> bool {
    let ending = PathBuf::from(name);
    let ending = ending.extension().and_then(|ending| ending.to_str());
    let is_code = name.starts_with("ptu:");
    (!is_code && name.contains(['/', '\\'])) || matches!(ending, Some("db" | "html" | "ptucert"))
}

/// A clock may be ahead of this one by so much, µs.
const AHEAD_US: i64 = 86_400_000_000;

/// What to say of a signature that is dated in the future.
fn dated_ahead(name: &str, at_us: i64) -> Option<String> {
    let is_ahead = at_us > clock::now_us().saturating_add(AHEAD_US);
    is_ahead.then(|| {
        format!(
            "a signature of {name} is dated in the future: {}",
            clock::local(at_us)
        )
    })
}

impl Findings {
    fn take_run(&mut self, seen: Verification, keys: &KeyList) {
        for statement in &seen.signatures {
            self.take(statement, keys);
        }
        if seen.seal.is_none() {
            self.doubts
                .push("the run has not ended: nothing is sealed".to_owned());
        } else if seen.of_run().next().is_none() {
            self.doubts
                .push("the run is not signed; what its seal says stands below".to_owned());
        }
        if let Some(seal) = &seen.seal {
            let as_found = match &seal.found {
                Some(_) => ", as it was found when it came in",
                None => "",
            };
            self.remarks.push(format!(
                "seal {}, entry {} of database {}{as_found}",
                seal.short(),
                seal.entry,
                seal.file.short()
            ));
        }
        let signers = seen.signatures.iter().map(|one| one.who.to_lowercase());
        self.take_unsigned(&seen.unsigned_notes, &signers.collect::<Vec<_>>());
        self.remarks.extend(seen.remarks);
        let pruned = seen.pruned.iter().map(|what| format!("{what} was pruned"));
        self.remarks.extend(pruned);
        self.changes.extend(seen.changes);
    }

    /// Notes that nobody signed: a doubt in the name of one of these signers.
    fn take_unsigned(&mut self, notes: &[(Id, String)], signers: &[String]) {
        for (id, who) in notes {
            let said = format!("note {} in the name of \"{who}\" is not signed", id.short());
            match signers.contains(&who.to_lowercase()) {
                true => self.doubts.push(said),
                false => self.remarks.push(said),
            }
        }
    }

    fn take(&mut self, signed: &Statement, keys: &KeyList) {
        let standing = keys.standing(&signed.key, &signed.who, &signed.kind, signed.at_us);
        let (at, short) = (clock::local(signed.at_us), signed.short_key());
        let name = format!("{} ({}, key {short})", signed.who, signed.kind);
        let id = signed
            .id
            .get(signed.id.len().saturating_sub(8)..)
            .unwrap_or_default();
        let what = &signed.what;
        let about = signed.about.as_ref().map_or_else(String::new, about);
        self.said.push(format!(
            "{what} {id}: signed by {name} at {at}; the key {}{about}",
            standing.text()
        ));
        if !standing.is_good() {
            self.doubts.push(format!(
                "{what} {id}: the key of {name} {}",
                standing.text()
            ));
        }
        self.doubts.extend(dated_ahead(&name, signed.at_us));
        self.signatures.push(json!({
            "what": what, "id": signed.id, "who": signed.who, "kind": signed.kind, "key": signed.key,
            "at": rfc3339(signed.at_us), "trusted": standing.is_good(), "standing": standing.text(),
        }));
    }

    fn json(&self) -> Value {
        json!({
            "what": self.what, "id": self.id,
            "verified": self.changes.is_empty() && self.doubts.is_empty(),
            "changes": self.changes, "doubts": self.doubts, "signatures": self.signatures, "remarks": self.remarks,
        })
    }

    fn text(&self) -> String {
        let mut lines = self.said.clone();
        if !self.changes.is_empty() {
            lines.push(format!("CHANGED, {} findings:", self.changes.len()));
            lines.extend(self.changes.iter().map(|change| format!("  {change}")));
        } else if self.is_covered {
            lines.push(format!(
                "unchanged: the {} is as it was {}",
                self.what,
                match self.signatures.is_empty() {
                    true => "sealed",
                    false => "signed",
                }
            ));
        }
        if !self.doubts.is_empty() {
            lines.push("NOT VERIFIED:".to_owned());
            lines.extend(self.doubts.iter().map(|doubt| format!("  {doubt}")));
        }
        lines.extend(self.remarks.iter().cloned());
        lines.join("\n")
    }
}

/// What a signed run says, in short.
fn about(about: &About) -> String {
    let injected = match &about.injected {
        Some(faults) => format!(", with injected faults {faults}"),
        None => String::new(),
    };
    format!(
        "\n  unit {}: {}, {} steps run, {} measured values, by {}, on {}, begun {}{injected}",
        about.unit,
        about.verdict,
        about.steps,
        about.measurements,
        if about.operator.is_empty() {
            "a person not named"
        } else {
            &about.operator
        },
        about.source,
        clock::local(about.started_at_us)
    )
}
