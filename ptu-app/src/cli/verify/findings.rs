//! Findings of a verification: who signed, what was changed, what is in doubt.

use std::fmt::Display;

use fault_db::{About, Id, Statement, Verification};
use serde_json::{Value, json};

use ptu_report::Departure;
use ptu_report::words::{Language, Words, fill};
use ptu_runs::clock::{self, rfc3339};
use ptu_runs::keys::{KeyList, Standing};
use ptu_runs::stored::from_stored;
use ptu_runs::words::{Say as _, TextStyle};

/// Findings of a verification, in the language of their readers.
pub(super) struct Findings {
    pub(super) words: &'static Words,
    /// Kind of what is verified: `run`, `database`, `sheet` or `certificate`.
    pub(super) what: &'static str,
    pub(super) id: String,
    /// Whether a signature or seal of the whole was read: without one nothing says that the whole is unchanged.
    pub(super) is_covered: bool,
    /// Signatures: who signed what, when, and whether the key was valid then.
    pub(super) signatures: Vec<Value>,
    /// The signatures as text, a sentence each.
    pub(super) said: Vec<String>,
    pub(super) changes: Vec<String>,
    /// Things that are not signed, or not by a trusted key.
    pub(super) doubts: Vec<String>,
    /// Remarks that are neither changes nor doubts, such as pruned samples.
    pub(super) remarks: Vec<String>,
    /// Validity of the run as a departure test; `None` if it is no departure test.
    pub(super) departure: Option<Departure>,
}

/// Time by which another computer's clock may be ahead of this computer's clock, µs.
const AHEAD_US: i64 = 86_400_000_000;

/// Doubt about a signature that is dated more than a day in the future.
pub(super) fn dated_ahead(name: &str, at_us: i64, words: &Words) -> Option<String> {
    let is_ahead = at_us > clock::now_us().saturating_add(AHEAD_US);
    is_ahead.then(|| {
        let at = clock::local(at_us);
        fill(words.verify.dated_ahead, &[("name", &name), ("at", &at)])
    })
}

impl Findings {
    /// Findings, empty as yet, about a `run`, `database`, `sheet` or `certificate`.
    pub(super) fn of(what: &'static str, words: &'static Words) -> Self {
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
            departure: None,
        }
    }

    pub(super) fn standing(&self, standing: &Standing) -> String {
        standing.say(TextStyle {
            korean: self.words.language == Language::Korean,
            commands: true,
        })
    }

    pub(super) fn name(&self, who: &str, kind: &str, key: &str) -> String {
        let of = [("who", &who as _), ("kind", &kind as _), ("key", &key as _)];
        fill(self.words.verify.name, &of)
    }

    pub(super) fn take_run(&mut self, seen: Verification, keys: &KeyList) {
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

    /// Takes notes that nobody signed: a note in the name of one of `signers` is a doubt, any other note a remark.
    pub(super) fn take_unsigned(&mut self, notes: &[(Id, String)], signers: &[String]) {
        for (id, who) in notes {
            let of = [("id", &id.short() as _), ("who", who as _)];
            let said = fill(self.words.verify.note_unsigned, &of);
            match signers.contains(&who.to_lowercase()) {
                true => self.doubts.push(said),
                false => self.remarks.push(said),
            }
        }
    }

    pub(super) fn take(&mut self, signed: &Statement, keys: &KeyList) {
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
            ("what", &words.signed_thing(what)),
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

    /// Says until when a departure test holds; why one does not hold is a doubt.
    pub(super) fn say_departure(&mut self, departure: Departure) {
        let verify = &self.words.verify;
        if departure.why_not.is_empty() {
            let at = clock::local_zoned(departure.until_us);
            let of = [("unit", &departure.unit as _), ("at", &at as _)];
            self.remarks.push(fill(verify.valid_until, &of));
        } else {
            let why = departure.why_not(self.words).join("; ");
            self.doubts
                .push(fill(verify.not_departure, &[("why", &why)]));
        }
        self.departure = Some(departure);
    }

    pub(super) fn json(&self) -> Value {
        json!({
            "what": self.what, "id": self.id,
            "verified": self.changes.is_empty() && self.doubts.is_empty(),
            "departure": self.departure.as_ref().map(Departure::json), "changes": self.changes, "doubts": self.doubts, "signatures": self.signatures, "remarks": self.remarks,
        })
    }

    pub(super) fn text(&self) -> String {
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
            lines.push(fill(said, &[("what", &self.words.signed_thing(self.what))]));
        }
        if !self.doubts.is_empty() {
            lines.push(verify.not_verified.to_owned());
            lines.extend(self.doubts.iter().map(|doubt| format!("  {doubt}")));
        }
        lines.extend(self.remarks.iter().cloned());
        lines.join("\n")
    }
}

/// Text that sums up a signed run: unit, verdict, counts, operator, time.
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
