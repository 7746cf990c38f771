//! Verifies one run with all that belongs to it, against its seals and signatures, without reading the whole file.

use std::collections::BTreeSet;

use serde::Serialize;
use sha2::{Digest as _, Sha256};

use super::chain::{ChainSummary, check_traces_and_recordings};
use super::seal_entry::clock_error;
use super::{Advice, Findings, ProblemKind};
use crate::backend::{Backend, SqlResult, from_row, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::seal::events_and_notes::{EventPayload, event_digest, is_of_its_fault, note_digest};
use crate::seal::{RunSealed, chained, hex, run, sealed_as, statement_digest};
use crate::signature::{SIGNATURE, Statement, changed_places, read_signature, signatures_of};
use crate::store::Store;

/// Result of looking at a run's seals and signatures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verification {
    /// The run.
    pub run: Id,
    /// Seal of the run; `None` before its end.
    pub seal: Option<RunSealed>,
    /// Signatures of the run, of notes on it and of events of its faults, each of which holds.
    pub signatures: Vec<Statement>,
    /// Changes that were found, with their places.
    pub changes: Vec<String>,
    /// Traces and recordings that were pruned.
    pub pruned: Vec<String>,
    /// Notes on it that nobody has signed, and in whose name they are.
    pub unsigned_notes: Vec<(Id, String)>,
    /// Remarks besides, such as a clock that went backward.
    pub remarks: Vec<String>,
}

impl Verification {
    /// The signature of the run itself.
    pub fn of_run(&self) -> impl Iterator<Item = &Statement> {
        (self.signatures.iter()).filter(|statement| statement.what == "run")
    }
}

/// Entries before a run's seal that are followed back to the first event that the run made.
const MOST_ENTRIES_BACK: i64 = 20_000;

impl Store {
    /// Holds a run with its steps, values, faults, traces, recordings and notes against its seal and its signatures, and
    /// names what was changed.
    ///
    /// # Errors
    /// There is no such run, or it cannot be read.
    pub fn verify_run(&self, id: Id) -> Result<Verification, StoreError> {
        const DOING: &str = "verifying a run";
        let seq: Option<i64> = self.first(
            DOING,
            "SELECT seq FROM run WHERE id = ?1",
            &values![id],
            |row| row.get(0),
        )?;
        let run = seq.ok_or_else(|| StoreError::not_found("run", id))?;
        let mut look = Look::at(&self.backend, (id, run));
        look.all().map_err(|error| self.failed(DOING, error))?;
        Ok(look.found)
    }

    /// Signatures of a run and of the notes on it that hold, as they are stored: signed documents.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn signatures(&self, run: Id) -> Result<Vec<String>, StoreError> {
        let read = signatures_of(&self.backend, run);
        let read = read.map_err(|error| self.failed("reading signatures", error))?;
        Ok(read.into_iter().map(|(text, _)| text).collect())
    }
}

/// Whether the traces and recordings of a run are those that its seal names, what was pruned aside.
pub(crate) fn has_its_traces(backend: &Backend, of: (Id, i64), payload: &str) -> SqlResult<bool> {
    let mut look = Look::at(backend, of);
    look.traces(&run::RunPayload::of(payload).unwrap_or_default())?;
    look.samples()?;
    Ok(look.found.changes.is_empty())
}

struct Look<'a> {
    backend: &'a Backend,
    id: Id,
    run: i64,
    found: Verification,
}

struct SealRow {
    origin: Id,
    ordinal: i64,
    payload: String,
    digest: Vec<u8>,
    hash: Vec<u8>,
}

impl<'a> Look<'a> {
    fn at(backend: &'a Backend, (id, run): (Id, i64)) -> Self {
        let found = Verification {
            run: id,
            seal: None,
            signatures: Vec::new(),
            changes: Vec::new(),
            pruned: Vec::new(),
            unsigned_notes: Vec::new(),
            remarks: Vec::new(),
        };
        Self {
            backend,
            id,
            run,
            found,
        }
    }

    fn all(&mut self) -> SqlResult<()> {
        self.found.seal = sealed_as(self.backend, self.id)?;
        self.signatures(self.id)?;
        self.content()?;
        self.samples()?;
        self.notes()?;
        self.events()?;
        self.chain()
    }

    fn change(&mut self, what: String) {
        if !self.found.changes.contains(&what) {
            self.found.changes.push(what);
        }
    }

    /// Reads the signatures of a group, and looks whether what they sign is there.
    fn signatures(&mut self, group: Id) -> SqlResult<()> {
        for seal in seals(self.backend, SIGNATURE, group)? {
            self.link("signature", group, &seal)?;
            if statement_digest(SIGNATURE, group, &seal.payload) != seal.digest[..] {
                self.change(format!("the signature at {} was changed", place(&seal)));
                continue;
            }
            match read_signature(self.backend, group, &seal.payload)? {
                Err(wrong) => self.change(format!("the signature at {}: {wrong}", place(&seal))),
                Ok(statement) => {
                    let table = match &statement.what[..] {
                        "note" => "run_note",
                        "event" => "fault_event",
                        _ => "run",
                    };
                    let id = statement.id.parse::<Id>().unwrap_or(group);
                    let there = format!("SELECT 1 FROM {table} WHERE id = ?1");
                    if !self.backend.has(&there, &values![id])? {
                        self.change(format!("{} {id} was taken out", statement.what));
                    }
                    self.found.signatures.push(statement);
                }
            }
        }
        Ok(())
    }

    /// The run's own row, steps, values and occurrences; its traces and recordings by their digests.
    fn content(&mut self) -> SqlResult<()> {
        for seal in seals(self.backend, "run", self.id)? {
            self.link("run", self.id, &seal)?;
            if run::digest(self.backend, self.run, &seal.payload)? != seal.digest[..] {
                self.locate(&seal)?;
            }
            self.traces(&run::RunPayload::of(&seal.payload).unwrap_or_default())?;
        }
        Ok(())
    }

    fn traces(&mut self, payload: &run::RunPayload) -> SqlResult<()> {
        let mut problems = Vec::new();
        let mut summary = ChainSummary::default();
        let mut findings = Findings::new(&mut problems, ProblemKind::Seal, Advice::Altered);
        let of = (self.id, self.run, false);
        check_traces_and_recordings(self.backend, of, payload, &mut summary, &mut findings)?;
        drop(findings);
        for problem in problems {
            self.change(problem.detail.to_string());
        }
        for (id, recording) in summary.missing() {
            self.missing(id, recording)?;
        }
        Ok(())
    }

    /// Where a run differs from what was signed.
    fn locate(&mut self, seal: &SealRow) -> SqlResult<()> {
        let digest = hex(&seal.digest);
        let signed = self.found.of_run().find(|signed| signed.digest == digest);
        let places = match signed.and_then(|signed| signed.places.as_ref()) {
            Some(places) => changed_places(self.backend, self.run, places)?,
            None => Vec::new(),
        };
        let id = self.id;
        if places.is_empty() {
            self.change(format!("run {id} was changed after it was sealed"));
        }
        for place in places {
            self.change(format!("run {id} was changed after it was signed: {place}"));
        }
        Ok(())
    }

    /// A trace or recording that its run's seal names and that is not there.
    fn missing(&mut self, id: Id, recording: Option<i64>) -> SqlResult<()> {
        let what = match recording {
            None => format!("trace {id}"),
            Some(n) => format!("recording {n} of run {id}"),
        };
        let told = seals(self.backend, crate::seal::PRUNED, id)?;
        let told = told.iter().any(|seal| {
            serde_json::from_str::<crate::seal::PrunedPayload>(&seal.payload)
                .is_ok_and(|pruned| pruned.recording == recording)
        });
        match (told, self.backend) {
            (true, _) => self.found.pruned.push(what),
            // A server has traces where they were sent.
            (false, Backend::Server(_)) => self.found.pruned.push(what),
            (false, Backend::File(_)) => {
                self.change(format!(
                    "{what} was taken out: no seal says that it was pruned"
                ));
            }
        }
        Ok(())
    }

    /// Samples and channel lists of its traces, against the checksums that their digests cover.
    fn samples(&mut self) -> SqlResult<()> {
        let mut changed = Vec::new();
        self.backend.each(
            "SELECT t.id, t.data, t.sha256, c.json, c.sha256 FROM trace t JOIN channel_set c ON c.seq = t.channel_set
             WHERE t.run = ?1 ORDER BY t.id",
            &values![self.run],
            |row| {
                let id = row.get::<Id>(0)?;
                if Sha256::digest(row.get::<&[u8]>(1)?)[..] != *row.get::<&[u8]>(2)? {
                    changed.push(format!("the samples of trace {id} were changed"));
                }
                if Sha256::digest(row.get::<&str>(3)?.as_bytes())[..] != *row.get::<&[u8]>(4)? {
                    changed.push(format!("the list of channels of trace {id} was changed"));
                }
                Ok(())
            },
        )?;
        changed.into_iter().for_each(|what| self.change(what));
        Ok(())
    }

    fn notes(&mut self) -> SqlResult<()> {
        let sql = "SELECT seq, id, who FROM run_note WHERE run = ?1 ORDER BY id";
        let rows = self.backend.select(sql, &values![self.run], |row| {
            Ok((row.get::<i64>(0)?, row.get::<Id>(1)?, row.get::<String>(2)?))
        })?;
        for (note, id, who) in rows {
            let name = id.to_string();
            if !(self.found.signatures.iter()).any(|of| of.what == "note" && of.id == name) {
                self.found.unsigned_notes.push((id, who));
            }
            let sealed = seals(self.backend, "note", id)?;
            self.has_seal("note", id, &sealed);
            for seal in sealed {
                self.link("note", id, &seal)?;
                if note_digest(self.backend, note, &seal.payload)? != seal.digest[..] {
                    self.change(format!("note {id} was changed after it was sealed"));
                }
            }
        }
        Ok(())
    }

    /// Events of the faults that it saw: repairs, states, notes.
    fn events(&mut self) -> SqlResult<()> {
        let groups = self.backend.select(
            "SELECT f.id FROM fault f WHERE f.seq IN (SELECT o.fault FROM fault_occurrence o WHERE o.run = ?1)
             UNION SELECT a.id FROM fault_alias a WHERE a.fault IN
                (SELECT o.fault FROM fault_occurrence o WHERE o.run = ?1)",
            &values![self.run],
            |row| row.get::<Id>(0),
        )?;
        for group in groups {
            self.signatures(group)?;
        }
        let sql = "SELECT e.seq, e.id FROM fault_event e WHERE e.fault IN
                (SELECT o.fault FROM fault_occurrence o WHERE o.run = ?1) ORDER BY e.id";
        for (event, id) in self.rows(sql)? {
            let sealed = seals(self.backend, "event", id)?;
            self.has_seal("event", id, &sealed);
            for seal in sealed {
                self.link("event", id, &seal)?;
                let payload = EventPayload::of(&seal.payload);
                let fits = event_digest(self.backend, event, &seal.payload)? == seal.digest[..];
                if !fits || !is_of_its_fault(self.backend, event, payload.as_ref())? {
                    self.change(format!("event {id} was changed after it was sealed"));
                }
            }
        }
        Ok(())
    }

    /// The chain from the first event that the run made to the seal of the run, which a signature covers.
    fn chain(&mut self) -> SqlResult<()> {
        let Some(seal) = self.found.seal.clone() else {
            return Ok(());
        };
        let backward = clock_error(self.backend, seal.file, seal.entry)?;
        self.found.remarks.extend(backward);
        let first = self.backend.first(
            "SELECT min(s.ordinal) FROM seal s JOIN fault_event e ON e.id = s.id AND s.what = 'event'
             WHERE e.fault IN (SELECT o.fault FROM fault_occurrence o WHERE o.run = ?1)
                AND s.origin = ?2 AND s.ordinal BETWEEN ?3 AND ?4",
            &values![self.run, seal.file, seal.entry - MOST_ENTRIES_BACK, seal.entry],
            |row| row.get::<Option<i64>>(0),
        )?;
        let first = first.flatten().unwrap_or(seal.entry);
        let sql = "SELECT ordinal, digest, hash FROM seal
            WHERE origin = ?1 AND ordinal BETWEEN ?2 AND ?3 ORDER BY ordinal";
        let mut before: Option<(i64, Vec<u8>)> = None;
        let mut wrong = Vec::new();
        let span = values![seal.file, first - 1, seal.entry];
        self.backend.each(sql, &span, |row| {
            let (ordinal, hash) = (row.get::<i64>(0)?, row.get::<Vec<u8>>(2)?);
            if let Some((last, before)) = &before {
                if *last + 1 != ordinal {
                    wrong.push(format!("seals before entry {ordinal} were taken out"));
                } else if chained(Some(before), row.get(1)?) != hash[..] {
                    wrong.push(format!(
                        "entry {ordinal} of the chain does not fit the one before: it was changed"
                    ));
                }
            }
            before = Some((ordinal, hash));
            Ok(())
        })?;
        wrong.into_iter().for_each(|what| self.change(what));
        Ok(())
    }

    /// Whether an entry's hash follows from the entry before and its digest.
    fn link(&mut self, what: &str, id: Id, seal: &SealRow) -> SqlResult<()> {
        let sql = "SELECT hash FROM seal WHERE origin = ?1 AND ordinal = ?2";
        let before: Option<Vec<u8>> =
            (self.backend).first(sql, &values![seal.origin, seal.ordinal - 1], |row| {
                row.get(0)
            })?;
        if before.is_none() && seal.ordinal > 1 {
            self.change(format!("the seal before {} was taken out", place(seal)));
        } else if chained(before.as_deref(), &seal.digest) != seal.hash[..] {
            self.change(format!(
                "the seal of {what} {id} at {} does not fit the one before: it was changed",
                place(seal)
            ));
        }
        Ok(())
    }

    fn has_seal(&mut self, what: &str, id: Id, sealed: &[SealRow]) {
        if sealed.is_empty() && matches!(self.backend, Backend::File(_)) {
            self.change(format!(
                "{what} {id} has no seal: it was put in by hand, or its seal was taken out"
            ));
        }
    }

    fn rows(&self, sql: &str) -> SqlResult<Vec<(i64, Id)>> {
        let rows = self.backend.select(sql, &values![self.run], |row| {
            Ok((row.get::<i64>(0)?, row.get::<Id>(1)?))
        })?;
        let mut seen = BTreeSet::new();
        Ok(rows.into_iter().filter(|row| seen.insert(row.0)).collect())
    }
}

fn seals(backend: &Backend, what: &str, id: Id) -> SqlResult<Vec<SealRow>> {
    backend.select(
        "SELECT origin, ordinal, says, digest, hash FROM seal WHERE id = ?1 AND what = ?2 ORDER BY origin, ordinal",
        &values![id, what],
        |row| {
            Ok(from_row!(row => SealRow: origin, ordinal, payload, digest, hash))
        },
    )
}

fn place(seal: &SealRow) -> String {
    format!("entry {} of file {}", seal.ordinal, seal.origin.short())
}
