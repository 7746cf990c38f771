//! `ptu verify`: who signed, and whether anything was changed since.

mod findings;
mod sheet;

use std::path::{Path, PathBuf};

use clap::Args;
use fault_db::{SignatureError, Signed, Statement, Store, Verification};
use serde_json::json;

use super::key::KeysOption;
use super::{Database, Json, answered};
use findings::{Findings, dated_ahead};
use ptu_report::words::{Words, fill};
use ptu_report::{Departure, has_certificate};
use ptu_runs::clock::{self, rfc3339};
use ptu_runs::failure::{Asked, Exit, Failure, FileTrouble, Why};
use ptu_runs::keys::KeyList;

/// Longest sheet or certificate that is read, bytes.
const LONGEST: u64 = 64 << 20;
/// First bytes of every SQLite database file.
const DATABASE: &[u8] = b"SQLite format 3\0";

/// Say who signed a run, a database, a sheet or a certificate, and whether anything was changed since; needs no network
///
/// Examples:
///   ptu verify latest                      the last run of the database
///   ptu verify sheet.html --keys depot.keys
///   ptu verify run.ptucert
///   ptu verify ptu:01a2…/220d…             what a scanner reads of a printed sheet
///   ptu verify history.db                  all runs of a database file
///
/// Exit codes: 0 unchanged and signed by a trusted key; 1 changed, not signed, signed by a key that is not trusted, or
/// a departure test that is not valid; 2 no such run or file; 3 the file or run cannot be read.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct VerifyArguments {
    /// A run (an id, its beginning or end, `latest`, or what the code of a sheet says), a database file, an .html sheet or
    /// a .ptucert file
    #[arg(value_name = "RUN|FILE")]
    what: String,
    /// Serial number of the unit whose departure test the run or file should be
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    #[command(flatten)]
    keys: KeysOption,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    database: Database,
}

impl VerifyArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        let words = self.json.words();
        let keys = self.keys.read()?;
        let path = Path::new(&self.what);
        let mut found = match path.is_file() {
            true => self.file(path, &keys, words)?,
            false => self.of_run(&keys, words)?,
        };
        match (found.departure.take(), &self.unit) {
            (Some(departure), _) => self.judge(departure, &mut found)?,
            (None, Some(asked)) => {
                let said = fill(words.verify.no_departure, &[("asked", asked)]);
                found.doubts.push(said);
            }
            (None, None) => {}
        }
        let good = found.changes.is_empty() && found.doubts.is_empty();
        let told = self.json.answer(|| found.json(), || found.text());
        let exit = if good { Exit::Passed } else { Exit::Failed };
        answered(told, exit)
    }

    /// Adds whether a departure test holds now, for the unit asked for, by the findings and by this computer's history.
    fn judge(&self, departure: Departure, found: &mut Findings) -> Result<(), Failure> {
        let mut departure = departure.now();
        if let Some(asked) = self.unit.as_ref().filter(|asked| **asked != departure.unit) {
            let unit = departure.unit.clone();
            let of = [("unit", &unit as _), ("asked", asked as _)];
            let said = |words: &Words| fill(words.verify.other_unit, &of);
            departure.add(said);
        }
        let history = self.database.open_read_only().ok();
        if let Some(store) = &history {
            departure.held_against(store)?;
        }
        let is_verified = found.changes.is_empty() && found.doubts.is_empty();
        if !(found.signatures.is_empty() || is_verified) {
            departure.add(|words| words.verify.departure_unverified.into());
        }
        found.say_departure(departure);
        if history.is_none() {
            found.remarks.push(found.words.verify.no_history.into());
        }
        Ok(())
    }

    fn of_run(&self, keys: &KeyList, words: &'static Words) -> Result<Findings, Failure> {
        if looks_like_a_file(&self.what) {
            return Err(Failure::usage(FileTrouble::Missing(self.what.clone())));
        }
        // The code on a sheet holds the run's id, and the SHA-256 of the run's content from which the sheet was
        // written.
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
        found.departure = Departure::of(&store.run(id)?);
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
            .map(|problem| words.trouble(&problem.detail))
            .collect();
        found.remarks = report.remarks;
        // Compares the database with what this computer's own history knows of it from a sync or an import.
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

    /// Verifies a certificate, and compares it with the run if the database has this run.
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

/// Whether the run's seal has this SHA-256 of its content.
fn has_content(seen: &Verification, digest: &str) -> bool {
    (seen.seal.as_ref()).is_some_and(|seal| seal.digest == digest)
}

/// Whether a name that is no existing file is meant as a file's name.
fn looks_like_a_file(name: &str) -> bool {
    let ending = PathBuf::from(name);
    let ending = ending.extension().and_then(|ending| ending.to_str());
    let is_code = name.starts_with("ptu:");
    (!is_code && name.contains(['/', '\\'])) || matches!(ending, Some("db" | "html" | "ptucert"))
}
