//! `ptu verify`: who signed, and whether anything was changed since.

mod sheet;

use std::fmt::Display;
use std::path::{Path, PathBuf};

use clap::Args;
use fault_db::{About, Id, SignatureError, Signed, Statement, Store, Verification};
use serde_json::{Value, json};

use super::key::KeysOption;
use super::{Database, Json, answered};
use ptu_report::has_certificate;
use ptu_report::words::{Language, Words, fill};
use ptu_runs::clock::{self, rfc3339};
use ptu_runs::failure::{Asked, Exit, Failure, FileTrouble, Why};
use ptu_runs::keys::{KeyList, Standing};
use ptu_runs::stored::from_stored;
use ptu_runs::words::{Manner, Say as _};

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

/// What was found, in the words of those who read it.
struct Findings {
    words: &'static Words,
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
        // Other programs read English.
        let words = match self.json.is_asked() {
            true => Language::English.words(),
            false => Words::shown(),
        };
        let keys = self.keys.read()?;
        let path = Path::new(&self.what);
        let found = match path.is_file() {
            true => self.file(path, &keys, words)?,
            false => self.of_run(&keys, words)?,
        };
        let good = found.changes.is_empty() && found.doubts.is_empty();
        let told = self.json.answer(|| found.json(), || found.text());
        let exit = if good { Exit::Passed } else { Exit::Failed };
        answered(told, exit)
    }

    fn of_run(&self, keys: &KeyList, words: &'static Words) -> Result<Findings, Failure> {
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
            is_covered: true,
            id: id.to_string(),
            ..Findings::of("run", words)
        };
        found.take_run(seen, keys);
        match is_same {
            Some(true) => (found.remarks).push(words.verify.of_sheet.into()),
            Some(false) => (found.changes).push(words.verify.not_of_sheet.into()),
            None => {}
        }
        Ok(found)
    }

    fn file(
        &self,
        path: &Path,
        keys: &KeyList,
        words: &'static Words,
    ) -> Result<Findings, Failure> {
        let cannot = |error: std::io::Error| Failure::bench(FileTrouble::unread(path, error));
        let mut head = [0; DATABASE.len()];
        let read = std::io::Read::read(&mut std::fs::File::open(path).map_err(cannot)?, &mut head);
        if read.map_err(cannot)? == head.len() && head == *DATABASE {
            return self.of_database(path, keys, words);
        }
        let bytes = fault_db::read_regular_file(path, LONGEST).map_err(cannot)?;
        let none = |why| Failure::bench(Asked::NoSignature(path.display().to_string(), why));
        let text = String::from_utf8(bytes).map_err(|_| none(Why::NoText))?;
        if has_certificate(&text) {
            return Ok(sheet::sheet(&text, keys, words));
        }
        if text.trim_start().starts_with('{') {
            return self.certificate(&text, keys, words).map_err(none);
        }
        Err(none(Why::Unsigned))
    }

    fn of_database(
        &self,
        path: &Path,
        keys: &KeyList,
        words: &'static Words,
    ) -> Result<Findings, Failure> {
        let store = Store::open_read_only(path)?;
        let report = store.check()?;
        let mut found = Findings {
            is_covered: true,
            id: path.display().to_string(),
            ..Findings::of("database", words)
        };
        found.changes = report
            .problems
            .into_iter()
            .map(|problem| words.damage(&problem.detail))
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
            let standing = found.standing(wrong.unwrap_or(&stood[0]));
            let short = key.key.get(..16).unwrap_or_default();
            let name = found.name(&key.who, &key.kind, short);
            found.said.push(fill(
                words.verify.signed_many,
                &[
                    ("name", &name),
                    ("runs", &key.runs),
                    ("others", &key.others),
                    ("from", &clock::local(key.first_at_us)),
                    ("until", &clock::local(key.last_at_us)),
                    ("standing", &standing),
                ],
            ));
            if wrong.is_some() {
                let of = [("name", &name as _), ("standing", &standing as _)];
                found.doubts.push(fill(words.verify.key_of_doubted, &of));
            }
            found
                .doubts
                .extend(dated_ahead(&name, key.last_at_us, words));
            found.signatures.push(json!({
                "what": "database", "id": null, "who": key.who, "kind": key.kind, "key": key.key,
                "at": rfc3339(key.last_at_us), "trusted": wrong.is_none(), "standing": standing,
            }));
        }
        if signed == 0 {
            found.doubts.push(words.verify.no_run_signed.to_owned());
        } else if signed < report.runs {
            let unsigned = report.runs - signed;
            let of = [("n", &unsigned as _), ("of", &report.runs as _)];
            found.remarks.push(fill(words.verify.some_unsigned, &of));
        }
        Ok(found)
    }

    /// A certificate by itself, and held against the run where the database has it.
    fn certificate(
        &self,
        text: &str,
        keys: &KeyList,
        words: &'static Words,
    ) -> Result<Findings, Why> {
        let mut found = Findings {
            is_covered: true,
            ..Findings::of("certificate", words)
        };
        match Signed::read(text.strip_suffix('\n').unwrap_or(text)) {
            Err(why @ SignatureError::Unreadable(_)) => return Err(Why::of(why)),
            Err(why) => {
                let said = fill(words.verify.wrong_certificate, &[("why", &why)]);
                found.changes.push(said);
            }
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
        let verify = &found.words.verify;
        match look() {
            None => found.remarks.push(verify.run_not_here.to_owned()),
            Some(seen) => {
                if !has_content(&seen, &statement.digest) {
                    found.changes.push(verify.not_signed_content.to_owned());
                }
                found.changes.extend(seen.changes);
                if found.changes.is_empty() {
                    found.remarks.push(verify.signed_content.to_owned());
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
fn dated_ahead(name: &str, at_us: i64, words: &Words) -> Option<String> {
    let is_ahead = at_us > clock::now_us().saturating_add(AHEAD_US);
    is_ahead.then(|| {
        let at = clock::local(at_us);
        fill(words.verify.dated_ahead, &[("name", &name), ("at", &at)])
    })
}

impl Findings {
    /// Nothing yet, of a `run`, `database`, `sheet` or `certificate`.
    fn of(what: &'static str, words: &'static Words) -> Self {
        Self {
            words,
            what,
            id: String::new(),
            is_covered: false,
            signatures: Vec::new(),
            said: Vec::new(),
            changes: Vec::new(),
            doubts: Vec::new(),
            remarks: Vec::new(),
        }
    }

    fn standing(&self, standing: &Standing) -> String {
        standing.say(Manner {
            korean: self.words.language == Language::Korean,
            commands: true,
        })
    }

    fn name(&self, who: &str, kind: &str, key: &str) -> String {
        let of = [("who", &who as _), ("kind", &kind as _), ("key", &key as _)];
        fill(self.words.verify.name, &of)
    }

    fn take_run(&mut self, seen: Verification, keys: &KeyList) {
        let verify = &self.words.verify;
        for statement in &seen.signatures {
            self.take(statement, keys);
        }
        if seen.seal.is_none() {
            self.doubts.push(verify.not_ended.to_owned());
        } else if seen.of_run().next().is_none() {
            self.doubts.push(verify.run_unsigned.to_owned());
        }
        if let Some(seal) = &seen.seal {
            let as_found = match &seal.found {
                Some(_) => verify.as_found,
                None => "",
            };
            self.remarks.push(fill(
                verify.seal,
                &[
                    ("seal", &seal.short()),
                    ("entry", &seal.entry),
                    ("file", &seal.file.short()),
                    ("found", &as_found),
                ],
            ));
        }
        let signers = seen.signatures.iter().map(|one| one.who.to_lowercase());
        self.take_unsigned(&seen.unsigned_notes, &signers.collect::<Vec<_>>());
        self.remarks.extend(seen.remarks);
        let pruned = seen.pruned.iter();
        let pruned = pruned.map(|what| fill(verify.pruned, &[("what", what)]));
        self.remarks.extend(pruned);
        self.changes.extend(seen.changes);
    }

    /// Notes that nobody signed: a doubt in the name of one of these signers.
    fn take_unsigned(&mut self, notes: &[(Id, String)], signers: &[String]) {
        for (id, who) in notes {
            let of = [("id", &id.short() as _), ("who", who as _)];
            let said = fill(self.words.verify.note_unsigned, &of);
            match signers.contains(&who.to_lowercase()) {
                true => self.doubts.push(said),
                false => self.remarks.push(said),
            }
        }
    }

    fn take(&mut self, signed: &Statement, keys: &KeyList) {
        let standing = keys.standing(&signed.key, &signed.who, &signed.kind, signed.at_us);
        let (at, short) = (clock::local(signed.at_us), signed.short_key());
        let name = self.name(&signed.who, &signed.kind, short);
        let said = self.standing(&standing);
        let words = self.words;
        let id = signed
            .id
            .get(signed.id.len().saturating_sub(8)..)
            .unwrap_or_default();
        let what = &signed.what;
        let about = signed.about.as_ref();
        let about = about.map_or_else(String::new, |of| about_text(of, words));
        let of: [(&str, &dyn Display); 6] = [
            ("what", &words.verify.what(what)),
            ("id", &id),
            ("name", &name),
            ("at", &at),
            ("standing", &said),
            ("about", &about),
        ];
        self.said.push(fill(words.verify.signed, &of));
        if !standing.is_good() {
            self.doubts.push(fill(words.verify.key_doubted, &of));
        }
        self.doubts.extend(dated_ahead(&name, signed.at_us, words));
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
        let verify = &self.words.verify;
        let mut lines = self.said.clone();
        if !self.changes.is_empty() {
            lines.push(fill(verify.changed, &[("n", &self.changes.len())]));
            lines.extend(self.changes.iter().map(|change| format!("  {change}")));
        } else if self.is_covered {
            let said = match self.signatures.is_empty() {
                true => verify.unchanged_sealed,
                false => verify.unchanged_signed,
            };
            lines.push(fill(said, &[("what", &verify.what(self.what))]));
        }
        if !self.doubts.is_empty() {
            lines.push(verify.not_verified.to_owned());
            lines.extend(self.doubts.iter().map(|doubt| format!("  {doubt}")));
        }
        lines.extend(self.remarks.iter().cloned());
        lines.join("\n")
    }
}

/// What a signed run says, in short.
fn about_text(about: &About, words: &Words) -> String {
    let verify = &words.verify;
    let injected = match &about.injected {
        Some(faults) => fill(verify.injected, &[("faults", faults)]),
        None => String::new(),
    };
    let who = match about.operator.as_str() {
        "" => verify.nobody,
        who => who,
    };
    let verdict = about.verdict.parse().ok();
    let verdict = verdict.map(|verdict| words.verdict_name(from_stored(verdict)));
    let said = fill(
        verify.about,
        &[
            ("unit", &about.unit),
            ("verdict", &verdict.unwrap_or(&about.verdict)),
            ("steps", &about.steps),
            ("n", &about.measurements),
            ("who", &who),
            ("source", &about.source),
            ("at", &clock::local(about.started_at_us)),
            ("injected", &injected),
        ],
    );
    format!("\n  {said}")
}
