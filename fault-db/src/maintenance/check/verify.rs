//! Verifies one run with all that belongs to it, against its seals and signatures, without reading the whole file.

use serde::Serialize;

use super::seal_entry::{Seal, clock_error, seals_of};
use super::{Advice, Damage, Findings, ProblemKind, Samples};
use crate::backend::{Backend, SqlResult, values};
use crate::error::StoreError;
use crate::id::Id;
use crate::seal::covered::Covered;
use crate::seal::{RunSealed, chained, hash_of, hex, run, samples, sealed_as, statement_digest};
use crate::signature::{SIGNATURE, Statement, changed_places, read_signature, signatures_of};
use crate::store::Store;

/// Result of checking a run against its seals and signatures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verification {
    /// The run.
    pub run: Id,
    /// Seal of the run; `None` before its end.
    pub seal: Option<RunSealed>,
    /// Valid signatures of the run, of its notes and of the events of its faults.
    pub signatures: Vec<Statement>,
    /// Changes that were found, with their places, as sentences.
    pub changes: Vec<String>,
    /// Traces and recordings that were pruned.
    pub pruned: Vec<String>,
    /// Notes on the run without a signature, each with the name of its author.
    pub unsigned_notes: Vec<(Id, String)>,
    /// Remarks that are no changes, such as a clock that went backward.
    pub remarks: Vec<String>,
}

impl Verification {
    /// The signature of the run itself.
    pub fn of_run(&self) -> impl Iterator<Item = &Statement> {
        (self.signatures.iter()).filter(|statement| statement.what == "run")
    }
}

/// Greatest number of entries checked before a run's seal, back to the first event of its faults.
const MOST_ENTRIES_BACK: i64 = 20_000;

impl Store {
    /// Compares a run, its steps, values, faults, traces, recordings and notes with its seal and its signatures, and
    /// names what was changed.
    ///
    /// # Errors
    /// There is no such run, or the database cannot be read.
    pub fn verify_run(&self, id: Id) -> Result<Verification, StoreError> {
        const DOING: &str = "verifying a run";
        let run = self.run_seq(DOING, id)?;
        self.ask(DOING, |backend| {
            let mut look = Look::at(backend, (id, run));
            look.all()?;
            Ok(look.found)
        })
    }

    /// Valid signatures of a run and of its notes, as the signed documents that are stored.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn signatures(&self, run: Id) -> Result<Vec<String>, StoreError> {
        let read = self.ask("reading signatures", |backend| signatures_of(backend, run))?;
        Ok(read.into_iter().map(|(text, _)| text).collect())
    }
}

struct Look<'a> {
    backend: &'a Backend,
    id: Id,
    run: i64,
    found: Verification,
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
        self.notes()?;
        self.events()?;
        self.chain()
    }

    fn change(&mut self, what: String) {
        if !self.found.changes.contains(&what) {
            self.found.changes.push(what);
        }
    }

    /// Reads the signatures stored with `group`, and checks that what they sign is there.
    fn signatures(&mut self, group: Id) -> SqlResult<()> {
        for seal in seals_of(self.backend, SIGNATURE, group)? {
            self.link(&seal)?;
            if statement_digest(SIGNATURE, group, &seal.payload) != seal.digest[..] {
                self.change(format!("the signature at {} was changed", place(&seal)));
                continue;
            }
            match read_signature(self.backend, group, &seal.payload)? {
                Err(wrong) => self.change(format!("the signature at {}: {wrong}", place(&seal))),
                Ok(statement) => {
                    let table = Covered::of(&statement.what).map_or("run", Covered::table);
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

    /// Checks the run's own row, steps, values and occurrences, and the digests of its traces and recordings.
    fn content(&mut self) -> SqlResult<()> {
        for seal in seals_of(self.backend, "run", self.id)? {
            self.link(&seal)?;
            if run::digest(self.backend, self.run, &seal.payload)? != seal.digest[..] {
                self.locate(&seal)?;
            }
            self.traces(&run::RunPayload::of(&seal.payload).unwrap_or_default())?;
        }
        for what in samples::changed_samples(self.backend, self.run)? {
            self.change(what);
        }
        Ok(())
    }

    fn traces(&mut self, payload: &run::RunPayload) -> SqlResult<()> {
        let held = samples::hold(self.backend, (self.id, self.run), payload)?;
        let mut problems = Vec::new();
        Findings::new(&mut problems, ProblemKind::Seal, Advice::Altered).add_all(held.changed);
        for problem in problems {
            self.change(problem.detail.to_string());
        }
        for missing in held.missing {
            let of = Samples::from(missing);
            match samples::is_pruned(self.backend, missing)? {
                true => self.found.pruned.push(of.to_string()),
                false => self.change(Damage::NoSamples(of).to_string()),
            }
        }
        Ok(())
    }

    /// Finds out where the run differs from what was signed.
    fn locate(&mut self, seal: &Seal) -> SqlResult<()> {
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
            self.hold(Covered::Note, id, note)?;
        }
        Ok(())
    }

    /// Checks the events of the faults that the run saw: repairs, states, notes.
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
        let events = self.backend.select(sql, &values![self.run], |row| {
            Ok((row.get::<i64>(0)?, row.get::<Id>(1)?))
        })?;
        for (event, id) in events {
            self.hold(Covered::Event, id, event)?;
        }
        Ok(())
    }

    /// Checks the chain from the first event of the run's faults to the seal of the run, which a signature covers.
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

    /// Compares a row with its seals, of which a file must have at least one.
    fn hold(&mut self, kind: Covered, id: Id, row: i64) -> SqlResult<()> {
        let what = kind.word();
        let sealed = seals_of(self.backend, what, id)?;
        if sealed.is_empty() && matches!(self.backend, Backend::File(_)) {
            self.change(format!(
                "{what} {id} has no seal: it was put in by hand, or its seal was taken out"
            ));
        }
        for seal in sealed {
            self.link(&seal)?;
            if !kind.fits(self.backend, row, &seal.payload, &seal.digest)? {
                self.change(Damage::Changed(what, id).to_string());
            }
        }
        Ok(())
    }

    /// Checks that the hash of an entry follows from the entry before and from its digest.
    fn link(&mut self, seal: &Seal) -> SqlResult<()> {
        let before = hash_of(self.backend, seal.origin, seal.ordinal - 1)?;
        if before.is_none() && seal.ordinal > 1 {
            self.change(format!("the seal before {} was taken out", place(seal)));
        } else if chained(before.as_deref(), &seal.digest) != seal.hash[..] {
            self.change(format!(
                "the seal of {} {} at {} does not fit the one before: it was changed",
                seal.what,
                seal.id,
                place(seal)
            ));
        }
        Ok(())
    }
}

fn place(seal: &Seal) -> String {
    format!("entry {} of file {}", seal.ordinal, seal.origin.short())
}
